//! Draws the occupied cells of a volume as cubes, by walking each pixel's ray from cell to cell.
//!
//! A cell shows its albedo under a soft headlight and the light that leaves it, or one channel alone; of the volume all shows, or one
//! layer of cells.

use glam::Vec3;
use lumivox::core::Grid;
use lumivox::gpu::{Bindings, Buffer, FullscreenPass, Gpu, GpuError, Shader, Texture, Uniform};
use lumivox::progressive::DirectLight;
use lumivox::volume::{ALBEDO, EMISSION, NORMAL};
use lumivox::{VolumeBuffer, wgpu, wgsl};

use crate::surface::{HDR_FORMAT, SurfaceView};

/// The shader.
pub const SHADER: Shader = Shader {
    name: "render/voxel_view",
    parts: &[wgsl::GRID, wgsl::VIEW, wgsl::PACK, wgsl::SH, wgsl::FULLSCREEN, include_str!("voxel_view.wgsl")],
};

lumivox::gpu_struct! {
    /// How cells are shown.
    pub struct VoxelViewUniform {
        /// Brightness of the headlight on the albedo.
        pub headlight: f32,
        /// Share of the direct light that leaves a cell.
        pub light: f32,
        /// A [`VoxelChannel`] by number.
        pub channel: u32,
        /// Unused.
        pub reserved_0: u32,
        /// Cells whose middles lie below this in any coordinate are left out.
        pub low: Vec3,
        /// Unused.
        pub reserved_1: u32,
        /// Those that lie above this are, too.
        pub high: Vec3,
        /// Unused.
        pub reserved_2: u32,
    }
}

/// What of a cell is shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum VoxelChannel {
    /// Its albedo under a soft headlight, the light that leaves it, and its emission.
    #[default]
    Lit,
    /// Its albedo.
    Albedo,
    /// Its mean normal, -1..1 shown as 0..1.
    Normal,
    /// What it emits.
    Emission,
    /// The direct light that leaves its visible face.
    Light,
    /// In how many frames no view has shown it: red for none, then yellow to blue up to 64, and grey for more and for cells that no view
    /// has shown.
    Age,
    /// As [`Self::Lit`], and pink where the triangles have a surface that no view has brought into the volume yet.
    Unseen,
}

/// A layer of cells: across which axis, and where on it in metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Slice {
    /// 0 for x, 1 for y, 2 for z.
    pub axis: usize,
    /// A point of the layer on that axis, metres.
    pub at: f32,
}

/// The pass.
#[derive(Debug)]
pub struct VoxelView {
    pass: FullscreenPass,
    uniform: Uniform<VoxelViewUniform>,
}

impl VoxelView {
    /// Compiles it.
    pub fn new(gpu: &Gpu) -> Self {
        let uniform = Uniform::new(gpu, "render/voxel view", &shown(VoxelChannel::Lit, EVERYTHING));
        Self { pass: FullscreenPass::new(gpu, &SHADER, HDR_FORMAT, false), uniform }
    }

    /// Leaves out the cells above a height, from the next submission on.
    pub fn cut(&self, gpu: &Gpu, height: f32) {
        let high = EVERYTHING.1.with_y(height);
        self.uniform.write(gpu, &shown(VoxelChannel::Lit, (EVERYTHING.0, high)));
    }

    /// Shows a channel, of all cells or of a layer, from the next submission on. A layer outside of the grid is the nearest one
    /// in it.
    pub fn show(&self, gpu: &Gpu, grid: &Grid, channel: VoxelChannel, slice: Option<Slice>) {
        let (mut low, mut high) = EVERYTHING;
        if let Some(Slice { axis, at }) = slice {
            let place = ((at - grid.origin[axis]) / grid.cell_size).floor();
            let cell = place.clamp(0.0, grid.dims[axis] as f32 - 1.0);
            low[axis] = grid.origin[axis] + cell * grid.cell_size;
            high[axis] = low[axis] + grid.cell_size;
        }
        self.uniform.write(gpu, &shown(channel, (low, high)));
    }

    /// Draws the cells as the camera would see them; `expected` is what [`VoxelChannel::Unseen`] compares the volume with, and `ages` are
    /// those of [`CellAges`](lumivox::progressive::CellAges) that [`VoxelChannel::Age`] shows.
    pub fn record(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        camera: &SurfaceView,
        (volume, light): (&VolumeBuffer, &DirectLight),
        (expected, ages): (Option<&VolumeBuffer>, Option<&Buffer>),
        picture: &mut Texture,
    ) -> Result<(), GpuError> {
        let missing = || GpuError::Validation("the voxel view needs normal, albedo and emission".to_owned());
        let normal = volume.channel(NORMAL).ok_or_else(missing)?;
        let bindings = Bindings::new()
            .read("grid", volume.grid_uniform())
            .read("view", &camera.input.uniform)
            .read("voxel_view", &self.uniform)
            .read("normal", normal)
            .read("albedo", volume.channel(ALBEDO).ok_or_else(missing)?)
            .read("emission", volume.channel(EMISSION).ok_or_else(missing)?)
            .read("light", light.coefficients())
            .read("expected", expected.unwrap_or(volume).channel(NORMAL).ok_or_else(missing)?)
            // Not looked at without.
            .read("ages", ages.unwrap_or(normal));
        self.pass.record(gpu, encoder, &bindings, picture, false)
    }
}

/// Bounds that leave nothing out.
const EVERYTHING: (Vec3, Vec3) = (Vec3::MIN, Vec3::MAX);

fn shown(channel: VoxelChannel, (low, high): (Vec3, Vec3)) -> VoxelViewUniform {
    let channel = match channel {
        VoxelChannel::Lit => 0,
        VoxelChannel::Albedo => 1,
        VoxelChannel::Normal => 2,
        VoxelChannel::Emission => 3,
        VoxelChannel::Light => 4,
        VoxelChannel::Unseen => 5,
        VoxelChannel::Age => 6,
    };
    VoxelViewUniform {
        headlight: 0.6,
        light: 0.8,
        channel,
        reserved_0: 0,
        low,
        reserved_1: 0,
        high,
        reserved_2: 0,
    }
}
