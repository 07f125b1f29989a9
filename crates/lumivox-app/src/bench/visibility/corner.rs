//! Look-ups on the CPU: occlusion at the vertices of a corner, as in Figures 33 to 36 and Table 1.

use anyhow::Result;
use glam::Vec3;
use lumivox_field::{Mapping, Ray, Settings, Sphere, Storage};
use rayon::prelude::*;

use super::models::Model;
use super::surface::row;
use crate::bench::report::Report;
use crate::clock;

/// Vertices along a side of each of the corner's three sheets, and rays of each vertex.
const SIDE: u32 = 33;
pub(super) const RAYS: u32 = 256;

/// Figure 35: seconds of preprocessing, of occlusion, and RMS error, for points and directions.
const FIGURE_35: [(u32, u32, [f64; 3]); 16] = [
    (82, 32, [1.10, 0.0933, 5.2605]),
    (82, 64, [4.11, 0.0941, 5.2339]),
    (82, 128, [15.34, 0.0949, 5.2091]),
    (82, 256, [60.80, 0.0959, 5.2041]),
    (290, 32, [3.96, 0.0946, 2.8207]),
    (290, 64, [14.60, 0.0958, 2.4118]),
    (290, 128, [54.42, 0.0981, 2.3153]),
    (290, 256, [213.75, 0.1016, 2.2914]),
    (1090, 32, [14.06, 0.0987, 1.0653]),
    (1090, 64, [51.23, 0.1022, 1.0318]),
    (1090, 128, [193.25, 0.1079, 1.0294]),
    (1090, 256, [772.0, 0.1152, 1.02871]),
    (4226, 32, [54.8, 0.1083, 0.6772]),
    (4226, 64, [204.3, 0.1112, 0.6315]),
    (4226, 128, [925.0, 0.1150, 0.6209]),
    (4226, 256, [3039.7, 0.1219, 0.6185]),
];
/// Figure 36: one bit per direction.
const FIGURE_36: f64 = 4.4030;
/// Table 1: ray casting, preprocessing and occlusion of the bunny in seconds.
const TABLE_1_BUNNY: [f64; 3] = [331.1, 54.79, 0.228];

/// Directions around a normal as dense as their cosine with it: a spiral, turned for each vertex.
pub(super) fn directions(normal: Vec3, count: u32, turned: f32) -> impl Iterator<Item = Vec3> {
    let (x, y) = normal.any_orthonormal_pair();
    (0..count).map(move |n| {
        let square = (n as f32 + 0.5) / count as f32;
        let (sin, cos) = (2.399_963 * n as f32 + turned).sin_cos();
        square.sqrt() * (cos * x + sin * y) + (1.0 - square).sqrt() * normal
    })
}

/// Points and normals of the sheets below, behind and beside an object.
pub(super) fn corner(sphere: Sphere) -> Vec<(Vec3, Vec3)> {
    let (radius, low) = (sphere.radius, sphere.center - 1.02 * sphere.radius);
    let mut points = Vec::new();
    for (a, b, normal) in
        [(Vec3::X, Vec3::Z, Vec3::Y), (Vec3::X, Vec3::Y, Vec3::Z), (Vec3::Y, Vec3::Z, Vec3::X)]
    {
        for n in 0..SIDE * SIDE {
            let [s, t] = [n % SIDE, n / SIDE].map(|i| 2.5 * radius * (i as f32 + 0.5) / SIDE as f32);
            points.push((low + s * a + t * b, normal));
        }
    }
    points
}

/// Occlusion of each point by what a ray meets at a distance, and seconds. `taken` says how much of a ray that takes.
pub(super) fn occlusion(
    points: &[(Vec3, Vec3)],
    met: impl Fn(&Ray) -> Option<f32> + Sync,
    taken: impl Fn(f32) -> f32 + Sync,
) -> (Vec<f64>, f64) {
    let start = clock::millis();
    let at = |(n, (p, normal)): (usize, &(Vec3, Vec3))| {
        let rays = directions(*normal, RAYS, n as f32).map(|d| Ray::new(*p, d));
        let sum: f32 = rays.filter_map(|ray| met(&ray)).map(&taken).sum();
        f64::from(sum) / f64::from(RAYS)
    };
    let found = points.par_iter().enumerate().map(at).collect();
    (found, (clock::millis() - start) / 1e3)
}

