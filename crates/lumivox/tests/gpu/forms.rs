//! The forms of progressive voxelization: whatever cells lie in, they are the same.

use libtest_mimic::Failed;
use lumivox::core::{Grid, HostVolume};
use lumivox::gpu::{Gpu, GpuError};
use lumivox::progressive::{
    AttributeChannel, AttributeKind, AttributeView, CHANNELS, CleanupRule, DenseVoxelizer, InjectionPattern,
    ProgressiveVoxelizer, Storage, ViewInput, VoxelizerSettings,
};
use lumivox::volume::NORMAL;

use crate::bricks::{dense_channels, settings};
use crate::progressive::{BALL, CHEST, FLOOR, SIZE, grid, views};
use crate::random_views::{ODD_SEEDS, RANDOM_SEEDS, random_grid, random_shot};
use crate::support::{Random, SCALE, Shot, World, channel, run};
use crate::{Labs, Test};

pub(crate) const TESTS: &[Test] = &[
    ("forms: bricks, of random views, are the fixed channels over all cells", bricks),
    ("forms: buffers, of random views, are the fixed channels over all cells", buffers),
    ("forms: 3D textures, of random views, are the fixed channels over all cells", textures),
    ("forms: one to eight channels are the same in buffers, 3D textures and bricks", any_channels),
    ("forms: a volume that cannot be is refused", refused),
];

/// A volume in one of the forms.
pub(crate) enum Form {
    Bricks(Box<ProgressiveVoxelizer>),
    Dense(Box<DenseVoxelizer>),
}

/// How one is made.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Kind {
    Bricks,
    Dense(Storage),
}

impl Kind {
    pub(crate) fn make(
        self,
        gpu: &Gpu,
        grid: Grid,
        channels: &[AttributeChannel],
        rule: CleanupRule,
    ) -> Result<Form, GpuError> {
        Ok(match self {
            Self::Bricks => {
                let settings = VoxelizerSettings { cleanup: rule, ..settings() };
                Form::Bricks(Box::new(ProgressiveVoxelizer::new(gpu, grid, channels, settings)?))
            }
            Self::Dense(storage) => {
                Form::Dense(Box::new(DenseVoxelizer::new(gpu, grid, channels, storage, rule)?))
            }
        })
    }
}

impl Form {
    /// Frame `number` of these views, the first of which is 1.
    pub(crate) fn frame(
        &mut self,
        gpu: &Gpu,
        views: &[(AttributeView, &Shot)],
        number: u32,
    ) -> Result<(), GpuError> {
        if let Self::Bricks(bricks) = self {
            bricks.update(gpu, &[]);
            assert_eq!(bricks.frame(), number);
        }
        for (view, shot) in views {
            view.update(gpu, &shot.view, SCALE.attribute_points, number);
        }
        let views: Vec<_> = views.iter().map(|(view, _)| view).collect();
        run(gpu, |e| match self {
            Self::Bricks(bricks) => bricks.record(gpu, e, &views),
            Self::Dense(dense) => dense.record(gpu, e, &views),
        })
    }

    pub(crate) fn read(&self, gpu: &Gpu) -> Result<HostVolume, GpuError> {
        match self {
            Self::Bricks(bricks) => bricks.read_back(gpu),
            Self::Dense(dense) => dense.read_back(gpu),
        }
    }
}

fn count(volume: &HostVolume, normal: &str) -> usize {
    channel(volume, normal).iter().filter(|v| v.w > 0.0).count()
}

fn bricks(labs: &Labs) -> Result<(), Failed> {
    equal_to_fixed(labs, Kind::Bricks)
}

fn buffers(labs: &Labs) -> Result<(), Failed> {
    equal_to_fixed(labs, Kind::Dense(Storage::Buffers))
}

fn textures(labs: &Labs) -> Result<(), Failed> {
    equal_to_fixed(labs, Kind::Dense(Storage::Textures))
}

