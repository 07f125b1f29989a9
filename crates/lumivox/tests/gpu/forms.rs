//! The forms of progressive voxelization: whatever cells lie in, they are the same.

use libtest_mimic::Failed;
use lumivox::core::HostVolume;
use lumivox::gpu::{Gpu, GpuError};
use lumivox::progressive::{
    AttributeChannel, AttributeKind, AttributeView, CHANNELS, CleanupRule, DenseVoxelizer,
    ProgressiveVoxelizer, Storage, VoxelizerSettings,
};
use lumivox::volume::NORMAL;

use crate::bricks::{dense_channels, settings};
use crate::progressive::{BALL, CHEST, FLOOR, SIZE, grid, views};
use crate::random_views::{ODD_SEEDS, RANDOM_SEEDS, random_shot};
use crate::support::{SCALE, Shot, World, channel, run};
use crate::{Labs, Test};

pub(crate) const TESTS: &[Test] = &[
    ("forms: bricks, of random views, are the fixed channels over all cells", bricks),
    ("forms: buffers, of random views, are the fixed channels over all cells", buffers),
    ("forms: 3D textures, of random views, are the fixed channels over all cells", textures),
    ("forms: one to eight channels are the same in buffers, 3D textures and bricks", any_channels),
    ("forms: a volume that cannot be is refused", refused),
];

/// A volume in one of the forms.
enum Form {
    Bricks(Box<ProgressiveVoxelizer>),
    Dense(Box<DenseVoxelizer>),
}

/// How one is made.
#[derive(Clone, Copy, Debug)]
enum Kind {
    Bricks,
    Dense(Storage),
}

impl Kind {
    fn make(self, gpu: &Gpu, channels: &[AttributeChannel], rule: CleanupRule) -> Result<Form, GpuError> {
        Ok(match self {
            Self::Bricks => {
                let settings = VoxelizerSettings { cleanup: rule, ..settings() };
                Form::Bricks(Box::new(ProgressiveVoxelizer::new(gpu, grid(), channels, settings)?))
            }
            Self::Dense(storage) => {
                Form::Dense(Box::new(DenseVoxelizer::new(gpu, grid(), channels, storage, rule)?))
            }
        })
    }
}

impl Form {
    /// A frame of these views.
    fn frame(&mut self, gpu: &Gpu, views: &[(AttributeView, &Shot)]) -> Result<(), GpuError> {
        let frame = match self {
            Self::Bricks(bricks) => {
                bricks.update(gpu, &[]);
                bricks.frame()
            }
            Self::Dense(_) => 0,
        };
        for (view, shot) in views {
            view.update(gpu, &shot.view, SCALE.attribute_points, frame);
        }
        let views: Vec<_> = views.iter().map(|(view, _)| view).collect();
        run(gpu, |e| match self {
            Self::Bricks(bricks) => bricks.record(gpu, e, &views),
            Self::Dense(dense) => dense.record(gpu, e, &views),
        })
    }

    fn read(&self, gpu: &Gpu) -> Result<HostVolume, GpuError> {
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

/// Six frames of one to three random views each, by every rule.
fn equal_to_fixed(labs: &Labs, kind: Kind) -> Result<(), Failed> {
    let gpu = &labs.core.gpu;
    let shots: Vec<_> = RANDOM_SEEDS
        .chain(ODD_SEEDS)
        .map(|seed| random_shot(gpu, &grid(), seed))
        .collect::<Result<_, _>>()?;
    for rule in [CleanupRule::Center, CleanupRule::Footprint, CleanupRule::Rays] {
        let (mut compared, mut cleaned) = (0, 0);
        for (number, run) in shots.chunks_exact(12).step_by(2).enumerate() {
            let mut fixed = World::new(&labs.core, grid())?;
            let mut form = kind.make(gpu, &dense_channels(), rule)?;
            let groups: [&[usize]; 6] = [&[0], &[1, 2], &[3, 4, 5], &[6], &[7, 8, 9], &[10, 11]];
            for (step, group) in groups.iter().enumerate() {
                let shots: Vec<&Shot> = group.iter().map(|n| &run[*n].1).collect();
                let before = count(&fixed.read(gpu)?, NORMAL);
                for shot in &shots {
                    fixed.clean_by(gpu, rule, shot)?;
                }
                cleaned += before - count(&fixed.read(gpu)?, NORMAL);
                fixed.inject(gpu, &shots, None)?;
                let views: Vec<_> =
                    shots.iter().map(|s| (AttributeView::of(gpu, "test view", &s.input), *s)).collect();
                form.frame(gpu, &views)?;
                let (ours, other) = (form.read(gpu)?, fixed.read(gpu)?);
                for name in CHANNELS {
                    let (ours, other) = (channel(&ours, name), channel(&other, name));
                    for (index, (one, other)) in ours.iter().zip(other).enumerate() {
                        let cell = grid().cell(index);
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
            let mut form = kind.make(gpu, &channels, CleanupRule::Footprint)?;
            let mut states = Vec::new();
            for shot in [&with, &without] {
                form.frame(gpu, &[(view_of(shot), shot)])?;
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
