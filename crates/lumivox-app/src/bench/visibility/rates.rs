//! Rays per second: true rays and look-ups on the same threads, and look-ups on the device (Figure 39).

use anyhow::Result;
use glam::Mat4;
use lumivox::gpu::Buffer;
use lumivox::visibility::{Fields, HIT_BYTES, Objects, OcclusionSettings, Placement, QueryRay, RayQuery};
use lumivox_field::{Baker, Field, Ray, Settings, Storage};

use super::models::{Model, detailed};
use super::surface::{Placed, Surface, side};
use crate::bench::plot::{Plot, Series};
use crate::bench::report::{Report, Row, ms};
use crate::bench::timing::Timer;
use crate::field::check;

/// Milliseconds, and million rays per second, of the papers' rays between objects.
const FIGURE_39: [(&str, [f64; 2]); 4] = [
    ("Bunny", [39.4, 614.21]),
    ("Horse", [73.3, 330.15]),
    ("Cow", [59.3, 408.09]),
    ("Dragon", [93.3, 259.37]),
];
/// Their rays per pixel.
const RAYS: u32 = 121;
/// Turns of which the best counts, since others use the machine too.
const TURNS: usize = 5;

fn push(report: &mut Report, figure: &'static str, case: &str, metric: &str, value: f64, paper: Option<f64>) {
    let (case, metric) = (case.to_owned(), metric.to_owned());
    report.push(Row { figure, case, metric, value, unit: "M/s", paper, note: String::new() });
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

/// Figure 39, and the CPU beside.
pub(super) fn rates(timer: &Timer<'_>, models: &[Model], quick: bool, report: &mut Report) -> Result<()> {
    report.head("Rays per second (Figure 39)");
    let count = if quick { 100_000 } else { 1_000_000 };
    let points = if quick { 1090 } else { 4226 };
    report.say(&format!(
        "{count} unsorted rays through the bounding sphere, fields of {points} x 64 x 64 bytes. Millions a second on the same threads of the CPU: true \
         rays (closest hit), look-ups of some rays at once (`nearest_many`) and of each by itself (`nearest`), and of three maps each (`blend`), the best of {TURNS} turns \
         taken in turn."
    ));
    let mut lines = Vec::new();
    let mut baked = Vec::new();
    for model in models {
        let (baker, field, _) = model.baked(Settings { points, ..Settings::default() })?;
        let best = on_threads(&baker, &field, count);
        let times = |n: usize| best[n] / best[0];
        lines.push(vec![
            model.title(),
            format!("{:.2}", best[0]),
            format!("{:.2}, {:.2} times", best[1], times(1)),
            format!("{:.2}, {:.2} times", best[2], times(2)),
            format!("{:.2}, {:.2} times", best[3], times(3)),
        ]);
        let metrics = ["true rays, CPU", "look-ups, CPU", "single look-ups, CPU", "three maps, CPU"];
        for (n, metric) in metrics.into_iter().enumerate() {
            push(report, "rates", &model.title(), metric, best[n], None);
        }
        baked.push((baker, field));
    }
    let header =
        ["model", "true rays", "look-ups at once", "look-ups one by one", "three maps"].map(str::to_owned);
    report.table(&header, &lines);

    let side = side(quick) / 2;
    let settings = OcclusionSettings { rays: RAYS, denoise: false, ..OcclusionSettings::default() };
    report.say(&format!(
        "On the device: the same rays from a buffer, by the nearest map and by three; and the occlusion of a floor of {side} x {side} pixels, {RAYS} rays \
         each in the order of pixels. In parentheses the papers', on a GeForce 8800 GTS with 200,000 pixels."
    ));
    let mut lines = Vec::new();
    for (model, (baker, field)) in models.iter().zip(&baked) {
        let rays = check::lines(field.sphere().center, field.sphere().radius, count);
        let nearest = on_device(timer, field, &rays, false)?;
        let blended = on_device(timer, field, &rays, true)?;
        let floor = Surface::floor(timer.gpu, baker.sphere(), side)?;
        let (time, _) = Placed::new(timer.gpu, &[field])?.occlusion(timer, &floor, settings)?;
        let rate = floor.shown() as f64 * f64::from(RAYS) / time.ms / 1e3;
        let paper = FIGURE_39.iter().find(|(name, _)| *name == model.name).map(|(_, v)| *v);
        let beside = |n: usize| paper.map_or(String::new(), |paper| format!(" ({})", paper[n]));
        lines.push(vec![
            model.title(),
            format!("{nearest:.2}"),
            format!("{blended:.2}"),
            format!("{}{}", ms(time.ms), beside(0)),
            format!("{rate:.2}{}", beside(1)),
        ]);
        push(report, "rates", &model.title(), "look-ups, device", nearest, None);
        push(report, "rates", &model.title(), "look-ups by three maps, device", blended, None);
        push(report, "Figure 39", &model.title(), "rays of occlusion, device", rate, paper.map(|p| p[1]));
    }
    let header = ["model", "nearest map", "three maps", "occlusion, ms", "occlusion, million rays/s"];
    report.table(&header.map(str::to_owned), &lines);
    Ok(())
}

/// Million true rays, look-ups at once, single look-ups and those of three maps a second on the CPU's threads.
fn on_threads(baker: &Baker, field: &Field, count: u32) -> [f64; 4] {
    let rays = check::lines(field.sphere().center, field.sphere().radius, count);
    let mut best = [0.0f64; 4];
    for _ in 0..TURNS {
        let turn = [
            check::traced(baker, &rays).1,
            check::timed(&rays, |rays, found| field.nearest_many(rays, found)).1,
            check::timed(&rays, |rays, found| {
                found.iter_mut().zip(rays).for_each(|(found, ray)| *found = field.nearest(ray));
            })
            .1,
            check::timed(&rays, |rays, found| {
                found.iter_mut().zip(rays).for_each(|(found, ray)| *found = field.blend(ray).hit());
            })
            .1,
        ];
        best.iter_mut().zip(turn).for_each(|(best, rate)| *best = best.max(rate));
    }
    best
}

/// The same object with more and more triangles, and the memory of its field.
pub(super) fn triangles(timer: &Timer<'_>, quick: bool, report: &mut Report) -> Result<()> {
    report.head("Triangles and memory");
    report.say("One shape at growing detail. A field knows nothing of triangles; the tree does. Million rays a second, the best of some turns.");
    let count = if quick { 50_000 } else { 500_000 };
    let mut series = ["true rays, CPU", "look-ups, CPU", "look-ups, device"]
        .map(|name| Series { name: name.to_owned(), points: Vec::new() });
    let mut lines = Vec::new();
    for model in detailed(quick)? {
        let settings = Settings { points: 1090, ..Settings::default() };
        let (baker, field, _) = model.baked(settings)?;
        let [traced, looked, ..] = on_threads(&baker, &field, count);
        let rays = check::lines(field.sphere().center, field.sphere().radius, count);
        let rates = [traced, looked, on_device(timer, &field, &rays, false)?];
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
