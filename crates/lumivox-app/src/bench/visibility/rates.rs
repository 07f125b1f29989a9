//! Rays per second: true rays and look-ups on the same threads, and look-ups on the device (Figures 39 and 40).

use anyhow::Result;
use glam::{Mat4, Vec3};
use lumivox::gpu::Buffer;
use lumivox::visibility::{Fields, HIT_BYTES, Objects, Placement, QueryRay, RayQuery};
use lumivox_field::{Field, Ray, Settings, Storage};

use super::models::{Model, body};
use crate::bench::plot::{Plot, Series};
use crate::bench::report::{Report, Row};
use crate::bench::timing::Timer;
use crate::field::check;

/// Million rays per second of the papers for rays between objects, and from the object itself.
const FIGURE_39: [(&str, f64); 4] =
    [("Bunny", 614.21), ("Horse", 330.15), ("Cow", 408.09), ("Dragon", 259.37)];
const FIGURE_40: [(&str, f64); 1] = [("Elephant", 60.5)];

fn push(report: &mut Report, figure: &'static str, case: &str, metric: &str, value: f64, paper: Option<f64>) {
    let (case, metric) = (case.to_owned(), metric.to_owned());
    report.push(Row { figure, case, metric, value, unit: "M/s", paper, note: String::new() });
}

/// Rays from the object's own surface outwards.
fn own_rays(model: &Model, field: &Field, count: u32) -> Vec<Ray> {
    let mesh = model.object.mesh();
    let directions = check::lines(Vec3::ZERO, 1.0, count);
    let triangles = mesh.triangles.len().max(1);
    let at = |(n, line): (usize, &Ray)| {
        let [a, b, c] = mesh.triangles.triangle(n.wrapping_mul(7919) % triangles);
        let normal = (b - a).cross(c - a).normalize_or(Vec3::Y);
        let way = (normal + 0.99 * line.direction).normalize_or(normal);
        Ray::new((a + b + c) / 3.0 + 1e-3 * field.sphere().radius * normal, way)
    };
    directions.iter().enumerate().map(at).collect()
}

/// Million look-ups per second on the device.
fn on_device(timer: &Timer<'_>, field: &Field, rays: &[Ray], blended: bool) -> Result<f64> {
    let gpu = timer.gpu;
    let Some(packed) = field.packed() else { return Ok(f64::NAN) };
    let fields = Fields::new(gpu, &[&packed])?;
    let mut objects = Objects::new(gpu, 1)?;
    objects.update(gpu, &fields, &[Placement::new(0, Mat4::IDENTITY, 0)])?;
    let packed: Vec<QueryRay> = rays
        .iter()
        .map(|r| QueryRay {
            origin: r.origin.extend(0.0).to_array(),
            direction: r.direction.extend(0.0).to_array(),
        })
        .collect();
    let input = Buffer::storage_with(gpu, "rays", &packed)?;
    let mut hits = Buffer::storage(gpu, "hits", rays.len() as u64 * HIT_BYTES)?;
    let query = RayQuery::new(gpu, rays.len() as u32, blended);
    query.update(gpu, &objects, rays.len() as u32);
    let time =
        timer.median(|| timer.submit(|e| query.record(gpu, e, &fields, &objects, &input, &mut hits)))?;
    Ok(rays.len() as f64 / time.ms / 1e3)
}

