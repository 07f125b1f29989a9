//! What all of these tests use: a folder that is gone with its test, runs of the program, and readers of what it writes.

use std::ffi::{OsStr, OsString};
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::atomic::{AtomicU32, Ordering};

use libtest_mimic::Failed;

/// The program under test.
pub(crate) const PROGRAM: &str = env!("CARGO_BIN_EXE_lumivox");

/// A folder of one test, gone with it.
pub(crate) struct Folder(PathBuf);

impl Folder {
    pub(crate) fn new() -> Self {
        static NEXT: AtomicU32 = AtomicU32::new(0);
        let number = NEXT.fetch_add(1, Ordering::Relaxed);
        let path = std::env::temp_dir().join(format!("lumivox-cli-{}-{number}", std::process::id()));
        std::fs::create_dir_all(&path).unwrap();
        Self(path)
    }

    /// Runs the program in the folder. Volumes are the CPU's unless the arguments say otherwise: tests of exact numbers must not
    /// depend on the machine.
    pub(crate) fn run<S: AsRef<OsStr>>(&self, arguments: impl IntoIterator<Item = S>) -> Run {
        let mut arguments: Vec<OsString> = arguments.into_iter().map(|a| a.as_ref().to_owned()).collect();
        let chooses = |a: &OsString| a == "--device" || a == "--method" || a == "--adapter";
        if arguments.first().is_some_and(|a| a == "voxelize") && !arguments.iter().any(chooses) {
            arguments.extend(["--device", "cpu"].map(OsString::from));
        }
        Run::new(self.command(PROGRAM).args(arguments).output().unwrap())
    }

    /// Any program, to be run in the folder.
    pub(crate) fn command(&self, program: &str) -> Command {
        let mut command = Command::new(program);
        // Drivers complain on stderr when there is no folder for them.
        command.current_dir(&self.0).env_remove("LUMIVOX_LOG").env("XDG_RUNTIME_DIR", &self.0);
        command.env("LUMIVOX_CACHE", &self.0);
        command
    }

    /// Runs the program with arguments that have no spaces in them.
    pub(crate) fn line(&self, arguments: &str) -> Run {
        self.run(arguments.split_whitespace())
    }

    pub(crate) fn write(&self, name: &str, bytes: impl AsRef<[u8]>) {
        std::fs::write(self.0.join(name), bytes).unwrap();
    }

    pub(crate) fn join(&self, name: &str) -> PathBuf {
        self.0.join(name)
    }

    /// Everything in it, sorted, folders as their contents.
    pub(crate) fn files(&self) -> Vec<String> {
        let mut files = Vec::new();
        let mut folders = vec![self.0.clone()];
        while let Some(folder) = folders.pop() {
            for entry in std::fs::read_dir(folder).unwrap().flatten() {
                let path = entry.path();
                match path.is_dir() {
                    true => folders.push(path),
                    false => {
                        let inner = path.strip_prefix(&self.0).unwrap();
                        let parts: Vec<_> = inner.iter().map(|p| p.to_string_lossy()).collect();
                        files.push(parts.join("/"));
                    }
                }
            }
        }
        files.sort();
        files
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

pub(crate) struct Run {
    pub(crate) status: Option<i32>,
    pub(crate) stdout: String,
    pub(crate) stderr: String,
}

impl Run {
    pub(crate) fn new(output: Output) -> Self {
        Self {
            status: output.status.code(),
            stdout: String::from_utf8_lossy(&output.stdout).into_owned(),
            stderr: String::from_utf8_lossy(&output.stderr).into_owned(),
        }
    }

    /// The program ended well and had nothing to complain about.
    pub(crate) fn succeeded(&self) -> &Self {
        assert!(self.status == Some(0), "status {:?}: {}", self.status, self.stderr);
        assert!(!self.stderr.contains("panicked") && !self.stderr.contains("ERROR"), "{}", self.stderr);
        self
    }

    /// The program ended in one sentence of its own that holds all of `words`.
    pub(crate) fn failed_with(&self, words: &[&str]) {
        self.failed("lumivox: ", words);
        assert_eq!(self.stderr.lines().count(), 1, "one sentence: {}", self.stderr);
    }

    /// The command line parser refused the arguments in a sentence that holds all of `words`.
    pub(crate) fn refused_with(&self, words: &[&str]) {
        self.failed("error: ", words);
        assert_eq!(self.status, Some(2), "{}", self.stderr);
    }

    pub(crate) fn failed(&self, start: &str, words: &[&str]) {
        assert!(self.status.is_some_and(|s| s != 0), "status {:?}: {}", self.status, self.stderr);
        assert!(!self.stderr.contains("panicked"), "{}", self.stderr);
        assert!(self.stderr.starts_with(start), "does not start with {start:?}: {}", self.stderr);
        for word in words {
            assert!(self.stderr.contains(word), "does not name {word:?}: {}", self.stderr);
        }
    }
}

pub(crate) fn read_json(path: &Path) -> Result<serde_json::Value, Failed> {
    Ok(serde_json::from_str(&std::fs::read_to_string(path)?)?)
}

/// The rows of an EXR.
pub(crate) fn read_exr(path: &Path) -> Result<Vec<Vec<[f32; 3]>>, Failed> {
    let image = exr::prelude::read_first_rgba_layer_from_file(
        path,
        |size, _| vec![vec![[0.0f32; 3]; size.width()]; size.height()],
        |pixels: &mut Vec<Vec<[f32; 3]>>, at, (r, g, b, _): (f32, f32, f32, f32)| {
            pixels[at.y()][at.x()] = [r, g, b]
        },
    )
    .map_err(|e| e.to_string())?;
    Ok(image.layer_data.channel_data.pixels)
}

pub(crate) const QUICK: [&str; 6] = ["--size", "16x12", "--grid", "8", "--iterations", "4"];

/// A GLB of one triangle.
pub(crate) fn glb() -> Vec<u8> {
    let mut binary: Vec<u8> =
        [0.0f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0].iter().flat_map(|v| v.to_le_bytes()).collect();
    binary.resize(36, 0);
    let json = r#"{"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],"buffers":[{"byteLength":36}],"bufferViews":[{"buffer":0,"byteLength":36}],"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,0]}]}"#;
    let mut json = json.as_bytes().to_vec();
    json.resize(json.len().next_multiple_of(4), b' ');
    let mut file = Vec::new();
    file.extend(b"glTF");
    file.extend(2u32.to_le_bytes());
    file.extend((12 + 8 + json.len() as u32 + 8 + binary.len() as u32).to_le_bytes());
    file.extend((json.len() as u32).to_le_bytes());
    file.extend(b"JSON");
    file.extend(&json);
    file.extend((binary.len() as u32).to_le_bytes());
    file.extend(b"BIN\0");
    file.extend(&binary);
    file
}
