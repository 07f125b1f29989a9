//! Look-ups in a field beside rays through the tree that baked it: the same unsorted rays, the same threads, closest
//! hits, taken in turns; best of all turns.
//!
//! ```text
//! cargo run --release -p lumivox-field --example lookup_speed -- bunny.ply [POINTS [DIRECTIONS [BITS]]]
//! ```
//!
//! The field is kept in the current folder and baked when it is not there.

use std::ops::ControlFlow;
use std::path::Path;
use std::time::Instant;

use anyhow::{Context, Result};
use glam::Vec3;
use lumivox_field::{Baker, Cache, Ray, Settings, Storage};
use rayon::prelude::*;

#[path = "common/model.rs"]
mod model;

const RAYS: usize = 1_000_000;
const TURNS: usize = 5;

/// Lines through the sphere, each from a point outside, in no order.
fn lines(center: Vec3, radius: f32) -> Vec<Ray> {
    let mut state = 1u64;
    let mut unit = move || {
        state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (state >> 40) as f32 / (1u64 << 24) as f32
    };
    let mut on_sphere = move || {
        let (z, turn) = (2.0 * unit() - 1.0, std::f32::consts::TAU * unit());
        let r = (1.0 - z * z).sqrt();
        Vec3::new(r * turn.cos(), r * turn.sin(), z)
    };
    let mut line = || {
        let (a, b) = (on_sphere(), on_sphere());
        let direction = (b - a).normalize_or(-a);
        Ray::new(center + radius * (a - direction), direction)
    };
    (0..RAYS).map(|_| line()).collect()
}

type Answers = Vec<Option<f32>>;

/// Million rays per second, and the answers. `answer` gets some thousand rays at a time.
fn timed(rays: &[Ray], answer: impl Fn(&[Ray], &mut [Option<f32>]) + Sync) -> (f64, Answers) {
    let mut answers = vec![None; rays.len()];
    let start = Instant::now();
    rays.par_chunks(4096).zip(answers.par_chunks_mut(4096)).for_each(|(rays, answers)| answer(rays, answers));
    (rays.len() as f64 / start.elapsed().as_secs_f64() / 1e6, answers)
}

/// The same for an answer to one ray.
fn each(rays: &[Ray], answer: impl Fn(&Ray) -> Option<f32> + Sync) -> (f64, Answers) {
    timed(rays, |rays, answers| answers.iter_mut().zip(rays).for_each(|(a, ray)| *a = answer(ray)))
}

#[expect(clippy::print_stdout, reason = "an example that reports")]
fn main() -> Result<()> {
    let mut arguments = std::env::args().skip(1);
    let name = arguments.next().context("which mesh file?")?;
    let mut number = |default| arguments.next().map_or(Ok(default), |text| text.parse::<u32>());
    let settings = Settings {
        points: number(4226)?,
        directions: number(64)?,
        storage: Storage::from_bits(number(8)?)?,
        ..Settings::default()
    };
    let model = model::Model::load(&name)?;
    let baker = Baker::new(model.mesh(), settings)?;
    let cache = Cache::new(Path::new("."));
    let field = cache.field(model.mesh(), settings, |_| ControlFlow::Continue(()))?.field;

    let sphere = field.sphere();
    let rays = lines(sphere.center, sphere.radius);
    let (mut best, mut ratios) = ([0.0f64; 4], Vec::new());
    let mut answers = [const { Vec::new() }; 4];
    for _ in 0..TURNS {
        let turn = [
            each(&rays, |ray| baker.trace(ray)),
            timed(&rays, |rays, answers| field.nearest_many(rays, answers)),
            each(&rays, |ray| field.nearest(ray)),
            each(&rays, |ray| field.blend(ray).hit()),
        ];
        ratios.push([1, 2, 3].map(|n| turn[n].0 / turn[0].0));
        for (n, (rate, answer)) in turn.into_iter().enumerate() {
            best[n] = best[n].max(rate);
            answers[n] = answer;
        }
    }
    println!("{name}: {} triangles, {} threads, {RAYS} unsorted rays", model.triangles(), {
        rayon::current_num_threads()
    });
    let median = |which: usize| {
        let mut all: Vec<_> = ratios.iter().map(|r| r[which]).collect();
        all.sort_by(f64::total_cmp);
        all[TURNS / 2]
    };
    println!("tree, closest hit: {:.2} million rays/s", best[0]);
    for (n, what) in [(1, "nearest map, many"), (2, "nearest map, one by one"), (3, "three maps")] {
        let pairs = || answers[0].iter().zip(&answers[n]);
        let wrong = pairs().filter(|(a, b)| a.is_some() != b.is_some()).count() as f64 / RAYS as f64;
        let apart: Vec<f64> = pairs()
            .filter_map(|(a, b)| Some(f64::from((*a)? - (*b)?) / f64::from(2.0 * sphere.radius)))
            .collect();
        let rms = (apart.iter().map(|d| d * d).sum::<f64>() / apart.len().max(1) as f64).sqrt();
        println!(
            "{what}: {:.2} million look-ups/s, {:.2} times the tree (median of {TURNS} turns: {:.2}); wrong verdicts \
             {:.2} %, distance off by {:.2} % of 2 R (RMS where both hit)",
            best[n],
            best[n] / best[0],
            median(n - 1),
            100.0 * wrong,
            100.0 * rms
        );
    }
    Ok(())
}