/// Figures 39 and 40, and the CPU beside.
pub(super) fn rates(timer: &Timer<'_>, models: &[Model], quick: bool, report: &mut Report) -> Result<()> {
    report.head("Rays per second (Figures 39 and 40)");
    let count = if quick { 100_000 } else { 1_000_000 };
    report.say(&format!(
        "{count} unsorted rays through the bounding sphere, and as many from the object's own surface; fields of 4226 x 64 x 64 bytes \
         ({} when quick). Millions a second: true rays (closest hit) and look-ups on the same threads of the CPU, and look-ups on the \
         device. In parentheses the papers', on a GeForce 8800 GTS with 121 rays per pixel in the order of pixels.",
        "1090 x 64 x 64"
    ));
    let mut lines = Vec::new();
    for model in models {
        let points = if quick { 1090 } else { 4226 };
        let (baker, field, _) = model.baked(Settings { points, ..Settings::default() })?;
        let sphere = field.sphere();
        let rays = check::lines(sphere.center, sphere.radius, count);
        // The best of three turns each, taken in turn, since others use the machine too.
        let mut best = [0.0f64; 2];
        for _ in 0..3 {
            best[0] = best[0].max(check::traced(&baker, &rays).1);
            best[1] = best[1].max(check::timed(&rays, |rays, found| field.nearest_many(rays, found)).1);
        }
        let own = own_rays(model, &field, count);
        let inter = on_device(timer, &field, &rays, false)?;
        let blended = on_device(timer, &field, &rays, true)?;
        let intra = on_device(timer, &field, &own, false)?;
        let paper =
            |table: &[(&str, f64)]| table.iter().find(|(name, _)| *name == model.name).map(|(_, rate)| *rate);
        let beside = |value: f64, paper: Option<f64>| match paper {
            Some(paper) => format!("{value:.2} ({paper})"),
            None => format!("{value:.2}"),
        };
        lines.push(vec![
            model.title(),
            format!("{:.2}", best[0]),
            format!("{:.2}, {:.1} times", best[1], best[1] / best[0]),
            beside(inter, paper(&FIGURE_39)),
            format!("{blended:.2}"),
            beside(intra, paper(&FIGURE_40)),
        ]);
        push(report, "rates", &model.title(), "true rays, CPU", best[0], None);
        push(report, "rates", &model.title(), "look-ups, CPU", best[1], None);
        push(report, "Figure 39", &model.title(), "look-ups, device", inter, paper(&FIGURE_39));
        push(report, "Figure 39", &model.title(), "look-ups by three maps, device", blended, None);
        push(
            report,
            "Figure 40",
            &model.title(),
            "look-ups from the object, device",
            intra,
            paper(&FIGURE_40),
        );
    }
    let header = [
        "model",
        "true rays, CPU",
        "look-ups, CPU",
        "look-ups, device",
        "by three maps",
        "from the object itself",
    ];
    report.table(&header.map(str::to_owned), &lines);
    Ok(())
}

/// The same object with more and more triangles, and the memory of its field.
pub(super) fn triangles(timer: &Timer<'_>, quick: bool, report: &mut Report) -> Result<()> {
    report.head("Triangles and memory");
    report.say("One shape at growing detail. A field knows nothing of triangles; the tree does.");
    let details: &[u32] = if quick { &[1, 3] } else { &[0, 1, 2, 3, 4] };
    let count = if quick { 50_000 } else { 500_000 };
    let mut series = ["true rays, CPU", "look-ups, CPU", "look-ups, device"]
        .map(|name| Series { name: name.to_owned(), points: Vec::new() });
    let mut lines = Vec::new();
    for &detail in details {
        let model = body("knot", detail)?;
        let settings = Settings { points: 1090, ..Settings::default() };
        let (baker, field, _) = model.baked(settings)?;
        let sphere = field.sphere();
        let rays = check::lines(sphere.center, sphere.radius, count);
        let rates = [
            check::traced(&baker, &rays).1,
            check::timed(&rays, |rays, found| field.nearest_many(rays, found)).1,
            on_device(timer, &field, &rays, false)?,
        ];
        let x = model.object.triangles() as f64;
        series.iter_mut().zip(rates).for_each(|(series, rate)| series.points.push((x, rate)));
        lines.push([vec![model.title()], rates.map(|r| format!("{r:.2}")).to_vec()].concat());
        for (metric, rate) in ["true rays, CPU", "look-ups, CPU", "look-ups, device"].into_iter().zip(rates) {
            push(report, "triangles", &model.title(), metric, rate, None);
        }
    }
    let header = ["model", "true rays, CPU", "look-ups, CPU", "look-ups, device"].map(str::to_owned);
    report.table(&header, &lines);
    let title = "Million rays per second against triangles".to_owned();
    report.plot(
        "triangles",
        &Plot { title, x: "triangles", y: "million rays per second", series: series.to_vec() },
    )?;
    let mib = |storage| {
        let settings = Settings { storage, ..Settings::default() };
        settings.bytes() as f64 / f64::from(1 << 20)
    };
    let (byte, bit) = (mib(Storage::Byte), mib(Storage::Bit));
    for (metric, value) in [("8 bits", byte), ("1 bit", bit)] {
        report.push(Row {
            figure: "memory",
            case: "4226 x 64 x 64".to_owned(),
            metric: metric.to_owned(),
            value,
            unit: "MiB",
            paper: (metric == "8 bits").then_some(16.508),
            note: String::new(),
        });
    }
    report.say(&format!("An object of 4226 x 64 x 64 directions takes {byte:.2} MiB with 8 bits (the papers' 16.508) and {bit:.2} MiB with 1 bit."));
    Ok(())
}