/// In grey levels of 255.
pub(super) fn rms(a: &[f64], b: &[f64]) -> f64 {
    let sum: f64 = a.iter().zip(b).map(|(a, b)| (255.0 * (a - b)).powi(2)).sum();
    (sum / a.len().max(1) as f64).sqrt()
}

/// A model with what its true rays see of it from the corner.
struct Truth<'m> {
    model: &'m Model,
    points: Vec<(Vec3, Vec3)>,
    exact: Vec<f64>,
    /// Of what falls off to nothing at the sphere's radius.
    exact_near: Vec<f64>,
    radius: f32,
    seconds: f64,
}

/// What one model's field finds.
struct Found {
    bake_s: f64,
    look_s: f64,
    rms: f64,
    /// With a falloff.
    rms_near: f64,
}

impl<'m> Truth<'m> {
    fn new(model: &'m Model) -> Result<Self> {
        let small = Settings { points: 82, directions: 32, ..Settings::default() };
        let baker = lumivox_field::Baker::new(model.object.mesh(), small)?;
        let points = corner(baker.sphere());
        let trace = |ray: &Ray| baker.trace(ray);
        let (exact, seconds) = occlusion(&points, trace, whole);
        let radius = baker.sphere().radius;
        let (exact_near, _) = occlusion(&points, trace, |d| near(d, radius));
        Ok(Self { model, points, exact, exact_near, radius, seconds })
    }

    fn measure(&self, settings: Settings) -> Result<Found> {
        let (_, field, bake_s) = self.model.baked(settings)?;
        let look = |ray: &Ray| field.nearest(ray);
        let (found, look_s) = occlusion(&self.points, look, whole);
        let (found_near, _) = occlusion(&self.points, look, |d| near(d, self.radius));
        let (rms, rms_near) = (rms(&found, &self.exact), rms(&found_near, &self.exact_near));
        Ok(Found { bake_s, look_s, rms, rms_near })
    }
}

/// Any hit takes all of a ray.
pub(super) fn whole(_: f32) -> f32 {
    1.0
}

/// 1 - V of equation 3 with an exponent of one, which takes nothing at some reach.
fn near(distance: f32, reach: f32) -> f32 {
    (1.0 - distance / reach).max(0.0)
}

