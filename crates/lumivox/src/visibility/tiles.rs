//! Culling: which objects reach which tiles of a picture. Tiles with any are drawn as quads by one indirect draw, so that the
//! others cost no fragment at all.
//!
//! Sets of objects per tile, and not a proxy drawn per object, because the nearest hit of a ray is over all objects: a pass per
//! object would have to keep a distance for each ray of each pixel.

use glam::{UVec2, Vec3};

use super::{CULL, OBJECT, Objects, Receiver, TILE};
use crate::gpu::{Bindings, Buffer, ComputePass, Gpu, GpuError, Shader, Texture, Uniform, read_buffer};
use crate::wgsl::VIEW;

/// What occlusion and shadows cull by.
pub(super) const SHADER: Shader =
    Shader { name: "visibility/cull", parts: &[VIEW, OBJECT, TILE, CULL, include_str!("cull_round.wgsl")] };

/// Side of a tile in texels.
pub(super) const TILE_SIDE: u32 = 8;
/// Bytes of an indirect draw.
const DRAW_BYTES: u64 = 16;

crate::gpu_struct! {
    /// Tiles of a picture, and how far objects reach in it.
    pub struct TileUniform {
        /// Tiles along x and y.
        pub tiles: UVec2,
        /// Texels along x and y.
        pub size: UVec2,
        /// Objects in the frame.
        pub object_count: u32,
        /// Words of a tile's set of objects; one more for each 32 of them says which hold any.
        pub words: u32,
        /// How far occlusion reaches beyond an object's sphere, metres.
        pub reach: f32,
        /// And to how many radii at most.
        pub reach_in_radii: f32,
        /// Middle of the light, for shadows, or the way to a sun.
        pub light: Vec3,
        /// Radius of a sphere around it, or the tangent of a sun's angle.
        pub light_radius: f32,
        /// What objects are looked for round.
        pub kind: u32,
        /// Unused.
        pub reserved_0: u32,
        /// Unused.
        pub reserved_1: u32,
        /// Unused.
        pub reserved_2: u32,
    }
}

/// Where objects count.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Round {
    /// About the surface: up to some metres and some radii from an object's sphere.
    Surface { reach: f32, radii: f32 },
    /// Between the surface and a light.
    Light { middle: Vec3, radius: f32 },
    /// On the way to a light far away, whose half angle has this tangent.
    Sun { way: Vec3, slope: f32 },
    /// In what the surface mirrors.
    Mirrored,
}

/// The tiles of pictures of one size, and the objects in each.
#[derive(Debug)]
pub(super) struct Tiles {
    size: UVec2,
    pub(super) uniform: Uniform<TileUniform>,
    pub(super) masks: Buffer,
    pub(super) list: Buffer,
    pub(super) draw: Buffer,
}

impl Tiles {
    /// Room for the tiles of a picture with so many objects.
    pub(super) fn new(gpu: &Gpu, size: UVec2, capacity: u32) -> Result<Self, GpuError> {
        let tiles = (size + TILE_SIDE - 1) / TILE_SIDE;
        let count = u64::from(tiles.x) * u64::from(tiles.y);
        let words = u64::from(capacity.max(1).div_ceil(32));
        let words = words + words.div_ceil(32);
        let draw_usage = wgpu::BufferUsages::STORAGE
            | wgpu::BufferUsages::INDIRECT
            | wgpu::BufferUsages::COPY_DST
            | wgpu::BufferUsages::COPY_SRC;
        Ok(Self {
            size,
            uniform: Uniform::new(gpu, "visibility/tiles", &bytemuck::Zeroable::zeroed()),
            masks: Buffer::storage(gpu, "visibility/tile masks", 4 * count * words)?,
            list: Buffer::storage(gpu, "visibility/tile list", 4 * count)?,
            draw: Buffer::with_usage(gpu, "visibility/draw", DRAW_BYTES, draw_usage),
        })
    }

    fn counts(&self) -> UVec2 {
        (self.size + TILE_SIDE - 1) / TILE_SIDE
    }

    /// Size of the pictures that it is for.
    pub(super) fn size(&self) -> UVec2 {
        self.size
    }

    /// Tiles that the last frame drew. Waits.
    pub(super) fn read_drawn(&self, gpu: &Gpu) -> Result<u32, GpuError> {
        let draw: Vec<u32> = read_buffer(gpu, &self.draw)?;
        Ok(draw.get(1).copied().unwrap_or(0))
    }

    /// Says where objects count in this frame.
    pub(super) fn update(&self, gpu: &Gpu, objects: &Objects, round: Round) {
        let (mut reach, mut reach_in_radii) = (0.0, 0.0);
        let (mut light, mut light_radius, mut kind) = (Vec3::ZERO, 0.0, 0);
        match round {
            Round::Surface { reach: metres, radii } => (reach, reach_in_radii) = (metres.min(1e30), radii),
            Round::Light { middle, radius } => (light, light_radius, kind) = (middle, radius, 1),
            Round::Sun { way, slope } => (light, light_radius, kind) = (way, slope, 2),
            Round::Mirrored => {}
        }
        let uniform = TileUniform {
            tiles: self.counts(),
            size: self.size,
            object_count: objects.count,
            words: objects.capacity.div_ceil(32).min(objects.count.div_ceil(32).max(1)),
            reach,
            reach_in_radii,
            light,
            light_radius,
            kind,
            reserved_0: 0,
            reserved_1: 0,
            reserved_2: 0,
        };
        self.uniform.write(gpu, &uniform);
    }
}

/// The pass that fills [`Tiles`].
#[derive(Debug)]
pub(super) struct Cull(ComputePass);

impl Cull {
    pub(super) fn new(gpu: &Gpu, shader: &Shader) -> Self {
        Self(ComputePass::new(gpu, shader, &[]))
    }

    /// `roughness` is for the shader that culls what is mirrored.
    pub(super) fn record(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        receiver: &Receiver<'_>,
        objects: &Objects,
        roughness: Option<&Texture>,
        tiles: &mut Tiles,
    ) -> Result<(), GpuError> {
        encoder.clear_buffer(&tiles.draw.raw, 0, None);
        let count = tiles.counts();
        // A picture of 8192 x 8192 texels has 16,384 groups of tiles; a dispatch can have four times as many in a row.
        let groups = (count.x * count.y).div_ceil(64);
        let mut bindings = Bindings::new()
            .read("view", receiver.uniform)
            .read("tiles", &tiles.uniform)
            .read("depth", receiver.depth)
            .read("objects", &objects.buffer)
            .write("tile_masks", &mut tiles.masks)
            .write("tile_list", &mut tiles.list)
            .write("draw", &mut tiles.draw);
        if let Some(roughness) = roughness {
            bindings = bindings.read("normal", receiver.normal).read("roughness", roughness);
        }
        self.0.record(gpu, encoder, &bindings, [groups, 1, 1])
    }
}
