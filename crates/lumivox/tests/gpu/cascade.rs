//! Nested windows that follow the viewer: each level is a volume of its own, and look-ups have no seam.

use libtest_mimic::Failed;
use lumivox::core::{Grid, View};
use lumivox::glam::{IVec3, UVec2, UVec3, Vec2, Vec3, Vec4};
use lumivox::gpu::{Bindings, Buffer, ComputePass, Gpu, GpuError, Shader, read_buffer};
use lumivox::progressive::{
    AttributeView, CASCADE_QUERIES, CHANNELS, Cascade, ProgressiveVoxelizer, VoxelizerSettings, cascade_wgsl,
};
use lumivox::wgsl::linear_groups;

use crate::bricks::dense_channels;
use crate::progressive::{BALL, CHEST, FLOOR, SIZE, views};
use crate::support::{Random, Shot, channel, run};
use crate::{Labs, Test};

pub(crate) const TESTS: &[Test] = &[
    ("cascade: each level is a volume of its own", levels),
    ("cascade: what stays in a window stays, and only slabs that enter are empty", follows),
    ("cascade: shaders find what memory holds, the finest first", look_ups),
    ("cascade: look-ups have no seam where levels meet", no_seams),
    ("cascade: what cannot be is refused", refused),
];

/// Three levels of 16 cells a side: 4, 8 and 16 m.
const LEVELS: usize = 3;

fn finest() -> Grid {
    Grid { origin: Vec3::new(-3.0, -2.1, -2.5), cell_size: 0.25, dims: UVec3::splat(16) }
}

fn settings() -> VoxelizerSettings {
    VoxelizerSettings { bricks: 64, bricks_in_view: 64, ..VoxelizerSettings::default() }
}

fn cascade(gpu: &Gpu) -> Result<Cascade, GpuError> {
    Cascade::new(gpu, finest(), LEVELS, &dense_channels(), settings())
}

fn frame(gpu: &Gpu, cascade: &mut Cascade, center: Vec3, shot: &Shot) -> Result<(), GpuError> {
    let view = AttributeView::of(gpu, "test view", &shot.input);
    run(gpu, |e| cascade.record_frame(gpu, e, center, &[], &[(&view, &shot.view)]))
}

fn things(gpu: &Gpu) -> Result<Shot, GpuError> {
    Shot::take(gpu, views()[0].1, SIZE, &[FLOOR, BALL, CHEST])
}

/// A view in which nothing is changed.
fn away(gpu: &Gpu) -> Result<Shot, GpuError> {
    let up =
        View::orthographic(Vec3::new(0.0, 90.0, 0.0), Vec3::new(0.0, 99.0, 0.1), Vec3::X, Vec2::ONE, 10.0);
    Shot::take(gpu, up, UVec2::splat(16), &[])
}

fn levels(labs: &Labs) -> Result<(), Failed> {
    let gpu = &labs.core.gpu;
    let shot = things(gpu)?;
    let mut all = cascade(gpu)?;
    for center in [Vec3::new(0.3, -0.6, 0.1), Vec3::new(-0.9, -0.6, 1.2)] {
        frame(gpu, &mut all, center, &shot)?;
        // Nested: corners of coarse cells are corners of fine ones.
        for (n, level) in all.levels().iter().enumerate() {
            let grid = level.grid();
            assert_eq!((grid.cell_size, grid.dims), (0.25 * (1 << n) as f32, finest().dims));
            let apart = (grid.origin - finest().origin) / grid.cell_size;
            assert!((apart - apart.round()).abs().max_element() < 1e-3, "level {n}: {apart}");
            let middle = grid.origin + 0.5 * grid.cell_size * grid.dims.as_vec3();
            assert!((middle - center).abs().max_element() <= 2.001 * grid.cell_size, "level {n}: {middle}");
        }
    }
    for (n, level) in all.levels().iter().enumerate() {
        let mut alone = ProgressiveVoxelizer::new(gpu, level.grid(), &dense_channels(), settings())?;
        crate::bricks::frame(gpu, &mut alone, &[&shot])?;
        let (one, other) = (level.read_back(gpu)?, alone.read_back(gpu)?);
        for name in CHANNELS {
            let (one, other) = (channel(&one, name), channel(&other, name));
            let occupied = other.iter().filter(|v| v.length() > 0.0).count();
            assert!(name != CHANNELS[0] || occupied > 20, "level {n}: {occupied} cells");
            let near = |a: &Vec4, b: &Vec4| (*a - *b).abs().max_element() < 4e-3;
            // The other's sums are coarser: it allows for more points.
            for (index, (a, b)) in one.iter().zip(other).enumerate() {
                let cell = level.grid().cell(index);
                assert!(near(a, b), "level {n}, {name}, {cell}: {a} in the cascade, {b} alone");
            }
        }
    }
    assert!(all.diagnostics(gpu)?.iter().all(|d| d.occupied > 20 && d.refused == 0));
    Ok(())
}

