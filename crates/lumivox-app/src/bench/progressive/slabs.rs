//! The dense form over grids of any size: in slabs of layers where it does not fit the device, held against bricks cell by cell.

use std::collections::HashMap;

use anyhow::Result;
use glam::{UVec2, UVec3, Vec3, Vec4};
use lumivox::VolumeBuffer;
use lumivox::core::{Grid, HostVolume, View};
use lumivox::gpu::Gpu;
use lumivox::progressive::{
    AttributeChannel, AttributeView, BrickCell, CHANNELS, CleanupRule, DenseVoxelizer, Progressive, Storage,
    ViewInput,
};
use lumivox::wgpu::CommandEncoder;

use super::forms::input;
use super::rig::Rig;
use crate::bench::timing::Timer;

/// Bytes of a cell's sums in the dense form of three fixed channels, and of one.
const SUM_BYTES: [u64; 2] = [40, 20];

/// Milliseconds over a grid.
#[derive(Default)]
pub(super) struct Dense {
    pub(super) cleanup: f64,
    /// Clearing the sums, and sums to means.
    pub(super) rest: f64,
    pub(super) injection: f64,
    pub(super) slabs: usize,
    pub(super) compared: Compared,
}

/// Cells of the dense form held against those of bricks.
#[derive(Clone, Copy, Default)]
pub(super) struct Compared {
    /// All cells of the grid, and those that either holds.
    pub(super) cells: u64,
    pub(super) occupied: u64,
    /// Those that one of them does not hold, or holds with other values.
    pub(super) different: u64,
}

/// What bricks hold, by cell.
pub(super) struct Kept<'c> {
    cells: HashMap<UVec3, &'c BrickCell>,
}

impl<'c> Kept<'c> {
    pub(super) fn new(cells: &'c [BrickCell]) -> Self {
        Self { cells: cells.iter().map(|c| (c.cell.as_uvec3(), c)).collect() }
    }
}

impl Compared {
    /// Adds a slab that begins with this layer.
    fn add(&mut self, kept: &Kept<'_>, first: u32, volume: &HostVolume) {
        let channels: Vec<&[Vec4]> = volume.names().filter_map(|name| volume.channel(name)).collect();
        let Some(normals) = channels.first() else { return };
        let layers = first..first + volume.grid.dims.z;
        let mut left = kept.cells.keys().filter(|c| layers.contains(&c.z)).count() as u64;
        self.cells += volume.grid.cell_count();
        for (index, cell) in volume.grid.cells().enumerate().filter(|(n, _)| normals[*n].w > 0.0) {
            self.occupied += 1;
            let in_bricks = kept.cells.get(&(cell + first * UVec3::Z));
            left -= u64::from(in_bricks.is_some());
            let is_same = |of: &BrickCell| {
                let ours = channels.iter().map(|channel| channel[index]);
                // Of colours the fourth number is of no use.
                let as_used =
                    |(n, value): (usize, Vec4)| if n == 0 { value } else { value.truncate().extend(0.0) };
                of.values.iter().copied().enumerate().map(as_used).eq(ours.enumerate().map(as_used))
            };
            self.different += u64::from(!in_bricks.is_some_and(|cell| is_same(cell)));
        }
        self.occupied += left;
        self.different += left;
    }
}

/// The dense form with three channels, in the stages that are their own, or with one.
enum Form {
    Three(Box<(Progressive, VolumeBuffer)>),
    One(Box<DenseVoxelizer>),
}

/// What a form is fed with: all points, and for one channel a single one, which leaves the clearing of sums and the means.
struct Input {
    three: ViewInput,
    one: AttributeView,
    single: AttributeView,
}

impl Input {
    fn new(gpu: &Gpu, rig: &Rig, points: UVec2) -> Self {
        let [one, single] = [points, UVec2::ONE].map(|points| {
            let view = rig.attribute_view(gpu, &one_channel(), points);
            view.update(gpu, &rig.camera.view, rig.scale().attribute_points, 0);
            view
        });
        Self { three: input(gpu, rig, points), one, single }
    }
}

/// One target of four numbers.
pub(super) fn one_channel() -> [AttributeChannel; 1] {
    [AttributeChannel::new("normal", lumivox::progressive::AttributeKind::Normal)]
}

