//! Gathered light whose surfels take turns: the same in the end, never later than promised, and in even steps.

use libtest_mimic::Failed;
use lumivox::gather::{GatherSettings, Quality};
use lumivox::glam::{UVec3, Vec3, Vec4};
use lumivox::gpu::{Gpu, GpuError};

use crate::cells::Cells;
use crate::gather::{Room, upload};
use crate::support::run;
use crate::{Labs, Test};

pub(crate) const TESTS: &[Test] = &[
    ("gather turns: light settles to that of whole frames", settles),
    ("gather turns: pixels see even steps", even_steps),
    ("gather turns: every n-th frame, pixels see even steps", every_nth),
    ("gather turns: a new surfel is lit at once", at_once),
    ("gather turns: a frame serves those whose turn it is", work),
    ("gather turns: the same frames give the same bits", same_bits),
    ("gather turns: a lamp that is switched on is seen within eight frames", seen_in_time),
];

const SIDE: u32 = 12;

/// A room and its lamp's cell, which is dark.
fn room(albedo: f32) -> (Cells, usize) {
    let mut cells = Cells::new(SIDE);
    cells.room(1, SIDE - 2, albedo, 0.0);
    let lamp = cells.grid.index(UVec3::new(5, 1, 6));
    (cells, lamp)
}

fn lit(albedo: f32) -> Cells {
    let (mut cells, lamp) = room(albedo);
    cells.emission[lamp] = Vec4::splat(40.0);
    cells
}

type Sides = Vec<[Option<Vec3>; 6]>;

fn pairs<'a>(a: &'a Sides, b: &'a Sides) -> impl Iterator<Item = (f32, f32)> + 'a {
    a.iter().flatten().zip(b.iter().flatten()).filter_map(|(a, b)| Some(((*a)?.x, (*b)?.x)))
}

fn sum(sides: &Sides) -> f32 {
    sides.iter().flatten().flatten().map(|e| e.x).sum()
}

fn settles(labs: &Labs) -> Result<(), Failed> {
    let gpu = &labs.core.gpu;
    let cells = lit(0.6);
    let settings = GatherSettings { rays: 32, ..GatherSettings::default() };
    let mut whole = Room::new(gpu, &cells, settings)?;
    whole.frame(gpu, 40)?;
    let expected = [whole.light.read_irradiance(gpu)?, whole.light.read_shown(gpu)?];
    for frames in [2.0, 5.5] {
        let mut turns = Room::new(gpu, &cells, GatherSettings { frames, ..settings })?;
        for _ in 0..60 {
            turns.frame(gpu, 2)?;
        }
        let found = [turns.light.read_irradiance(gpu)?, turns.light.read_shown(gpu)?];
        for (found, expected) in found.iter().zip(&expected) {
            let worst = pairs(found, expected).map(|(a, b)| (a - b).abs() / b.max(1e-2)).fold(0.0, f32::max);
            eprintln!("rounds of {frames} frames: off by {worst:.5} at most");
            assert!(worst < 5e-3, "rounds of {frames} frames: {worst}");
        }
    }
    Ok(())
}

/// What pixels see in each of `count` frames after the lamp is switched on, as parts of what they see in the end.
fn after_switch(
    gpu: &Gpu,
    settings: GatherSettings,
    (albedo, bounces, count): (f32, u32, u32),
    begin: impl Fn(&mut Room, u32),
) -> Result<Vec<Sides>, GpuError> {
    let mut room = Room::new(gpu, &room(albedo).0, settings)?;
    let frame = |room: &mut Room, n: u32| {
        begin(room, n);
        let Room { volume, light } = room;
        run(gpu, |e| {
            light.record_surfels(gpu, e, volume)?;
            light.record_dark(gpu, e)?;
            light.record_trace(gpu, e, volume)?;
            light.record_bounces(gpu, e, volume, bounces)
        })
    };
    // All rays are traced in the dark.
    (0..24).try_for_each(|n| frame(&mut room, n))?;
    assert_eq!(sum(&room.light.read_shown(gpu)?), 0.0);
    upload(gpu, &mut room.volume, &lit(albedo))?;
    (24..24 + count)
        .map(|n| {
            frame(&mut room, n)?;
            room.light.read_shown(gpu)
        })
        .collect()
}

/// The most that any surfel's light changes from a frame to the next, as a part of what it is in the end.
fn largest_step(shown: &[Sides]) -> f32 {
    let Some(last) = shown.last() else { return 0.0 };
    let before = std::iter::once(None).chain(shown.iter().map(Some));
    let step = |(before, now): (Option<&Sides>, &Sides)| {
        let place = |n: usize, side: usize| before.and_then(|b| b[n][side]).map_or(0.0, |e| e.x);
        let mut most = 0f32;
        for (n, (now, last)) in now.iter().zip(last).enumerate() {
            for side in 0..6 {
                if let (Some(now), Some(last)) = (now[side], last[side].filter(|e| e.x > 1e-2)) {
                    most = most.max((now.x - place(n, side)).abs() / last.x);
                }
            }
        }
        most
    };
    before.zip(shown).map(step).fold(0.0, f32::max)
}

