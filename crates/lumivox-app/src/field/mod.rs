//! `lumivox field`: bakes visibility fields and tells how good they are.

mod args;
pub(crate) mod casters;
pub(crate) mod check;
pub(crate) mod lookups;
pub(crate) mod object;
mod picture;
mod report;

use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail};
use lumivox_field::{Baker, Field, parts};

pub(crate) use args::FieldArgs;
use object::Object;
use report::{FieldStats, SphereStats};

use crate::{clock, output, render, stats};

/// Shorter bakes say nothing of rays per CPU-second.
const LEAST_CPU_SECONDS: f64 = 0.2;

/// Runs the command.
pub(crate) fn run(args: &FieldArgs) -> Result<()> {
    args.settings()?;
    let outputs: Vec<&Path> =
        [&args.output, &args.maps, &args.stats].into_iter().flatten().map(|p| p.as_path()).collect();
    if args.output.as_ref().is_some_and(|path| path.extension().is_none_or(|e| e != "lvf")) {
        bail!("a field is written as .lvf");
    }
    outputs.iter().try_for_each(|path| output::prepare(path))?;
    output::check_apart(&[&args.input], &outputs)?;
    if let Some(path) =
        args.maps.as_ref().filter(|p| p.extension().is_none_or(|e| !e.eq_ignore_ascii_case("png")))
    {
        bail!("{}: maps are drawn as .png", path.display());
    }
    let is_field = Path::new(&args.input).extension().is_some_and(|e| e.eq_ignore_ascii_case("lvf"));
    let (fields, done) = if is_field { read(args)? } else { baked(args)? };
    if let Some(path) = &args.maps {
        output::write_png(path, &picture::sheets(&fields))?;
    }
    eprintln!("{}", done.words());
    args.stats.as_deref().map_or(Ok(()), |path| stats::write(path, &done))
}

fn read(args: &FieldArgs) -> Result<(Vec<Field>, FieldStats)> {
    let idle = args.of_baking();
    if !idle.is_empty() {
        bail!("{} is a field already, and nothing is baked: it takes no {}", args.input, idle.join(", "));
    }
    let start = clock::millis();
    let field = Field::load(&args.input)?;
    let mut done = FieldStats::of(&args.input, &field);
    done.load_ms = clock::millis() - start;
    done.spheres.push(SphereStats::of(&field, Some(Path::new(&args.input))));
    Ok((vec![field], done))
}

fn baked(args: &FieldArgs) -> Result<(Vec<Field>, FieldStats)> {
    let settings = args.settings()?;
    let start = clock::millis();
    let scene = lumivox_scene::load(&args.input)?;
    stats::warn_of_import(&scene);
    let object = Object::whole(&scene);
    let pieces = parts(&object.mesh(), args.spheres()).with_context(|| args.input.clone())?;
    let load_ms = clock::millis() - start;
    let (begun, cpu) = (clock::millis(), clock::cpu_seconds());
    let bar = render::progress(u64::from(settings.points) * pieces.len() as u64, "maps");
    let (mut fields, mut spheres) = (Vec::new(), Vec::new());
    let (mut rays, mut all_rays, mut whole) = (0, 0, None);
    for (n, piece) in pieces.iter().enumerate() {
        let before = u64::from(settings.points) * n as u64;
        // What an earlier bake left is not traced again.
        let mut traced = 0;
        let observe = |progress: lumivox_field::Progress| {
            traced = progress.rays;
            bar.set_position(before + u64::from(progress.maps_done));
            ControlFlow::Continue(())
        };
        let baker = Baker::new(piece.mesh(), settings).with_context(|| args.input.clone())?;
        let path = args.output.as_ref().map(|path| numbered(path, n, pieces.len()));
        let field = match &path {
            Some(path) => {
                output::prepare(path)?;
                baker.bake_to_file(path, observe)?;
                Field::load(path)?
            }
            None => baker.bake(observe)?,
        };
        rays += traced;
        all_rays += baker.rays();
        spheres.push(SphereStats::of(&field, path.as_deref()));
        fields.push(field);
        whole = (pieces.len() == 1).then_some(baker);
    }
    bar.finish_and_clear();
    let ms = clock::millis() - begun;
    let cpu = clock::cpu_seconds().zip(cpu).map(|(now, then)| now - then);
    let Some(first) = fields.first() else { bail!("{}: there is nothing to bake", args.input) };
    let mut done = FieldStats::of(&args.input, first);
    done.triangles = Some(object.triangles());
    done.load_ms = load_ms;
    done.bytes = fields.iter().map(Field::bytes).sum();
    done.spheres = spheres;
    done.bake_ms = Some(ms);
    done.rays = Some(rays);
    done.rays_kept = Some(all_rays - rays);
    done.million_rays_per_second = Some(rays as f64 / ms.max(1e-6) / 1e3);
    // The system counts in hundredths of a second.
    let cpu = cpu.filter(|cpu| *cpu >= LEAST_CPU_SECONDS);
    done.million_rays_per_cpu_second = cpu.map(|cpu| rays as f64 / cpu / 1e6);
    if args.check() > 0 {
        let whole = match whole {
            Some(whole) => whole,
            None => {
                let small = lumivox_field::Settings { points: 82, directions: 32, ..Default::default() };
                Baker::new(object.mesh(), small)?
            }
        };
        check(args.check(), &whole, &fields, &mut done);
    }
    Ok((fields, done))
}

/// Holds the fields of all pieces against true rays through the whole.
fn check(lines: u32, whole: &Baker, fields: &[Field], done: &mut FieldStats) {
    let sphere = whole.sphere();
    let rays = check::lines(sphere.center, sphere.radius, lines);
    let (exact, rate) = check::traced(whole, &rays);
    let [nearest, blended] = check::errors(fields, 2.0 * sphere.radius, &rays, &exact);
    (done.nearest, done.blended) = (Some(nearest), Some(blended));
    done.true_million_rays_per_second = Some(rate);
    done.room = Some(fields.iter().map(|f| f64::from(f.sphere().radius / sphere.radius).powi(3)).sum());
}

/// The file of one of several fields: `cane.lvf` becomes `cane.1.lvf`, `cane.2.lvf` and so on.
fn numbered(path: &Path, n: usize, count: usize) -> PathBuf {
    if count == 1 { path.to_owned() } else { path.with_extension(format!("{}.lvf", n + 1)) }
}