/// A random view: every other one with some of its points, and every other one in any order, split over two to four frames.
fn patterned(gpu: &Gpu, grid: &Grid, seed: u64) -> Result<(Shot, InjectionPattern, u32), GpuError> {
    let mut random = Random::new(seed.wrapping_add(2 << 32));
    let (_, mut shot) = random_shot(gpu, grid, seed)?;
    let (pattern, split) = match (6.0 * random.unit()) as u32 {
        0..3 => (InjectionPattern::Linear, 1),
        3 => (InjectionPattern::Linear, 2 + (3.0 * random.unit()) as u32),
        4 => (InjectionPattern::Block, 2 + (3.0 * random.unit()) as u32),
        _ => (InjectionPattern::Stippled, 2 + (3.0 * random.unit()) as u32),
    };
    let part = if random.unit() < 0.5 { 1.0 } else { 0.3 + 0.7 * random.unit() };
    let points = (part * shot.picture.size.as_vec2()).as_uvec2();
    let textures = shot.input.textures.clone();
    shot.input = ViewInput::new(gpu, "test view", textures, points).with_pattern(pattern, split);
    Ok((shot, pattern, split))
}

/// Six frames of one to three random views each in a random grid, by every rule.
fn equal_to_fixed(labs: &Labs, kind: Kind) -> Result<(), Failed> {
    let gpu = &labs.core.gpu;
    let mut runs = Vec::new();
    let seeds: Vec<u64> = RANDOM_SEEDS.chain(ODD_SEEDS).collect();
    for (number, seeds) in (0..).zip(seeds.chunks_exact(12)) {
        let grid = random_grid(number);
        let shots: Vec<_> =
            seeds.iter().map(|seed| patterned(gpu, &grid, *seed)).collect::<Result<_, _>>()?;
        runs.push((number, grid, shots));
    }
    for rule in [CleanupRule::Center, CleanupRule::Footprint, CleanupRule::Rays] {
        let (mut compared, mut cleaned, mut split_views) = (0, 0, 0);
        for (number, grid, run) in &runs {
            let mut fixed = World::new(&labs.core, *grid)?;
            let mut form = kind.make(gpu, *grid, &dense_channels(), rule)?;
            let groups: [&[usize]; 6] = [&[0], &[1, 2], &[3, 4, 5], &[6], &[7, 8, 9], &[10, 11]];
            for (step, group) in (1..).zip(groups) {
                let views: Vec<_> = group.iter().map(|n| &run[*n]).collect();
                let shots: Vec<&Shot> = views.iter().map(|(shot, ..)| shot).collect();
                let before = count(&fixed.read(gpu)?, NORMAL);
                for shot in &shots {
                    shot.input.update_frame(gpu, &shot.view, SCALE, step);
                    fixed.clean_by(gpu, rule, shot)?;
                }
                cleaned += before - count(&fixed.read(gpu)?, NORMAL);
                fixed.inject(gpu, &shots, None)?;
                split_views += views.iter().filter(|(_, _, split)| *split > 1).count();
                let views = views.iter().map(|(shot, pattern, split)| {
                    let view = AttributeView::of(gpu, "test view", &shot.input);
                    (view.with_pattern(*pattern, *split), shot)
                });
                form.frame(gpu, &views.collect::<Vec<_>>(), step)?;
                let (ours, other) = (form.read(gpu)?, fixed.read(gpu)?);
                for name in CHANNELS {
                    let (ours, other) = (channel(&ours, name), channel(&other, name));
                    for (index, (one, other)) in ours.iter().zip(other).enumerate() {
                        let cell = grid.cell(index);
                        let same = one.truncate() == other.truncate();
                        let occupied = name != CHANNELS[0] || one.w == other.w;
                        assert!(
                            same && occupied,
                            "{kind:?}, {rule:?}, run {number}, frame {step}, {cell}: {name} is {one}, not {other}"
                        );
                    }
                }
                compared += count(&other, NORMAL);
                if let Form::Bricks(bricks) = &form {
                    let happened = bricks.diagnostics(gpu, None)?;
                    assert_eq!((happened.occupied as usize, happened.refused), (count(&other, NORMAL), 0));
                }
            }
        }
        eprintln!("{kind:?}, {rule:?}: {compared} occupied cells are the same, {cleaned} were cleaned");
        assert!(compared > 10_000 && cleaned > 500, "the views show too little");
        assert!(split_views > 10, "{split_views} views with split points");
    }
    Ok(())
}

