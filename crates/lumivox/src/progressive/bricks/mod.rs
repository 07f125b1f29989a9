//! Progressive voxelization whose cost follows the surface: a volume of bricks that exist where something is.
//!
//! The same cleanup and injection as [`Progressive`](super::Progressive), cell by cell, on another storage. Cells lie in bricks
//! of 4 x 4 x 4; a brick has a slot while any of its cells is occupied, and lists of slots say what each pass goes over.
//! An empty cell costs no time, no memory traffic and, beyond its brick's 4 bytes in a table, no memory.
//!
//! Beyond the papers (*Progressive Screen-Space Multichannel Surface Voxelization*, 2013, 6.6; dissertation 7.8 to 7.10, 8.2):
//!
//! - any channels, up to eight of four numbers ([`AttributeChannel`]);
//! - views that only clean ([`AttributeView::cleaning`]);
//! - cleanup within boxes that something moved in, and of a share of all bricks in each frame;
//! - cells of what stands still, made once of triangles, which no view clears ([`ProgressiveVoxelizer::record_static`]);
//! - cells that views have shown in few frames and not for long die ([`VoxelizerSettings::max_age`]);
//! - a window that follows the viewer in whole bricks: the table is addressed modulo the window's size, so what stays in the
//!   window stays in place and only what enters begins empty ([`ProgressiveVoxelizer::follow`]);
//! - what each frame did, counted, without waiting for it if asked so ([`FrameDiagnostics`]).
//!
//! A frame is [`ProgressiveVoxelizer::update`], [`AttributeView::update`] of each view, and [`ProgressiveVoxelizer::record`].

mod diagnostics;
mod passes;
mod readback;
mod shared;
mod statics;
mod store;

use glam::{IVec3, UVec3, Vec3};
use lumivox_core::{Bounds, Grid};

use crate::gpu::{Buffer, GeneratedText, Gpu, GpuError, Shader};
use crate::wgsl::GridUniform;

use super::channel::{self, AttributeChannel};
use super::{AttributeView, CleanupRule};
use diagnostics::{Recorded, Watch};
use passes::Passes;
pub(super) use shared::SharedBuffers;
use shared::Windows;
use statics::Statics;
use store::Store;

pub use diagnostics::{FrameClock, FrameDiagnostics};
pub use readback::BrickCell;
pub use statics::StaticUniform;
pub use store::BRICK_SIDE;
pub(super) use store::HEADER;

crate::gpu_struct! {
    /// The window and the settings of a frame as shaders see them.
    pub struct BrickUniform {
        /// Number of the window's first brick along each axis.
        pub first: IVec3,
        /// Number of the frame, from 1.
        pub frame: u32,
        /// Bricks of the window along each axis.
        pub dims: UVec3,
        /// Bricks that there is room for.
        pub capacity: u32,
        /// Bricks whose sums there is room for in a frame.
        pub seen_capacity: u32,
        /// Which of the two lists is this frame's.
        pub side: u32,
        /// Boxes that cleanup is restricted to.
        pub box_count: u32,
        /// Age at which cells die, in frames.
        pub max_age: u32,
        /// Frames that keep a cell from that.
        pub confident: u32,
        /// Where this frame's turn of cleanup begins, on a circle of length 1 that bricks lie on.
        pub turn_from: f32,
        /// How much of the circle it takes.
        pub turn_share: f32,
        /// Nothing.
        pub spare: u32,
    }
}

/// How a volume of bricks is kept.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VoxelizerSettings {
    /// Bricks that there is room for: 304 bytes each, and 512 more for each channel. A surface across a grid of `n` cells a side takes
    /// some `n^2 / 10` of them for each of its sides that faces an axis.
    pub bricks: u32,
    /// Bricks that all views of a frame together may show: 256 bytes each, and 1024 more for each channel.
    pub bricks_in_view: u32,
    /// When a view proves a cell empty.
    pub cleanup: CleanupRule,
    /// Cells that no view has shown for more than this many frames die; 0 keeps them forever. With boxes, only where these are.
    pub max_age: u32,
    /// Cells that views have shown in so many frames, at most 255, do not die of age.
    pub confident: u32,
    /// Cleanup takes every brick once in so many frames, at least 1, and no whole number: what a view proves empty is gone as many
    /// frames later. [`Self::set_turns`](ProgressiveVoxelizer::set_turns) changes it.
    pub turns: f32,
}