/// Figures 33 to 36.
pub(super) fn errors(model: &Model, quick: bool, report: &mut Report) -> Result<()> {
    report.head("Points, directions, mappings and bits on the CPU (Figures 33 to 36)");
    report.say(&format!(
        "{}; {RAYS} rays from each of 3 x {SIDE} x {SIDE} points of a corner; seconds of the bake / seconds of all look-ups / RMS \
         error in grey levels of 255 beside true rays in the same directions. In parentheses the papers', on one of their machines and in \
         their picture.",
        model.title()
    ));
    let truth = Truth::new(model)?;
    let (points, sides): (&[u32], &[u32]) =
        if quick { (&[82, 290, 1090], &[32, 64]) } else { (&[82, 290, 1090, 4226], &[32, 64, 128, 256]) };
    let mut lines = Vec::new();
    for &points in points {
        let mut line = vec![points.to_string()];
        for &directions in sides {
            let found = truth.measure(Settings { points, directions, ..Settings::default() })?;
            let paper = FIGURE_35.iter().find(|(p, d, _)| (*p, *d) == (points, directions)).map(|(.., v)| v);
            let beside = paper.map_or(String::new(), |[a, b, c]| format!(" ({a} / {b} / {c})"));
            let found = [found.bake_s, found.look_s, found.rms];
            line.push(format!("{:.2} / {:.3} / {:.3}{beside}", found[0], found[1], found[2]));
            let case = format!("{points} points, {directions} x {directions}");
            for (n, (metric, unit)) in
                [("bake", "s"), ("look-ups", "s"), ("RMS", "grey levels")].into_iter().enumerate()
            {
                report.push(row("Figure 35", case.clone(), metric, found[n], unit, paper.map(|p| p[n])));
            }
        }
        lines.push(line);
    }
    let header: Vec<String> =
        std::iter::once("points".to_owned()).chain(sides.iter().map(|s| format!("{s} x {s}"))).collect();
    report.table(&header, &lines);

    let points = if quick { 1090 } else { 4226 };
    let base = Settings { points, ..Settings::default() };
    let mut lines = Vec::new();
    let mut tell = |figure, name: String, settings: Settings, paper: Option<f64>| -> Result<()> {
        let Found { bake_s, look_s, rms, rms_near } = truth.measure(settings)?;
        let mib = settings.bytes() as f64 / f64::from(1 << 20);
        lines.push(vec![
            name.clone(),
            format!("{mib:.2}"),
            format!(
                "{bake_s:.2} / {look_s:.3} / {rms:.3}{}",
                paper.map_or(String::new(), |p| format!(" ({p})"))
            ),
            format!("{rms_near:.3}"),
        ]);
        report.push(row(figure, name.clone(), "bake", bake_s, "s", None));
        report.push(row(figure, name.clone(), "look-ups", look_s, "s", None));
        report.push(row(figure, name.clone(), "RMS", rms, "grey levels", paper));
        report.push(row(figure, name, "RMS with a falloff", rms_near, "grey levels", None));
        Ok(())
    };
    for mapping in Mapping::ALL {
        let name = format!("{}, 8 bits", mapping.name());
        tell("Figure 34", name, Settings { mapping, ..base }, None)?;
    }
    tell("Figure 33", "concentric, 32 bits".to_owned(), Settings { storage: Storage::Float, ..base }, None)?;
    let bit = Settings { storage: Storage::Bit, ..base };
    tell("Figure 36", "concentric, 1 bit".to_owned(), bit, Some(FIGURE_36))?;
    report.say(&format!(
        "Mappings and bits, {points} points of 64 x 64 directions: the same numbers, and the error with a falloff (equation 3) that takes nothing of a \
         ray that meets the object a radius away. Verdicts of hit or miss are all that occlusion without a falloff asks for, so that \
         one bit has the error of eight there; with one, its mean depths count."
    ));
    let header = ["kept as", "MiB", "bake s / look-ups s / RMS", "RMS with a falloff"].map(str::to_owned);
    report.table(&header, &lines);
    Ok(())
}

/// Table 1.
pub(super) fn table(models: &[Model], quick: bool, report: &mut Report) -> Result<()> {
    report.head("Models on the CPU (Table 1)");
    let rays = 3 * SIDE * SIDE * RAYS;
    report.say(&format!(
        "{rays} rays each; true rays by a tree of boxes eight wide, look-ups in maps of 32 x 32 directions; in parentheses the papers' \
         bunny of 39K triangles."
    ));
    let mut lines = Vec::new();
    for model in models {
        let truth = Truth::new(model)?;
        let points = if quick { 1090 } else { 4226 };
        let Found { bake_s: bake, look_s: look, rms: error, .. } =
            truth.measure(Settings { points, directions: 32, ..Settings::default() })?;
        let paper = (model.name == "Bunny").then_some(TABLE_1_BUNNY);
        let cell = |value: f64, n: usize| match paper {
            Some(paper) => format!("{value:.3} ({})", paper[n]),
            None => format!("{value:.3}"),
        };
        lines.push(vec![
            model.title(),
            cell(truth.seconds, 0),
            cell(bake, 1),
            cell(look, 2),
            format!("{error:.3}"),
        ]);
        for (n, (metric, value)) in
            [("true rays", truth.seconds), ("bake", bake), ("look-ups", look)].into_iter().enumerate()
        {
            report.push(row("Table 1", model.title(), metric, value, "s", paper.map(|p| p[n])));
        }
    }
    let header = ["model", "true rays s", "bake s", "look-ups s", "RMS"].map(str::to_owned);
    report.table(&header, &lines);
    Ok(())
}