fn world_cells(gpu: &Gpu, level: &ProgressiveVoxelizer) -> Result<Vec<(IVec3, Vec<Vec4>)>, GpuError> {
    let mut cells: Vec<_> = level.read_cells(gpu)?.into_iter().map(|c| (c.cell, c.values)).collect();
    cells.sort_by_key(|(cell, _)| cell.to_array());
    Ok(cells)
}

/// The cells of a level's window: the lowest, and one beyond the highest.
fn window(level: &ProgressiveVoxelizer) -> [IVec3; 2] {
    let first = ((level.grid().origin - finest().origin) / level.grid().cell_size).round().as_ivec3();
    [first, first + finest().dims.as_ivec3()]
}

fn follows(labs: &Labs) -> Result<(), Failed> {
    let gpu = &labs.core.gpu;
    let (shot, nothing) = (things(gpu)?, away(gpu)?);
    let mut all = cascade(gpu)?;
    let start = Vec3::new(0.0, -0.8, 0.0);
    frame(gpu, &mut all, start, &shot)?;
    let (mut kept, mut lost) = ([0; LEVELS], [0; LEVELS]);
    // A walk whose steps move the fine window often and the coarse ones seldom, and back again.
    let walk = [0.4, 1.1, 1.9, 2.8, 1.3, -0.2].map(|x| start + Vec3::new(x, 0.3, 0.5 * x));
    for center in walk {
        let mut before = Vec::new();
        for level in all.levels() {
            before.push((window(level), world_cells(gpu, level)?));
        }
        frame(gpu, &mut all, center, &nothing)?;
        for (n, (level, (old, cells))) in all.levels().iter().zip(before).enumerate() {
            let [low, high] = window(level);
            assert!((low - old[0]).rem_euclid(IVec3::splat(4)) == IVec3::ZERO, "not in whole bricks");
            let within = |c: IVec3| c.cmpge(low).all() && c.cmplt(high).all();
            let stays: Vec<_> = cells.iter().filter(|(cell, _)| within(*cell)).cloned().collect();
            kept[n] += stays.len();
            lost[n] += cells.len() - stays.len();
            assert!(world_cells(gpu, level)? == stays, "level {n}, {center}");
        }
    }
    assert!(kept.iter().all(|k| *k > 100) && lost[0] > 50 && lost[0] > lost[2], "{kept:?}, {lost:?}");
    Ok(())
}

/// Asks a cascade at points: level and occupancy of the cell there with a channel, and the blend.
struct Asker(ComputePass);

const ASK: &str = "
@group(0) @binding(4) var<storage, read> points: array<vec4f>;
@group(0) @binding(5) var<storage, read_write> answers: array<vec4f>;
@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= arrayLength(&points) { return; }
    let point = points[id.x].xyz;
    let cell = lumivox_cascade_find(point);
    answers[4u * id.x] = vec4f(f32(cell.level), select(0.0, 1.0, cell.is_occupied), 0.0, 0.0);
    if cell.is_occupied { answers[4u * id.x + 1u] = lumivox_cascade_value(cell, 1u); }
    let blend = lumivox_cascade_smooth(point, 1u);
    answers[4u * id.x + 2u] = vec4f(blend.coverage);
    answers[4u * id.x + 3u] = blend.value;
}";
const ASKER: Shader = Shader { name: "test/cascade", parts: &[CASCADE_QUERIES, ASK] };

impl Asker {
    fn new(gpu: &Gpu) -> Self {
        Self(ComputePass::new(gpu, &ASKER, &[]))
    }

    fn ask(&self, gpu: &Gpu, cascade: &Cascade, points: &[Vec3]) -> Result<Vec<[Vec4; 4]>, GpuError> {
        let points: Vec<Vec4> = points.iter().map(|p| p.extend(0.0)).collect();
        let points_buffer = Buffer::storage_with(gpu, "points", &points)?;
        let mut answers = Buffer::storage(gpu, "answers", 64 * points.len() as u64)?;
        let [table, headers, values] = cascade.buffers();
        let bindings = Bindings::new()
            .read("lumivox_cascade", cascade.uniform())
            .read("lumivox_cascade_table", table)
            .read("lumivox_cascade_headers", headers)
            .read("lumivox_cascade_values", values)
            .read("points", &points_buffer)
            .write("answers", &mut answers);
        run(gpu, |e| self.0.record(gpu, e, &bindings, linear_groups(points.len() as u32)))?;
        read_buffer(gpu, &answers)
    }
}

fn filled(gpu: &Gpu) -> Result<Cascade, GpuError> {
    let mut all = cascade(gpu)?;
    for center in [Vec3::new(1.4, -0.8, 0.2), Vec3::new(0.2, -0.9, -0.3)] {
        frame(gpu, &mut all, center, &things(gpu)?)?;
    }
    Ok(all)
}

