//! What frames did: numbers of a scene that can be counted by hand, and frames that come to memory without a wait.

use libtest_mimic::Failed;
use lumivox::core::View;
use lumivox::glam::{UVec2, Vec2, Vec3};
use lumivox::gpu::{Gpu, GpuError};
use lumivox::progressive::{AttributeView, Cascade, FrameClock, FrameDiagnostics, ProgressiveVoxelizer};
use lumivox::wgpu;

use crate::bricks::{dense_channels, frame, settings, voxelizer};
use crate::progressive::{FLOOR, grid};
use crate::support::{SCALE, Shot, run};
use crate::{Labs, Test};

pub(crate) const TESTS: &[Test] = &[
    ("diagnostics: a frame of known cells has the numbers it must have", known_numbers),
    ("diagnostics: frames come to memory once, in order and by themselves", in_order),
    ("diagnostics: nothing waits for frames that are not done", never_waits),
    ("diagnostics: levels of a cascade tell of the same frame", of_cascades),
    ("diagnostics: the device's clock is asked where it can be trusted", clocks),
];

/// From above, 8 x 8 cells of the floor with 4 x 4 texels each, in 2 x 3 bricks.
fn above(gpu: &Gpu, is_drawn: bool) -> Result<Shot, GpuError> {
    let view = View::orthographic(Vec3::new(0.0, 2.0, 0.0), Vec3::ZERO, Vec3::NEG_Z, Vec2::splat(2.0), 8.0);
    Shot::take(gpu, view, UVec2::splat(32), if is_drawn { &[FLOOR] } else { &[] })
}

fn known_numbers(labs: &Labs) -> Result<(), Failed> {
    let gpu = &labs.core.gpu;
    let mut bricks = voxelizer(gpu, settings())?;
    assert_eq!(bricks.diagnostics(gpu, None)?, FrameDiagnostics::default());
    let floor = above(gpu, true)?;
    // Sums of 13 words, values of 24 bytes; a view.
    let (of_bricks, of_touched, of_cells) = (6 * (28 + 24), 6 * 260, 64 * (3 * 52 + 24 + 16));
    let first = frame(gpu, &mut bricks, &[&floor])?;
    let expected = FrameDiagnostics {
        frame: 1,
        occupied: 64,
        points: 1024,
        injected: 64,
        new: 64,
        bricks: 6,
        entered: 6,
        bytes: of_bricks + of_touched + of_cells,
        point_bytes: 1024 * (16 + 12 + 2 * 52) - 64 * 52,
        ..FrameDiagnostics::default()
    };
    assert_eq!(first, expected);
    let again = frame(gpu, &mut bricks, &[&floor])?;
    assert_eq!(again, FrameDiagnostics { frame: 2, new: 0, entered: 0, ..expected });
    // Cells on the border of the picture reach out of it.
    let gone = frame(gpu, &mut bricks, &[&above(gpu, false)?])?;
    let none = FrameDiagnostics { points: 0, injected: 0, point_bytes: 0, bytes: of_bricks, ..expected };
    assert_eq!(gone, FrameDiagnostics { frame: 3, occupied: 28, cleaned: 36, new: 0, entered: 0, ..none });
    assert_eq!(bricks.diagnostics(gpu, Some(2.5))?, FrameDiagnostics { milliseconds: Some(2.5), ..gone });
    Ok(())
}

/// A frame's commands, not submitted.
fn commands(
    gpu: &Gpu,
    volume: &mut ProgressiveVoxelizer,
    shot: &Shot,
    view: &AttributeView,
) -> Result<wgpu::CommandBuffer, GpuError> {
    volume.update(gpu, &[]);
    view.update(gpu, &shot.view, SCALE.attribute_points, volume.frame());
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    volume.record(gpu, &mut encoder, &[view])?;
    Ok(encoder.finish())
}

fn polled(gpu: &Gpu, volume: &mut ProgressiveVoxelizer) -> Result<Vec<FrameDiagnostics>, GpuError> {
    std::iter::from_fn(|| volume.poll_diagnostics(gpu).transpose()).collect()
}

