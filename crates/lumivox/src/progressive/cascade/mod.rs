//! Nested windows that follow the viewer: a fine one near by, and coarser ones around it.
//!
//! Each level is a volume of bricks ([`ProgressiveVoxelizer`]) with as many cells as the one before it, which are twice as large. All move
//! with one call a frame, in whole bricks of their own; what stays in a window stays in place, and only the slabs that enter begin
//! empty. The papers call fixed extents their limitation (*Progressive Screen-Space Multichannel Surface Voxelization*, 6.6;
//! dissertation 7.9).
//!
//! Whoever asks for a point gets the finest level whose window contains it, or a blend that has no seam where levels meet:
//! shaders by [`cascade_wgsl`], memory by [`CascadeCells`].
//!
//! ```wgsl
//! let cell = lumivox_cascade_find(position);
//! let around = lumivox_cascade_smooth(position, 1u);
//! let albedo = around.value.rgb / max(around.coverage, 1e-3);
//! ```

mod cells;

use glam::{IVec4, UVec3, Vec3, Vec4};
use lumivox_core::{Bounds, Grid, View};

use crate::gpu::{Buffer, Gpu, GpuError, Shader, Uniform, renumbered};

use super::bricks::{BRICK_SIDE, FrameClock, FrameDiagnostics, SharedBuffers};
use super::{AttributeChannel, AttributeView, ProgressiveVoxelizer, VoxelizerSettings};

pub use cells::{CascadeCells, CascadeSample};

/// The most levels of a cascade.
pub const MAX_LEVELS: usize = 8;
/// Cells before a window's border over which its level fades into the next.
pub const BLEND_CELLS: f32 = 4.0;

/// What a host's shader calls, with its bindings in group 0 from 0 on.
pub const CASCADE_QUERIES: &str = include_str!("cascade.wgsl");
/// For validation.
pub(super) const SHADER: Shader = Shader { name: "progressive/cascade", parts: &[CASCADE_QUERIES] };

crate::gpu_struct! {
    /// Where the windows of a cascade stand.
    pub struct LumivoxCascade {
        /// The lowest corner of each level's window in metres, and the side of its cells.
        pub corners: [Vec4; 8],
        /// The number of its first brick along each axis.
        pub firsts: [IVec4; 8],
        /// Cells of every window along each axis.
        pub dims: UVec3,
        /// How many levels there are.
        pub levels: u32,
        /// Words of a level's table.
        pub table_words: u32,
        /// Words of a level's headers.
        pub header_words: u32,
        /// Values of a level.
        pub value_count: u32,
        /// Channels of a cell.
        pub channels: u32,
    }
}

/// The functions `lumivox_cascade_find`, `lumivox_cascade_value` and `lumivox_cascade_smooth` with their bindings, in `group` from binding
/// `first` on: one uniform and three read-only storage buffers, which are [`Cascade::uniform`] and [`Cascade::buffers`]. All names begin
/// with `lumivox_` or `Lumivox`.
pub fn cascade_wgsl(group: u32, first: u32) -> String {
    renumbered(CASCADE_QUERIES, group, first)
}

/// Nested windows, kept up from views as one object.
#[derive(Debug)]
pub struct Cascade {
    levels: Vec<ProgressiveVoxelizer>,
    shared: SharedBuffers,
    uniform: Uniform<LumivoxCascade>,
    dims: UVec3,
    channels: u32,
}

impl Cascade {
    /// Empty windows: `count` levels, the finest with the cells of `finest`, whose sides are rounded up to multiples of 4. Settings are those
    /// of each level.
    ///
    /// # Errors
    /// No level or more than [`MAX_LEVELS`], the errors of [`ProgressiveVoxelizer::new`], or values of all levels together that exceed what
    /// the device binds: 128 MiB on the core tier are 262,144 bricks of one channel.
    pub fn new(
        gpu: &Gpu,
        finest: Grid,
        count: usize,
        channels: &[AttributeChannel],
        settings: VoxelizerSettings,
    ) -> Result<Self, GpuError> {
        if count == 0 || count > MAX_LEVELS {
            return Err(GpuError::Validation(format!("a cascade has 1 to {MAX_LEVELS} levels, not {count}")));
        }
        super::channel::check(channels)?;
        let dims = finest.dims.max(UVec3::ONE).map(|side| side.next_multiple_of(BRICK_SIDE));
        let shared = SharedBuffers::new(gpu, dims / BRICK_SIDE, channels, &settings, count)?;
        let level = |n: usize| {
            // All lattices have one corner in common, so that cells nest.
            let grid = Grid { cell_size: finest.cell_size * (1u32 << n) as f32, dims, ..finest };
            ProgressiveVoxelizer::within(gpu, grid, channels, settings, Some(shared.windows(gpu, n)))
        };
        Ok(Self {
            levels: (0..count).map(level).collect::<Result<_, _>>()?,
            uniform: Uniform::new(gpu, "cascade/levels", &bytemuck::Zeroable::zeroed()),
            shared,
            dims,
            channels: channels.len() as u32,
        })
    }