fn look_ups(labs: &Labs) -> Result<(), Failed> {
    let gpu = &labs.core.gpu;
    let all = filled(gpu)?;
    let cells = all.read_back(gpu)?;
    let mut random = Random::new(3);
    // Half of them about the middle, where the finest level is, the others along the floor and beyond all.
    let spread = [Vec3::splat(4.0), Vec3::new(20.0, 2.5, 20.0)];
    let points: Vec<Vec3> =
        (0..4000).map(|n| Vec3::new(0.2, -0.9, -0.3) + spread[n % 2] * (random.cube() - 0.5)).collect();
    let answers = Asker::new(gpu).ask(gpu, &all, &points)?;
    let mut found = [0; LEVELS + 1];
    for (point, [head, value, coverage, blend]) in points.iter().zip(answers) {
        // Single precision may put a point on the other side of a cell's border.
        let near_border = all.levels().iter().any(|level| {
            let at = (*point - level.grid().origin) / level.grid().cell_size;
            (at - at.round()).abs().min_element() < 1e-4
        });
        let expected = cells.find(*point);
        let level = expected.map_or(LEVELS, |(level, _)| level);
        if !near_border {
            assert_eq!(head.x as usize, level, "{point}");
            let here = expected.and_then(|(_, values)| values);
            assert_eq!(head.y == 1.0, here.is_some(), "{point}");
            assert_eq!(value, here.map_or(Vec4::ZERO, |values| values[1]), "{point}");
            found[level] += usize::from(here.is_some() || level == LEVELS);
        }
        let smooth = cells.smooth(*point);
        assert!((coverage.x - smooth.coverage).abs() < 1e-3, "{point}: {coverage}, {smooth:?}");
        assert!((blend - smooth.values[1]).abs().max_element() < 1e-3, "{point}: {blend}, {smooth:?}");
    }
    assert!(found.iter().all(|n| *n > 10), "cells found by level, and points outside: {found:?}");
    // The same text at other bindings.
    let moved = cascade_wgsl(2, 5);
    assert!(moved.contains("@group(2) @binding(8) var<storage, read> lumivox_cascade_values"), "{moved}");
    Ok(())
}

/// Along lines over the floor, out of the finest window, out of the next, and out of all.
fn no_seams(labs: &Labs) -> Result<(), Failed> {
    let gpu = &labs.core.gpu;
    let all = filled(gpu)?;
    let cells = all.read_back(gpu)?;
    let asker = Asker::new(gpu);
    let step = 0.25 / 32.0;
    let (mut steepest, mut jumps, mut shown) = (0f32, 0, 0);
    for (from, along) in [
        (Vec3::new(0.2, -1.4, -0.3), Vec3::X),
        (Vec3::new(0.4, -1.4, -0.1), Vec3::NEG_Z),
        (Vec3::new(0.1, -1.45, 0.2), Vec3::new(-0.6, 0.0, 0.8)),
        (Vec3::new(0.3, -0.3, -0.2), Vec3::new(0.5, 0.1, -0.6).normalize_or_zero()),
    ] {
        let points: Vec<Vec3> = (0..1300).map(|n| from + step * n as f32 * along).collect();
        let answers = asker.ask(gpu, &all, &points)?;
        for (pair, points) in answers.windows(2).zip(points.windows(2)) {
            let apart = |n: usize| (pair[0][n] - pair[1][n]).abs().max_element();
            steepest = steepest.max(apart(2)).max(apart(3));
            shown += usize::from(pair[0][2].x > 0.1);
            // What is found there without a blend does jump from level to level.
            let level = |p: Vec3| cells.find(p).map_or(LEVELS, |(level, _)| level);
            jumps += usize::from(level(points[0]) != level(points[1]));
        }
        assert!(answers.last().is_some_and(|a| a[2].x == 0.0), "the last level does not end");
    }
    eprintln!(
        "steepest change {steepest} in 1/32 of the finest cell, {jumps} borders, {shown} points with something"
    );
    // Linear between middles of cells: along a line at most the sum of three slopes of 1 a cell, and 1/4 a cell of the blend.
    let bound = (3f32.sqrt() + 0.25) / 32.0;
    assert!(steepest <= 1.001 * bound && steepest > 0.2 * bound, "{steepest}, at most {bound}");
    assert!(jumps >= 8 && shown > 300, "{jumps} borders, {shown} points");
    Ok(())
}

fn refused(labs: &Labs) -> Result<(), Failed> {
    let gpu = &labs.core.gpu;
    let make = |count, settings| Cascade::new(gpu, finest(), count, &dense_channels(), settings).map(|_| ());
    assert!(make(0, settings()).is_err() && make(9, settings()).is_err());
    assert!(Cascade::new(gpu, finest(), 2, &[], settings()).is_err());
    // Each level fits, and all of them do not.
    let many = VoxelizerSettings { bricks: 40_000, bricks_in_view: 64, ..settings() };
    assert!(make(2, many).is_ok());
    assert!(matches!(make(3, many), Err(GpuError::TooLarge { .. })));
    // Sides that are no whole bricks become so.
    let odd = Grid { dims: UVec3::new(13, 1, 16), ..finest() };
    let rounded = Cascade::new(gpu, odd, 2, &dense_channels(), settings())?;
    assert!(rounded.levels().iter().all(|l| l.grid().dims == UVec3::new(16, 4, 16)));
    assert!(rounded.bytes() > 0);
    Ok(())
}
