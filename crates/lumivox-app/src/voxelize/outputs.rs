//! Which files come of which inputs, and how they are written.

use std::io;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, anyhow, bail};
use lumivox_voxels::SparseVolume;
use lumivox_voxels::files::{self, FileError, FileFormat, FileReport, Output, Place};

use super::args::VoxelizeArgs;
use crate::output;
use crate::part_file::PartFile;

/// One input and what becomes of it.
#[derive(Debug)]
pub(super) struct Task<'a> {
    pub(super) input: &'a str,
    pub(super) path: PathBuf,
    pub(super) format: FileFormat,
}

/// Pairs inputs with outputs; everything that can be wrong with names is found here.
pub(super) fn tasks(args: &VoxelizeArgs) -> Result<Vec<Task<'_>>> {
    let folder = into_folder(&args.output);
    if args.inputs.len() > 1 && !folder && args.format.is_none() {
        bail!(
            "{}: several meshes need a folder to go to: -o FOLDER/ --format npz, or another format",
            args.output.display()
        );
    }
    let tasks = if folder || args.inputs.len() > 1 {
        let Some(format) = args.format else {
            bail!("{}: is a folder; say with --format what to write into it", args.output.display());
        };
        let task = |input| {
            let name = format!("{}.{}", stem(input), format.0.extension());
            Task { input, path: args.output.join(name), format: format.0 }
        };
        args.inputs.iter().map(|input| task(input)).collect()
    } else {
        let by_name = FileFormat::of_path(&args.output);
        let format = match (args.format, by_name) {
            (Some(asked), Some(named)) if asked.0 != named => bail!(
                "{}: the name says .{} and --format {}",
                args.output.display(),
                named.extension(),
                asked.0.extension()
            ),
            (Some(asked), _) => asked.0,
            (None, Some(named)) => named,
            (None, None) => bail!(
                "{}: volumes are written as .{}",
                args.output.display(),
                FileFormat::EXTENSIONS.join(" .")
            ),
        };
        vec![Task { input: &args.inputs[0], path: args.output.clone(), format }]
    };
    let mut tasks: Vec<Task<'_>> = tasks;
    if args.cubes {
        if tasks.iter().any(|task| task.format != FileFormat::PlyPoints) {
            bail!("--cubes is for .ply");
        }
        tasks.iter_mut().for_each(|task| task.format = FileFormat::PlyCubes);
    }
    Ok(tasks)
}

/// Whether a path is there as a folder, or is written like one.
fn into_folder(path: &Path) -> bool {
    path.is_dir() || path.to_string_lossy().ends_with(['/', std::path::MAIN_SEPARATOR])
}

/// The name of an input without folder and endings; of `builtin:cornell:2` `cornell_2`.
fn stem(input: &str) -> String {
    if let Some(name) = input.strip_prefix("builtin:") {
        return name.replace(':', "_");
    }
    let name = Path::new(input).file_name().unwrap_or_default().to_string_lossy().into_owned();
    let stem = name.rsplit_once('.').map_or(name.as_str(), |(stem, _)| stem);
    stem.strip_suffix(".scene").unwrap_or(stem).to_owned()
}

/// Tries all outputs before any work is done, and refuses to write two into one file or any over an input.
pub(super) fn prepare(args: &VoxelizeArgs, tasks: &[Task<'_>]) -> Result<()> {
    let mut outputs: Vec<PathBuf> = Vec::new();
    for task in tasks {
        let (channels, _) = args.channels_for(task.format);
        let names: Vec<&str> = channels.iter().map(|channel| channel.name()).collect();
        outputs.extend(task.format.files(&task.path, &names));
    }
    outputs.extend(args.stats.clone());
    let inputs: Vec<&str> = args.inputs.iter().map(String::as_str).collect();
    let outputs: Vec<&Path> = outputs.iter().map(PathBuf::as_path).collect();
    outputs.iter().try_for_each(|path| output::prepare(path))?;
    output::check_apart(&inputs, &outputs)
}

/// Writes a volume; its files get their names together, when all of them are whole.
pub(super) fn write(task: &Task<'_>, volume: &SparseVolume) -> Result<FileReport> {
    let mut parts = Parts::default();
    let report =
        files::write_into(&mut parts, &task.path, task.format, volume).map_err(|error| match error {
            FileError::Io { path, source } => {
                anyhow!(source).context(format!("cannot write {}", path.display()))
            }
            limit @ FileError::Limit { .. } => anyhow!(limit),
        })?;
    for (path, file) in parts.0 {
        file.finish().with_context(|| format!("cannot write {}", path.display()))?;
    }
    Ok(report)
}

/// Files that are complete but for their names.
#[derive(Default)]
struct Parts(Vec<(PathBuf, PartFile)>);

impl Place for Parts {
    fn make(
        &mut self,
        path: &Path,
        fill: &mut dyn FnMut(&mut dyn Output) -> io::Result<()>,
    ) -> io::Result<()> {
        let mut file = PartFile::create(path)?;
        let result = fill(&mut file);
        // What the system said is clearer than what became of it on the way up.
        if let Some(failure) = file.failure() {
            return Err(failure);
        }
        result?;
        self.0.push((path.to_owned(), file));
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn outputs_are_named_after_inputs() {
        for (input, expected) in [
            ("a/b/bunny.ply", "bunny"),
            ("x.scene.json", "x"),
            ("builtin:cornell", "cornell"),
            ("builtin:cornell:2", "cornell_2"),
            ("v1.2.glb", "v1.2"),
            ("plain", "plain"),
        ] {
            assert_eq!(stem(input), expected, "{input}");
        }
    }
}