/// Two frames, of which the second clears what has been taken away.
fn any_channels(labs: &Labs) -> Result<(), Failed> {
    let gpu = &labs.core.gpu;
    let shots =
        [&[FLOOR, BALL, CHEST][..], &[FLOOR]].map(|things| Shot::take(gpu, views()[0].1, SIZE, things));
    let [with, without] = shots;
    let (with, without) = (with?, without?);
    for channel_count in [1, 4, 5, 8] {
        let kinds = (0..channel_count).map(|n| match n {
            0 => AttributeKind::Normal,
            1 => AttributeKind::Signed(2.0),
            _ => AttributeKind::Color(n as f32),
        });
        let channels: Vec<_> =
            kinds.enumerate().map(|(n, kind)| AttributeChannel::new(&format!("c{n}"), kind)).collect();
        let view_of = |shot: &Shot| {
            let textures = &shot.input.textures;
            let pictures = (1..channel_count).map(|n| match n {
                1 => textures.normal.clone(),
                2 => textures.emission.clone(),
                _ => textures.albedo.clone(),
            });
            let (depth, normal) = (textures.depth.clone(), textures.normal.clone());
            AttributeView::new(gpu, "test view", depth, normal, pictures.collect(), SIZE)
        };
        let mut found: Vec<Vec<HostVolume>> = Vec::new();
        for kind in [Kind::Dense(Storage::Buffers), Kind::Dense(Storage::Textures), Kind::Bricks] {
            let mut form = kind.make(gpu, grid(), &channels, CleanupRule::Footprint)?;
            let mut states = Vec::new();
            for (number, shot) in (1..).zip([&with, &without]) {
                form.frame(gpu, &[(view_of(shot), shot)], number)?;
                states.push(form.read(gpu)?);
            }
            found.push(states);
        }
        let [before, after] = [0, 1].map(|n| channel(&found[0][n], "c0"));
        let gone = before.iter().zip(after).filter(|(b, a)| b.w > 0.0 && a.w == 0.0).count();
        assert!(count(&found[0][0], "c0") > 400 && gone > 50, "{gone} cells are cleared");
        for (n, name) in channels.iter().map(|c| c.name.as_str()).enumerate() {
            let shows = channel(&found[0][0], name).iter().filter(|v| v.length() > 0.0).count();
            assert!(shows > 20, "channel {n} of {channel_count} holds {shows} values");
            for step in [0, 1] {
                let of = |form: usize| channel(&found[form][step], name);
                assert!(of(0) == of(1), "{name} of {channel_count} differs in 3D textures");
                assert!(of(0) == of(2), "{name} of {channel_count} differs in bricks");
            }
        }
    }
    Ok(())
}

fn refused(labs: &Labs) -> Result<(), Failed> {
    let gpu = &labs.core.gpu;
    let normal = AttributeChannel::new("normal", AttributeKind::Normal);
    let make = |grid, channels: &[AttributeChannel], storage| {
        DenseVoxelizer::new(gpu, grid, channels, storage, CleanupRule::Footprint)
    };
    for storage in [Storage::Buffers, Storage::Textures] {
        assert!(make(grid(), &[], storage).is_err());
        assert!(make(grid(), &vec![normal.clone(); 9], storage).is_err());
        assert!(
            make(grid(), &[AttributeChannel::new("albedo", AttributeKind::Color(1.0))], storage).is_err()
        );
        let long = lumivox::core::Grid { dims: lumivox::glam::UVec3::new(4000, 3, 3), ..grid() };
        assert_eq!(make(long, std::slice::from_ref(&normal), storage).is_err(), storage == Storage::Textures);
        let large = lumivox::core::Grid { dims: lumivox::glam::UVec3::splat(400), ..grid() };
        let error = make(large, std::slice::from_ref(&normal), storage).map(|_| ()).expect_err("too large");
        assert!(error.to_string().contains("would fit"), "{error}");
    }
    Ok(())
}