fn in_order(labs: &Labs) -> Result<(), Failed> {
    let gpu = &labs.core.gpu;
    let mut bricks = voxelizer(gpu, settings())?;
    let shots = [above(gpu, true)?, above(gpu, false)?];
    let views = shots.each_ref().map(|shot| AttributeView::of(gpu, "test view", &shot.input));
    run_frame(gpu, &mut bricks, &shots[0], &views[0])?;
    assert_eq!(bricks.poll_diagnostics(gpu)?, None, "nobody asked for frames");
    bricks.keep_diagnostics(gpu, FrameClock::Off);
    let (mut given, mut waited) = (Vec::new(), Vec::new());
    for n in 0..12 {
        run_frame(gpu, &mut bricks, &shots[n % 2], &views[n % 2])?;
        waited.push(bricks.diagnostics(gpu, None)?);
        // Every third frame asks for all that is there.
        if n % 3 == 2 {
            given.extend(polled(gpu, &mut bricks)?);
        }
    }
    assert_eq!(given, waited);
    // Who does not ask gets the last four; after those there is nothing.
    for _ in 0..7 {
        run_frame(gpu, &mut bricks, &shots[0], &views[0])?;
    }
    let last: Vec<u32> = polled(gpu, &mut bricks)?.iter().map(|d| d.frame).collect();
    let newest = bricks.frame();
    assert_eq!(last, [newest - 3, newest - 2, newest - 1, newest]);
    assert_eq!(bricks.poll_diagnostics(gpu)?, None);
    Ok(())
}

fn run_frame(
    gpu: &Gpu,
    volume: &mut ProgressiveVoxelizer,
    shot: &Shot,
    view: &AttributeView,
) -> Result<(), GpuError> {
    gpu.queue.submit([commands(gpu, volume, shot, view)?]);
    gpu.wait()
}

/// Frames that are recorded and not submitted: a wait for them would never end.
fn never_waits(labs: &Labs) -> Result<(), Failed> {
    let gpu = &labs.core.gpu;
    let mut bricks = voxelizer(gpu, settings())?;
    bricks.keep_diagnostics(gpu, FrameClock::Off);
    let shot = above(gpu, true)?;
    let view = AttributeView::of(gpu, "test view", &shot.input);
    let mut recorded = Vec::new();
    for _ in 0..6 {
        recorded.push(commands(gpu, &mut bricks, &shot, &view)?);
        assert_eq!(bricks.poll_diagnostics(gpu)?, None);
    }
    // The third is thrown away, and for the last two there was no room.
    recorded.remove(2);
    gpu.queue.submit(recorded.drain(..));
    gpu.wait()?;
    let frames: Vec<u32> = polled(gpu, &mut bricks)?.iter().map(|d| d.frame).collect();
    assert_eq!(frames, [1, 2, 4]);
    // Its room is given back.
    for n in 0..3 {
        run_frame(gpu, &mut bricks, &shot, &view)?;
        assert_eq!(bricks.poll_diagnostics(gpu)?.map(|d| d.frame), Some(7 + n));
    }
    Ok(())
}

fn of_cascades(labs: &Labs) -> Result<(), Failed> {
    let gpu = &labs.core.gpu;
    let mut cascade = Cascade::new(gpu, grid(), 3, &dense_channels(), settings())?;
    let shot = above(gpu, true)?;
    let view = AttributeView::of(gpu, "test view", &shot.input);
    cascade.keep_diagnostics(gpu, FrameClock::Off);
    for n in 1..4 {
        let center = Vec3::new(0.3 * n as f32, -1.0, 0.0);
        run(gpu, |e| cascade.record_frame(gpu, e, center, &[], &[(&view, &shot.view)]))?;
        let given = cascade.poll_diagnostics(gpu)?;
        assert_eq!(given.as_ref(), Some(&cascade.diagnostics(gpu)?));
        let given = given.unwrap_or_default();
        assert!(given.len() == 3 && given.iter().all(|d| d.frame == n && d.occupied > 0), "{given:?}");
        assert_eq!(cascade.poll_diagnostics(gpu)?, None);
    }
    Ok(())
}

fn clocks(labs: &Labs) -> Result<(), Failed> {
    for gpu in [&labs.core.gpu, &labs.native.gpu] {
        let has_stamps = gpu.device.features().contains(wgpu::Features::TIMESTAMP_QUERY);
        let shot = above(gpu, true)?;
        let view = AttributeView::of(gpu, "test view", &shot.input);
        for (clock, is_timed) in [
            (FrameClock::Off, false),
            (FrameClock::Timestamps, has_stamps && !gpu.is_software()),
            (FrameClock::AnyTimestamps, has_stamps),
        ] {
            let mut bricks = voxelizer(gpu, settings())?;
            bricks.keep_diagnostics(gpu, clock);
            let clock_before = std::time::Instant::now();
            run_frame(gpu, &mut bricks, &shot, &view)?;
            let outside = 1e3 * clock_before.elapsed().as_secs_f64();
            let done = bricks.poll_diagnostics(gpu)?.ok_or("the frame is done")?;
            assert_eq!((done.frame, done.occupied), (1, 64), "{clock:?}");
            eprintln!("{clock:?}: {:?} ms of {outside:.2} outside", done.milliseconds);
            assert_eq!(done.milliseconds.is_some(), is_timed, "{clock:?}");
            assert!(done.milliseconds.is_none_or(|inside| inside >= 0.0 && inside <= outside), "{clock:?}");
        }
    }
    Ok(())
}