fn even_steps(labs: &Labs) -> Result<(), Failed> {
    let gpu = &labs.core.gpu;
    // Black walls: there is one bounce, which surfels have when their turn has come.
    let settings = GatherSettings { rays: 32, ..GatherSettings::default() };
    let at_once = after_switch(gpu, settings, (0.0, 1, 16), |room, _| room.light.begin_frame(gpu))?;
    assert!((largest_step(&at_once) - 1.0).abs() < 1e-3);
    for frames in [4.0, 8.0] {
        let settings = GatherSettings { frames, ..settings };
        let shown = after_switch(gpu, settings, (0.0, 1, 24), |room, _| room.light.begin_frame(gpu))?;
        let step = largest_step(&shown);
        eprintln!("rounds of {frames} frames: steps of {step:.3} at most");
        // Halves round.
        assert!(step > 0.5 / frames && step < 1.02 / frames, "rounds of {frames} frames: {step}");
        // A round until the last has its turn, one until that is seen, and one until what it takes from those beside it is.
        for (rounds, within) in [(2, 3e-2), (3, 1e-2)] {
            let there = sum(&shown[rounds * frames as usize - 1]) / sum(&at_once[15]);
            assert!((there - 1.0).abs() < within, "rounds of {frames} frames: {there} after {rounds}");
        }
    }
    Ok(())
}

fn every_nth(labs: &Labs) -> Result<(), Failed> {
    let gpu = &labs.core.gpu;
    let settings = GatherSettings { rays: 32, ..GatherSettings::default() };
    let nth = |room: &mut Room, n: u32| room.light.begin_nth_frame(gpu, n, 4);
    let shown = after_switch(gpu, settings, (0.0, 1, 8), nth)?;
    let total = sum(&shown[7]);
    let parts: Vec<f32> = shown.iter().map(|s| sum(s) / total).collect();
    // The switch falls on a frame of new light.
    for (part, expected) in parts.iter().zip([0.25, 0.5, 0.75, 1.0, 1.0, 1.0, 1.0, 1.0]) {
        assert!((part - expected).abs() < 1e-2, "{parts:?}");
    }
    Ok(())
}

fn at_once(labs: &Labs) -> Result<(), Failed> {
    let gpu = &labs.core.gpu;
    let cells = lit(0.5);
    let settings = GatherSettings { rays: 64, ..GatherSettings::default() };
    let mut whole = Room::new(gpu, &cells, settings)?;
    whole.frame(gpu, 2)?;
    let expected = sum(&whole.light.read_shown(gpu)?);
    let mut turns = Room::new(gpu, &cells, GatherSettings { frames: 64.0, ..settings })?;
    turns.frame(gpu, 2)?;
    let ratio = sum(&turns.light.read_shown(gpu)?) / expected;
    eprintln!("{ratio:.3} of the light");
    assert!((ratio - 1.0).abs() < 1e-3, "{ratio}");
    Ok(())
}

/// Rays and bounces are dispatched for the surfels on the list alone.
fn work(labs: &Labs) -> Result<(), Failed> {
    let gpu = &labs.core.gpu;
    let cells = lit(0.6);
    let settings = GatherSettings { rays: 8, ..GatherSettings::default() };
    let mut whole = Room::new(gpu, &cells, settings)?;
    whole.frame(gpu, 1)?;
    let all = whole.light.count(gpu)?;
    assert_eq!(all.due, all.used);
    let mut turns = Room::new(gpu, &cells, GatherSettings { frames: 8.0, ..settings })?;
    // All are new until their first turn.
    let mut due = Vec::new();
    for _ in 0..16 {
        turns.frame(gpu, 1)?;
        due.push(turns.light.count(gpu)?.due);
    }
    eprintln!("of {} surfels, in rounds of eight frames: {due:?}", all.used);
    assert_eq!(due[0], all.used);
    assert_eq!(due[8..].iter().sum::<u32>(), all.used, "a round serves all once: {due:?}");
    assert!(due[8..].iter().all(|n| (all.used / 20..all.used / 4).contains(n)), "{due:?}");
    // Frames between updates serve nobody.
    turns.light.begin_nth_frame(gpu, 1, 4);
    let Room { volume, light } = &mut turns;
    run(gpu, |e| light.record_trace(gpu, e, volume))?;
    assert_eq!(light.count(gpu)?.due, 0);
    Ok(())
}

fn seen_in_time(labs: &Labs) -> Result<(), Failed> {
    let gpu = &labs.core.gpu;
    // Black walls have one bounce; of all bounces more than the goal only where rounds are short.
    for (quality, bounces, albedo) in
        [(Quality::Low, 1, 0.0), (Quality::Medium, 2, 0.0), (Quality::Medium, 2, 0.6)]
    {
        let settings = GatherSettings::of(quality);
        let shown = after_switch(gpu, settings, (albedo, bounces, 8), |room, _| room.light.begin_frame(gpu))?;
        let mut room = Room::new(gpu, &lit(albedo), GatherSettings { frames: 1.0, ..settings })?;
        room.frame(gpu, 60)?;
        let there = sum(&shown[7]) / sum(&room.light.read_shown(gpu)?);
        eprintln!("{quality:?}, albedo {albedo}: {there:.3} of it after eight frames");
        assert!(there > 0.9, "{quality:?}, albedo {albedo}: {there}");
    }
    Ok(())
}

fn same_bits(labs: &Labs) -> Result<(), Failed> {
    let gpu = &labs.core.gpu;
    let frames = |gpu: &Gpu| -> Result<Vec<Sides>, GpuError> {
        let settings = GatherSettings { rays: 16, frames: 3.0, ..GatherSettings::default() };
        after_switch(gpu, settings, (0.6, 2, 5), |room, _| room.light.begin_frame(gpu))
    };
    let first = frames(gpu)?;
    for _ in 0..3 {
        assert!(frames(gpu)? == first, "light differs from run to run");
    }
    Ok(())
}