    /// The levels, finest first.
    pub fn levels(&self) -> &[ProgressiveVoxelizer] {
        &self.levels
    }

    /// Records a frame: all windows move so that `center` is within half a brick of their middles, every view cleans, and those that have
    /// surfaces inject them. `changed` as in [`ProgressiveVoxelizer::update`]. The views need no update of their own.
    ///
    /// # Errors
    /// As [`ProgressiveVoxelizer::record`].
    pub fn record_frame(
        &mut self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        center: Vec3,
        changed: &[Bounds],
        views: &[(&AttributeView, &View)],
    ) -> Result<(), GpuError> {
        let points = views.iter().map(|(view, _)| view.point_count()).sum();
        for level in &mut self.levels {
            level.follow(center);
            level.update(gpu, changed);
        }
        let frame = self.levels.first().map_or(0, ProgressiveVoxelizer::frame);
        for (view, stands) in views {
            view.update(gpu, stands, points, frame);
        }
        self.uniform.write(gpu, &self.places());
        let views: Vec<_> = views.iter().map(|(view, _)| *view).collect();
        self.levels.iter_mut().try_for_each(|level| level.record(gpu, encoder, &views))
    }

    fn places(&self) -> LumivoxCascade {
        let (mut corners, mut firsts) = ([Vec4::ZERO; MAX_LEVELS], [IVec4::ZERO; MAX_LEVELS]);
        for (n, level) in self.levels.iter().enumerate() {
            let grid = level.grid();
            corners[n] = grid.origin.extend(grid.cell_size);
            firsts[n] = level.first().extend(0);
        }
        let [table_words, header_words, value_count] = self.shared.strides();
        let (levels, channels) = (self.levels.len() as u32, self.channels);
        LumivoxCascade {
            corners,
            firsts,
            dims: self.dims,
            levels,
            table_words,
            header_words,
            value_count,
            channels,
        }
    }

    /// Where the windows stand, for [`cascade_wgsl`]; that of the last recorded frame.
    pub fn uniform(&self) -> &Uniform<LumivoxCascade> {
        &self.uniform
    }

    /// The tables, headers and values of all levels, for [`cascade_wgsl`], in the order of its bindings.
    pub fn buffers(&self) -> [&Buffer; 3] {
        self.shared.whole()
    }

    /// Bytes of the device's memory that it takes.
    pub fn bytes(&self) -> u64 {
        self.levels.iter().map(ProgressiveVoxelizer::bytes).sum()
    }

    /// What the last recorded frame did to each level. Waits.
    pub fn diagnostics(&self, gpu: &Gpu) -> Result<Vec<FrameDiagnostics>, GpuError> {
        self.levels.iter().map(|level| level.diagnostics(gpu, None)).collect()
    }

    /// From the next frame on, what frames did comes to memory by itself, as [`ProgressiveVoxelizer::keep_diagnostics`]; each level is timed
    /// by itself.
    pub fn keep_diagnostics(&mut self, gpu: &Gpu, clock: FrameClock) {
        self.levels.iter_mut().for_each(|level| level.keep_diagnostics(gpu, clock));
    }

    /// What the oldest frame did to each level, as [`ProgressiveVoxelizer::poll_diagnostics`]: all of the same frame. Never waits.
    ///
    /// # Errors
    /// A failure of the device.
    pub fn poll_diagnostics(&mut self, gpu: &Gpu) -> Result<Option<Vec<FrameDiagnostics>>, GpuError> {
        loop {
            let fronts = self.levels.iter_mut().map(|level| level.polled_frame(gpu));
            let fronts: Option<Vec<u32>> = fronts.collect::<Result<_, _>>()?;
            let Some(fronts) = fronts else { return Ok(None) };
            let newest = fronts.iter().copied().max().unwrap_or(0);
            if fronts.iter().all(|frame| *frame == newest) {
                let taken = self.levels.iter_mut().map(|level| level.poll_diagnostics(gpu));
                return taken.collect();
            }
            // A frame that a level has passed over, for another thread may free its room meanwhile: it is left out of all.
            for (level, frame) in self.levels.iter_mut().zip(fronts) {
                if frame < newest {
                    level.poll_diagnostics(gpu)?;
                }
            }
        }
    }

    /// All levels in memory. Waits.
    pub fn read_back(&self, gpu: &Gpu) -> Result<CascadeCells, GpuError> {
        CascadeCells::read(gpu, &self.levels)
    }
}