impl Default for VoxelizerSettings {
    fn default() -> Self {
        Self {
            bricks: 1 << 15,
            bricks_in_view: 1 << 14,
            cleanup: CleanupRule::default(),
            max_age: 0,
            confident: 255,
            turns: 1.0,
        }
    }
}

impl VoxelizerSettings {
    /// The same with room and turns as they can be.
    fn clean(self) -> Self {
        Self {
            bricks: self.bricks.max(1),
            bricks_in_view: self.bricks_in_view.max(1),
            turns: clean_turns(self.turns),
            ..self
        }
    }
}

/// A volume of bricks, kept up from views: progressive voxelization as one object of a host.
#[derive(Debug)]
pub struct ProgressiveVoxelizer {
    grid: Grid,
    /// Number of the window's first brick.
    first: IVec3,
    channels: Vec<AttributeChannel>,
    settings: VoxelizerSettings,
    frame: u32,
    /// Where its turn of cleanup begins, and how much that takes.
    turn: f64,
    last_share: f32,
    /// Whether that frame has been recorded.
    recorded: bool,
    /// What the last frame was recorded with.
    last: Recorded,
    /// Made when a host asks for it.
    watch: Option<Watch>,
    passes: Passes,
    /// Made when something stands still.
    statics: Option<Statics>,
    store: Store,
}

impl ProgressiveVoxelizer {
    /// An empty volume over the cells of `grid`.
    ///
    /// # Errors
    /// No channel or more than eight, or buffers that exceed what the device binds.
    pub fn new(
        gpu: &Gpu,
        grid: Grid,
        channels: &[AttributeChannel],
        settings: VoxelizerSettings,
    ) -> Result<Self, GpuError> {
        Self::within(gpu, grid, channels, settings, None)
    }

    /// As [`Self::new`], in buffers that it shares with others.
    pub(super) fn within(
        gpu: &Gpu,
        grid: Grid,
        channels: &[AttributeChannel],
        settings: VoxelizerSettings,
        windows: Option<Windows>,
    ) -> Result<Self, GpuError> {
        channel::check(channels)?;
        let settings = settings.clean();
        Ok(Self {
            grid,
            first: IVec3::ZERO,
            channels: channels.to_vec(),
            settings,
            frame: 0,
            turn: 0.0,
            last_share: 0.0,
            recorded: true,
            last: Recorded::default(),
            watch: None,
            passes: Passes::new(gpu, channels, settings.cleanup)?,
            statics: None,
            store: Store::new(gpu, brick_dims(&grid), channels, &settings, windows)?,
        })
    }

    /// The cells of the window as it stands.
    pub fn grid(&self) -> Grid {
        let moved = (self.first * BRICK_SIDE as i32).as_dvec3() * f64::from(self.grid.cell_size);
        Grid { origin: (self.grid.origin.as_dvec3() + moved).as_vec3(), ..self.grid }
    }

    /// Number of the window's first brick along each axis.
    pub(super) fn first(&self) -> IVec3 {
        self.first
    }

    /// Number of its first cell, as of [`BrickCell::cell`].
    pub(super) fn first_cell(&self) -> IVec3 {
        self.first * BRICK_SIDE as i32
    }

    /// The channels.
    pub fn channels(&self) -> &[AttributeChannel] {
        &self.channels
    }

    /// Bytes of the device's memory that it takes.
    pub fn bytes(&self) -> u64 {
        self.store.bytes()
    }

    /// Moves the window so that `center` lies within half a brick of its middle, from the next [`Self::update`] on. What stays in the window
    /// is kept, what leaves it is lost, and what enters is empty. The sides of such a window should be multiples of 4 cells: the
    /// last cells of others are empty in some of its places.
    pub fn follow(&mut self, center: Vec3) {
        let brick = f64::from(self.grid.cell_size) * f64::from(BRICK_SIDE);
        let sides = 0.5 * self.grid.dims.as_dvec3() * f64::from(self.grid.cell_size);
        let corner = (center.as_dvec3() - sides - self.grid.origin.as_dvec3()) / brick;
        // Far from integers that overflow.
        let limit = glam::DVec3::splat(f64::from(1 << 24));
        self.first = corner.round().clamp(-limit, limit).as_ivec3();
    }

