//! `lumivox field`: bakes visibility fields and tells how good they are.

mod args;
pub(crate) mod casters;
pub(crate) mod check;
pub(crate) mod object;
mod picture;

use std::ops::ControlFlow;
use std::path::Path;

use anyhow::{Context, Result, bail};
use lumivox_field::{Baker, Field};
use serde::Serialize;

pub(crate) use args::FieldArgs;
use check::Errors;
use object::Object;

use crate::{clock, output, render, stats};

/// A baked or read field.
#[derive(Debug, Serialize)]
struct FieldStats {
    input: String,
    triangles: Option<usize>,
    points: u32,
    directions: u32,
    mapping: &'static str,
    bits: u32,
    normals: bool,
    sphere_center_m: [f32; 3],
    sphere_radius_m: f32,
    /// Texels of the 3D texture.
    texture: Option<[u32; 3]>,
    bytes: u64,
    rays: Option<u64>,
    load_ms: f64,
    bake_ms: Option<f64>,
    million_rays_per_second: Option<f64>,
    /// Look-ups of the nearest map beside true rays.
    nearest: Option<Errors>,
    /// Of the three maps around the entry.
    blended: Option<Errors>,
    /// True rays on all cores, unsorted, closest hit.
    true_million_rays_per_second: Option<f64>,
}

/// Runs the command.
pub(crate) fn run(args: &FieldArgs) -> Result<()> {
    let settings = args.settings()?;
    let outputs: Vec<&Path> =
        [&args.output, &args.maps, &args.stats].into_iter().flatten().map(|p| p.as_path()).collect();
    if args.output.as_ref().is_some_and(|path| path.extension().is_none_or(|e| e != "lvf")) {
        bail!("a field is written as .lvf");
    }
    outputs.iter().try_for_each(|path| output::prepare(path))?;
    output::check_apart(&[&args.input], &outputs)?;
    let start = clock::millis();
    let is_field = Path::new(&args.input).extension().is_some_and(|e| e.eq_ignore_ascii_case("lvf"));
    let mut done = FieldStats::default();
    let field = if is_field {
        if args.output.is_some() {
            bail!("{}: a field is baked from a mesh; this is one already", args.input);
        }
        let field = Field::load(&args.input)?;
        done.load_ms = clock::millis() - start;
        field
    } else {
        let scene = lumivox_scene::load(&args.input)?;
        stats::warn_of_import(&scene);
        let object = Object::whole(&scene);
        let baker = Baker::new(object.mesh(), settings).with_context(|| args.input.clone())?;
        done.load_ms = clock::millis() - start;
        done.triangles = Some(object.triangles());
        let begun = clock::millis();
        let bar = render::progress(u64::from(settings.points), "maps");
        let observe = |progress: lumivox_field::Progress| {
            bar.set_position(u64::from(progress.maps_done));
            ControlFlow::Continue(())
        };
        let field = match &args.output {
            Some(path) => {
                baker.bake_to_file(path, observe)?;
                Field::load(path)?
            }
            None => baker.bake(observe)?,
        };
        bar.finish_and_clear();
        let ms = clock::millis() - begun;
        done.bake_ms = Some(ms);
        done.rays = Some(baker.rays());
        done.million_rays_per_second = Some(baker.rays() as f64 / ms.max(1e-6) / 1e3);
        if args.check > 0 {
            let sphere = field.sphere();
            let rays = check::lines(sphere.center, sphere.radius, args.check);
            let (exact, rate) = check::traced(&baker, &rays);
            let [nearest, blended] = check::errors(&field, &rays, &exact);
            (done.nearest, done.blended) = (Some(nearest), Some(blended));
            done.true_million_rays_per_second = Some(rate);
        }
        field
    };
    if let Some(path) = &args.maps {
        output::write_png(path, &picture::sheet(&field))?;
    }
    done.describe(&args.input, &field);
    eprintln!("{}", done.words());
    args.stats.as_deref().map_or(Ok(()), |path| stats::write(path, &done))
}

impl Default for FieldStats {
    fn default() -> Self {
        Self {
            input: String::new(),
            triangles: None,
            points: 0,
            directions: 0,
            mapping: "",
            bits: 0,
            normals: false,
            sphere_center_m: [0.0; 3],
            sphere_radius_m: 0.0,
            texture: None,
            bytes: 0,
            rays: None,
            load_ms: 0.0,
            bake_ms: None,
            million_rays_per_second: None,
            nearest: None,
            blended: None,
            true_million_rays_per_second: None,
        }
    }
}

impl FieldStats {
    fn describe(&mut self, input: &str, field: &Field) {
        let settings = field.settings();
        self.input = input.to_owned();
        (self.points, self.directions) = (settings.points, settings.directions);
        (self.mapping, self.bits) = (settings.mapping.name(), settings.storage.bits());
        self.normals = settings.normals;
        self.sphere_center_m = field.sphere().center.to_array();
        self.sphere_radius_m = field.sphere().radius;
        self.texture = field.texture_layout().map(|layout| layout.size());
        self.bytes = field.bytes();
    }

    /// What a reader wants to know, a line each.
    fn words(&self) -> String {
        let mut words = format!(
            "lumivox: {}: {} maps of {} x {} directions, {}, {} bits, {:.1} MiB, on a sphere of {} m",
            self.input,
            self.points,
            self.directions,
            self.directions,
            self.mapping,
            self.bits,
            self.bytes as f64 / f64::from(1 << 20),
            self.sphere_radius_m,
        );
        if let (Some(ms), Some(rays), Some(rate)) = (self.bake_ms, self.rays, self.million_rays_per_second) {
            words += &format!("\nbaked in {:.2} s: {rays} rays, {rate:.2} million a second", ms / 1e3);
        }
        let kinds = [("nearest map", &self.nearest), ("three maps", &self.blended)];
        for (kind, errors) in kinds.into_iter().filter_map(|(kind, e)| Some((kind, e.as_ref()?))) {
            words += &format!(
                "\n{kind}: {:.2} % of verdicts wrong, distances off by {:.2} % of the diameter (RMS), {:.2} million look-ups a second",
                100.0 * errors.wrong,
                100.0 * errors.distance_rms,
                errors.million_per_second
            );
        }
        if let Some(rate) = self.true_million_rays_per_second {
            words += &format!("\ntrue rays: {rate:.2} million a second");
        }
        words
    }
}