impl Form {
    fn new(gpu: &Gpu, slab: Grid, rule: CleanupRule, targets: Targets) -> Result<Self> {
        Ok(match targets {
            Targets::Three => {
                let volume = VolumeBuffer::new(gpu, slab, &CHANNELS)?;
                Self::Three(Box::new((Progressive::of_surfaces(gpu, &volume, rule)?, volume)))
            }
            Targets::One => {
                let dense = DenseVoxelizer::new(gpu, slab, &one_channel(), Storage::Buffers, rule)?;
                Self::One(Box::new(dense))
            }
        })
    }

    fn clean(
        &mut self,
        gpu: &Gpu,
        e: &mut CommandEncoder,
        input: &Input,
    ) -> Result<(), lumivox::gpu::GpuError> {
        match self {
            Self::Three(form) => form.0.record_cleanup(gpu, e, &input.three, &mut form.1),
            Self::One(dense) => dense.record_cleanup(gpu, e, &input.one),
        }
    }

    /// All of injection, or only what is done without points too.
    fn inject(
        &mut self,
        gpu: &Gpu,
        e: &mut CommandEncoder,
        input: &Input,
        all: bool,
    ) -> Result<(), lumivox::gpu::GpuError> {
        match self {
            Self::Three(form) => {
                let (progressive, volume) = &mut **form;
                progressive.record_begin_surfaces(e);
                if all {
                    progressive.record_surfaces(gpu, e, [&input.three], volume)?;
                }
                progressive.record_end_surfaces(gpu, e, &input.three, volume)
            }
            Self::One(dense) => {
                dense.record_injection(gpu, e, &[if all { &input.one } else { &input.single }])
            }
        }
    }

    fn read(&self, gpu: &Gpu) -> Result<HostVolume> {
        Ok(match self {
            Self::Three(form) => form.1.read_back(gpu)?,
            Self::One(dense) => dense.read_back(gpu)?,
        })
    }
}

/// How many targets of four numbers a volume has.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Targets {
    Three,
    One,
}

impl Dense {
    pub(super) fn total(&self) -> f64 {
        self.cleanup + self.rest + self.injection
    }

    /// Measures it slab by slab, after views that fill it, and holds it against what bricks hold after the same. The points are
    /// injected once for each slab; of that the longest time alone counts.
    pub(super) fn measure(
        timer: &Timer<'_>,
        rig: &mut Rig,
        grid: Grid,
        (points, rule, targets): (UVec2, CleanupRule, Targets),
        views: &[View],
        kept: Option<&Kept<'_>>,
    ) -> Result<Self> {
        let gpu = timer.gpu;
        let sum_bytes = SUM_BYTES[if targets == Targets::Three { 0 } else { 1 }];
        let room = gpu.device.limits().max_storage_buffer_binding_size / sum_bytes;
        let layer = u64::from(grid.dims.x) * u64::from(grid.dims.y);
        let layers = ((room / layer) as u32).clamp(1, grid.dims.z);
        let mut all = Self::default();
        for first in (0..grid.dims.z).step_by(layers as usize) {
            let slab = Grid {
                origin: grid.origin + Vec3::Z * (first as f32 * grid.cell_size),
                dims: UVec3::new(grid.dims.x, grid.dims.y, layers.min(grid.dims.z - first)),
                ..grid
            };
            let mut form = Form::new(gpu, slab, rule, targets)?;
            let last = rig.camera.view;
            for view in views.iter().chain([&last]) {
                rig.look(gpu, *view);
                rig.draw(timer)?;
                let input = Input::new(gpu, rig, points);
                timer.submit(|e| {
                    form.clean(gpu, e, &input)?;
                    form.inject(gpu, e, &input, true)
                })?;
            }
            if let Some(kept) = kept {
                all.compared.add(kept, first, &form.read(gpu)?);
            }
            let input = Input::new(gpu, rig, points);
            all.cleanup += timer.median(|| timer.submit(|e| form.clean(gpu, e, &input)))?.ms;
            let mut inject = |whole| timer.median(|| timer.submit(|e| form.inject(gpu, e, &input, whole)));
            let (whole, rest) = (inject(true)?.ms, inject(false)?.ms);
            all.injection = all.injection.max(whole - rest);
            all.rest += rest;
            all.slabs += 1;
        }
        Ok(all)
    }
}