    /// Begins the next frame. `changed` are the boxes that something moved in: cleanup and age look at these alone; with none they look
    /// everywhere. Once per frame, before it is recorded.
    pub fn update(&mut self, gpu: &Gpu, changed: &[Bounds]) {
        if std::mem::take(&mut self.recorded) {
            self.frame = self.frame.wrapping_add(1);
            self.turn = (self.turn + f64::from(self.last_share)).fract();
        }
        self.last_share = self.turn_share();
        let settings = self.settings;
        let box_count = self.store.set_boxes(gpu, changed);
        self.store.grid.write(gpu, &GridUniform::from(&self.grid()));
        self.store.bricks.write(
            gpu,
            &BrickUniform {
                first: self.first,
                frame: self.frame,
                dims: brick_dims(&self.grid),
                capacity: settings.bricks,
                seen_capacity: settings.bricks_in_view,
                side: self.side(),
                box_count,
                max_age: settings.max_age,
                confident: settings.confident,
                turn_from: self.turn as f32,
                turn_share: self.turn_share(),
                spare: 0,
            },
        );
    }

    /// Records a frame: every view cleans, then those that have surfaces inject them.
    ///
    /// # Errors
    /// A view whose pictures are not those of the channels, or a failure of the device.
    pub fn record(
        &mut self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        views: &[&AttributeView],
    ) -> Result<(), GpuError> {
        self.recorded = true;
        self.last = Recorded::new(self, views.len());
        if let Some(watch) = &self.watch {
            watch.begin(encoder);
        }
        self.record_views(gpu, encoder, views)?;
        if let Some(watch) = &mut self.watch {
            watch.end(encoder, &self.store, self.last);
        }
        Ok(())
    }

    fn record_views(
        &mut self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        views: &[&AttributeView],
    ) -> Result<(), GpuError> {
        let Self { passes, store, .. } = self;
        passes.record_keep(gpu, encoder, store)?;
        for view in views {
            passes.record_clean(gpu, encoder, view, store)?;
        }
        for view in views {
            passes.record_mark(gpu, encoder, view, store)?;
        }
        let Some(any) = views.iter().find(|v| v.surfaces.is_some()) else { return Ok(()) };
        for view in views {
            passes.record_add(gpu, encoder, view, store)?;
        }
        passes.record_resolve(gpu, encoder, any, store)
    }

    /// Changes [`VoxelizerSettings::turns`], from the next [`Self::update`] on, such as to what a
    /// [`LightBudget`](crate::gather::LightBudget) finds from what frames took: every brick still has its turn in each round.
    pub fn set_turns(&mut self, turns: f32) {
        self.settings.turns = clean_turns(turns);
    }

    /// The part of all bricks that has its turn; a little more than whole where all have.
    fn turn_share(&self) -> f32 {
        if self.settings.turns <= 1.0 { 2.0 } else { 1.0 / self.settings.turns }
    }

    /// The number of the last frame that was begun, from 1.
    pub fn frame(&self) -> u32 {
        self.frame
    }

    /// Which list is this frame's.
    fn side(&self) -> u32 {
        self.frame % 2
    }

    /// Values of the cells, eight bytes for each channel, by slot and cell of a brick.
    pub fn values(&self) -> &Buffer {
        &self.store.values
    }
}

/// Turns as they can be: at least one, and none that never ends.
fn clean_turns(turns: f32) -> f32 {
    if turns.is_finite() { turns.clamp(1.0, 65_536.0) } else { 1.0 }
}

/// Bricks along each axis of a grid.
fn brick_dims(grid: &Grid) -> UVec3 {
    (grid.dims + BRICK_SIDE - 1) / BRICK_SIDE
}

pub(crate) fn shaders() -> Vec<Shader> {
    vec![
        statics::PIN,
        statics::PIN_VALUES,
        passes::PLAN,
        passes::KEEP,
        passes::CLEAN_BY_CENTER,
        passes::CLEAN_BY_FOOTPRINT,
        passes::MARK,
    ]
}

/// The texts of some sets of channels.
pub(crate) fn texts() -> Vec<GeneratedText> {
    channel::examples().iter().flat_map(|c| [passes::add_text(c), passes::resolve_text(c)]).collect()
}
