//! What stands still, made of triangles and kept: whatever views show, its cells stay.

use libtest_mimic::Failed;
use lumivox::VolumeBuffer;
use lumivox::core::{Grid, View};
use lumivox::glam::{UVec2, UVec3, Vec2, Vec3, Vec4};
use lumivox::gpu::{Gpu, GpuError};
use lumivox::progressive::{
    BrickCell, CHANNELS, CleanupRule, ProgressiveVoxelizer, SURFACE_SHIFT, VoxelizerSettings,
};
use lumivox::voxelize::{Channel, Mesh, Options, VoxelizeError, Voxelizer};

use crate::bricks::{frame, settings, voxelizer};
use crate::progressive::{BALL, CHEST, FLOOR, SIZE, grid, views};
use crate::support::{Shot, channel, run};
use crate::voxelize::soups::Soup;
use crate::{Labs, Test};

pub(crate) const TESTS: &[Test] = &[
    ("statics: no view, age or point changes what stands still, and the rest goes on", stays),
    ("statics: what stands still no more is a cell like others", set_again),
    ("statics: slabs are the whole, and a window that moves leaves them behind", slabs),
    ("statics: what does not fit is refused", refused),
];

/// A wall across the room, half way up, before what the first view sees.
fn wall(gpu: &Gpu, z: f32) -> Result<Mesh, VoxelizeError> {
    let corners = [[-2.4, -1.3, z], [1.9, -1.3, z], [1.9, 0.4, z], [-2.4, 0.4, z]];
    Soup { positions: corners.to_vec(), indices: vec![[0, 1, 2], [0, 2, 3]] }.mesh(gpu)
}

/// The wall as a volume of a grid, layer by layer.
struct Standing {
    voxelizer: Voxelizer,
    volume: VolumeBuffer,
}

impl Standing {
    fn new(gpu: &Gpu, grid: Grid, layers: u32, meshes: &[&Mesh]) -> Result<Self, Failed> {
        let channels = [Channel::normal(), Channel::albedo(), Channel::emission()];
        let options = Options { shift: SURFACE_SHIFT as f32, ..Options::default() };
        let mut voxelizer = Voxelizer::for_slabs(gpu, grid, layers, &channels, &options)?;
        let slab = Grid { dims: grid.dims.with_z(layers), ..grid };
        let mut volume = VolumeBuffer::new(gpu, slab, &CHANNELS)?;
        run(gpu, |e| voxelizer.record(gpu, e, meshes, &mut volume))?;
        Ok(Self { voxelizer, volume })
    }

    fn give(&self, gpu: &Gpu, bricks: &mut ProgressiveVoxelizer) -> Result<(), GpuError> {
        bricks.update(gpu, &[]);
        run(gpu, |e| bricks.record_static(gpu, e, &self.voxelizer, &self.volume))
    }
}

fn statics(gpu: &Gpu, bricks: &ProgressiveVoxelizer) -> Result<Vec<BrickCell>, GpuError> {
    let mut cells = bricks.read_cells(gpu)?;
    cells.retain(|c| c.is_static);
    cells.sort_by_key(|c| c.cell.to_array());
    Ok(cells)
}

fn stays(labs: &Labs) -> Result<(), Failed> {
    let gpu = &labs.core.gpu;
    let standing = Standing::new(gpu, grid(), grid().dims.z, &[&wall(gpu, 1.03)?])?;
    let triangles = standing.volume.read_back(gpu)?;
    let marked = standing.voxelizer.read_occupancy(gpu)?.iter().filter(|m| **m).count();
    // Views that show other things where the wall stands, and nothing but the far plane.
    let full = Shot::take(gpu, views()[0].1, SIZE, &[FLOOR, BALL, CHEST])?;
    let floor = Shot::take(gpu, views()[0].1, SIZE, &[FLOOR])?;
    let nothing = Shot::take(gpu, views()[2].1, SIZE, &[])?;
    for rule in [CleanupRule::Center, CleanupRule::Footprint, CleanupRule::Rays] {
        let settings = VoxelizerSettings { cleanup: rule, max_age: 2, confident: 200, ..settings() };
        let mut bricks = voxelizer(gpu, settings)?;
        standing.give(gpu, &mut bricks)?;
        let mut cleaned = 0;
        for (step, shot) in [&full, &floor, &nothing, &nothing, &nothing, &floor].into_iter().enumerate() {
            let happened = frame(gpu, &mut bricks, &[shot])?;
            cleaned += happened.cleaned + happened.died;
            assert_eq!(happened.pinned as usize, marked, "{rule:?}, frame {step}: {happened:?}");
            let cells = statics(gpu, &bricks)?;
            assert_eq!(cells.len(), marked);
            for BrickCell { cell, values, .. } in &cells {
                let index = grid().index(cell.as_uvec3());
                for (value, name) in values.iter().zip(CHANNELS) {
                    assert_eq!(*value, channel(&triangles, name)[index], "{rule:?}, frame {step}, {cell}");
                }
            }
            assert_eq!(happened.occupied as usize, bricks.read_cells(gpu)?.len());
        }
        let mut alone = voxelizer(gpu, settings)?;
        let mut without = 0;
        for shot in [&full, &floor, &nothing] {
            without += frame(gpu, &mut alone, &[shot])?.cleaned;
        }
        assert!(marked > 80 && cleaned > 100 && without > 50, "{marked} static, {cleaned} cleaned");
    }
    Ok(())
}

