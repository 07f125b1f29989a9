//! Cells of what stands still, from triangles (dissertation 7.8 and 7.10): made once, and no view's cleanup, no age and no point
//! changes them.

use crate::VolumeBuffer;
use crate::gpu::{Bindings, Buffer, ComputePass, Gpu, GpuError, Shader, Uniform};
use crate::volume::Format;
use crate::voxelize::Voxelizer;
use crate::wgsl::{GRID, linear_groups};

use super::passes::BRICK;
use super::store::Store;
use super::{ProgressiveVoxelizer, brick_dims};

crate::gpu_struct! {
    /// Which layers and which channel are taken.
    pub struct StaticUniform {
        /// The first layer along z.
        pub first_layer: u32,
        /// How many.
        pub layers: u32,
        /// The number of the channel.
        pub channel: u32,
        /// How many channels the volume has.
        pub channels: u32,
    }
}

const STATICS: &str = include_str!("statics.wgsl");
pub(super) const SLOTS: &str = include_str!("slots.wgsl");
pub(super) const PIN: Shader =
    Shader { name: "bricks/pin", parts: &[GRID, BRICK, STATICS, SLOTS, include_str!("pin.wgsl")] };
pub(super) const PIN_VALUES: Shader =
    Shader { name: "bricks/pin values", parts: &[GRID, BRICK, STATICS, include_str!("pin_values.wgsl")] };

#[derive(Debug)]
pub(super) struct Statics {
    pin: ComputePass,
    values: ComputePass,
    /// One for each channel.
    parts: Vec<Uniform<StaticUniform>>,
}

impl Statics {
    fn new(gpu: &Gpu, channels: usize) -> Self {
        let part = |_| Uniform::new(gpu, "bricks/static part", &bytemuck::Zeroable::zeroed());
        Self {
            pin: ComputePass::new(gpu, &PIN, &[]),
            values: ComputePass::new(gpu, &PIN_VALUES, &[]),
            parts: (0..channels).map(part).collect(),
        }
    }

    fn record(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        store: &mut Store,
        (occupancy, sources): (&Buffer, &[&Buffer]),
        (bricks, cells): (u32, u32),
    ) -> Result<(), GpuError> {
        let Some(first) = self.parts.first() else { return Ok(()) };
        let bindings = Bindings::new()
            .read("grid", &store.grid)
            .read("bricks", &store.bricks)
            .read("part", first)
            .read("occupancy", occupancy)
            .write("table", &mut store.table)
            .write("headers", &mut store.headers)
            .write("lists", &mut store.lists)
            .write("counters", &mut store.counters);
        // A workgroup a brick.
        self.pin.record(gpu, encoder, &bindings, linear_groups(64 * bricks))?;
        for (part, source) in self.parts.iter().zip(sources) {
            let bindings = Bindings::new()
                .read("grid", &store.grid)
                .read("bricks", &store.bricks)
                .read("part", part)
                .read("occupancy", occupancy)
                .read("source", *source)
                .read("table", &store.table)
                .write("values", &mut store.values)
                .write("shown", &mut store.shown);
            self.values.record(gpu, encoder, &bindings, linear_groups(cells))?;
        }
        Ok(())
    }
}

impl ProgressiveVoxelizer {
    /// Takes the cells that `voxelizer` marked in its last recording as those of what stands still, with their values in `volume`, which
    /// it filled: they stay as they are, whatever views show, until this is called again without them, or the window leaves
    /// them. Then they are cells like others, which a view may clear. Points that fall into them are left out and cost little.
    ///
    /// Between [`Self::update`] and [`Self::record`]. A voxelizer of slabs is taken slab by slab, each in a submission and a frame of
    /// its own; slabs of other layers stay. Its surfaces should be moved by [`SURFACE_SHIFT`](crate::progressive::SURFACE_SHIFT), as
    /// views' are.
    ///
    /// # Errors
    /// A voxelizer over another grid than [`Self::grid`], a volume without a channel of this one's names in four half floats, or no
    /// [`Self::update`] since the last frame.
    pub fn record_static(
        &mut self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        voxelizer: &Voxelizer,
        volume: &VolumeBuffer,
    ) -> Result<(), GpuError> {
        let wrong = |reason: &str| GpuError::Binding { pass: PIN.name, reason: reason.to_owned() };
        if voxelizer.grid() != &self.grid() {
            return Err(wrong("the voxelizer is over another grid than the window"));
        }
        if self.recorded {
            return Err(wrong("comes after the update of a frame and before its recording"));
        }
        let source = |name: &String| {
            let is_half4 = volume.format(name).is_some_and(|f| f.format == Format::F16 && f.words() == 2);
            let missing = || wrong(&format!("needs a volume with the channel {name} in four half floats"));
            volume.channel(name).filter(|_| is_half4).ok_or_else(missing)
        };
        let sources = self.channels.iter().map(|c| source(&c.name)).collect::<Result<Vec<_>, _>>()?;
        let layers = voxelizer.layers();
        let count = layers.end - layers.start;
        let cells = u64::from(self.grid.dims.x) * u64::from(self.grid.dims.y) * u64::from(count);
        if 8 * voxelizer.occupancy().size() < cells || sources.iter().any(|s| s.size() < 8 * cells) {
            return Err(wrong("the volume has too few layers"));
        }
        let channels = self.channels.len();
        let statics = self.statics.get_or_insert_with(|| Statics::new(gpu, channels));
        for (channel, part) in statics.parts.iter().enumerate() {
            let (channel, channels) = (channel as u32, channels as u32);
            part.write(gpu, &StaticUniform { first_layer: layers.start, layers: count, channel, channels });
        }
        let bricks = brick_dims(&self.grid).element_product();
        let from = (voxelizer.occupancy(), sources.as_slice());
        statics.record(gpu, encoder, &mut self.store, from, (bricks, cells as u32))
    }
}