fn set_again(labs: &Labs) -> Result<(), Failed> {
    let gpu = &labs.core.gpu;
    let [near, far] = [1.03, 0.28].map(|z| wall(gpu, z));
    let (near, far) = (near?, far?);
    let [one, other] = [&near, &far].map(|m| Standing::new(gpu, grid(), grid().dims.z, &[m]));
    let (one, other) = (one?, other?);
    let nothing = Shot::take(gpu, views()[0].1, SIZE, &[])?;
    let mut bricks = voxelizer(gpu, settings())?;
    one.give(gpu, &mut bricks)?;
    frame(gpu, &mut bricks, &[&nothing])?;
    let first = statics(gpu, &bricks)?;
    other.give(gpu, &mut bricks)?;
    let happened = frame(gpu, &mut bricks, &[&nothing])?;
    let second = statics(gpu, &bricks)?;
    // The walls share no cell, and the view sees most of the first to be gone.
    assert!(first.len() > 80 && second.len() > 80 && second.iter().all(|c| !first.contains(c)));
    assert!(happened.cleaned as usize * 2 > first.len(), "{happened:?}");
    let none = Standing::new(gpu, grid(), grid().dims.z, &[])?;
    none.give(gpu, &mut bricks)?;
    assert_eq!(frame(gpu, &mut bricks, &[&nothing])?.pinned, 0);
    Ok(())
}

fn slabs(labs: &Labs) -> Result<(), Failed> {
    let gpu = &labs.core.gpu;
    let up =
        View::orthographic(Vec3::new(0.0, 30.0, 0.0), Vec3::new(0.0, 40.0, 0.1), Vec3::X, Vec2::ONE, 10.0);
    let away = Shot::take(gpu, up, UVec2::splat(16), &[])?;
    let [near, far] = [1.03, 0.28].map(|z| wall(gpu, z));
    let (near, far) = (near?, far?);
    let mut whole = voxelizer(gpu, settings())?;
    Standing::new(gpu, grid(), grid().dims.z, &[&near, &far])?.give(gpu, &mut whole)?;
    frame(gpu, &mut whole, &[&away])?;
    // Slabs that end within bricks.
    let mut cut = voxelizer(gpu, settings())?;
    let Standing { mut voxelizer, mut volume } = Standing::new(gpu, grid(), 6, &[&near, &far])?;
    for first in (0..grid().dims.z).step_by(6) {
        voxelizer.move_to_layer(gpu, first);
        run(gpu, |e| voxelizer.record(gpu, e, &[&near, &far], &mut volume))?;
        cut.update(gpu, &[]);
        run(gpu, |e| cut.record_static(gpu, e, &voxelizer, &volume))?;
        frame(gpu, &mut cut, &[&away])?;
    }
    let cells = |bricks: &ProgressiveVoxelizer| -> Result<Vec<_>, GpuError> {
        Ok(statics(gpu, bricks)?.into_iter().map(|c| (c.cell, c.values)).collect())
    };
    let expected = cells(&whole)?;
    assert!(expected.len() > 160);
    assert!(cells(&cut)? == expected, "slabs differ");
    let middle = grid().origin + 0.5 * grid().dims.as_vec3() * grid().cell_size;
    whole.follow(middle + Vec3::new(2.0, 0.0, 0.0));
    let happened = frame(gpu, &mut whole, &[&away])?;
    let stays: Vec<_> = expected.iter().filter(|(cell, _)| cell.x >= 8).cloned().collect();
    assert!(stays.len() > 40 && stays.len() < expected.len());
    assert!(cells(&whole)? == stays, "a window that moves keeps what stays in it");
    assert_eq!(happened.pinned as usize, stays.len());
    whole.follow(middle + Vec3::new(900.0, 0.0, 0.0));
    let gone = frame(gpu, &mut whole, &[&away])?;
    assert_eq!((gone.pinned, gone.bricks), (0, 0));
    Ok(())
}

fn refused(labs: &Labs) -> Result<(), Failed> {
    let gpu = &labs.core.gpu;
    let mesh = wall(gpu, 1.03)?;
    let fits = Standing::new(gpu, grid(), grid().dims.z, &[&mesh])?;
    let mut bricks = voxelizer(gpu, settings())?;
    let refusal = |result: Result<(), GpuError>| result.expect_err("refused").to_string();
    let early = run(gpu, |e| bricks.record_static(gpu, e, &fits.voxelizer, &fits.volume));
    assert!(refusal(early).contains("update"));
    let smaller = Grid { dims: UVec3::new(24, 17, 16), ..grid() };
    let other = Standing::new(gpu, smaller, 16, &[&mesh])?;
    assert!(refusal(other.give(gpu, &mut bricks)).contains("another grid"));
    let lacks = VolumeBuffer::new(gpu, grid(), &CHANNELS[..2])?;
    let lacks = Standing { volume: lacks, voxelizer: fits.voxelizer };
    assert!(refusal(lacks.give(gpu, &mut bricks)).contains(CHANNELS[2]));
    // Without room there is no static cell, and no crash.
    let fits = Standing::new(gpu, grid(), grid().dims.z, &[&mesh])?;
    let mut few = voxelizer(gpu, VoxelizerSettings { bricks: 3, ..settings() })?;
    fits.give(gpu, &mut few)?;
    let nothing = Shot::take(gpu, views()[0].1, SIZE, &[])?;
    let happened = frame(gpu, &mut few, &[&nothing])?;
    assert!(happened.bricks == 3 && happened.pinned > 0 && happened.pinned <= 3 * 64, "{happened:?}");
    assert!(few.read_cells(gpu)?.iter().all(|c| c.is_static && c.values[0] != Vec4::ZERO));
    Ok(())
}
