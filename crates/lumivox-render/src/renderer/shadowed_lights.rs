//! The lights as the picture sees them: their views in batches that share one atlas of shadow maps.
//!
//! However many views there are, there is one depth texture. It is cut into equal tiles, as many views are drawn into them as fit, one
//! full-screen pass adds the light of these, and the next batch draws over them. With an atlas of 4096 texels a
//! side a directional or spot light has all of it, a point light's six views 2048 each (1024 from the third point light on), a
//! sample of the sky 1024, and each of the five views of a rect light's sample 512.

use glam::{Mat4, UVec2, Vec2};
use lumivox::core::{Bounds, View};
use lumivox::gpu::{Buffer, Gpu, GpuError, Texture, Uniform};
use lumivox::progressive::InjectionScale;
use lumivox::wgsl::ViewUniform;

use crate::lights::{self, LightSample, LightUniform, ViewShape};
use crate::renderer::field_objects::Shade;
use crate::surface::DEPTH_FORMAT;

/// Shadow views are not injected.
const NOTHING_INJECTED: InjectionScale =
    InjectionScale { attribute_points: 1, light_points: 1, radiance_max: 1.0 };

lumivox::gpu_struct! {
    /// A view of a light with its tile of the atlas, as the direct pass sees it.
    pub struct ShadowViewUniform {
        /// World to the view's clip space.
        pub clip_from_world: Mat4,
        /// And back.
        pub world_from_clip: Mat4,
        /// Upper left corner of the tile in the atlas, 0..1.
        pub tile_origin: Vec2,
        /// Side of the tile in the atlas, 0..1.
        pub tile_size: f32,
        /// Texels along the tile's side.
        pub texels: f32,
        /// Which light it belongs to.
        pub light: u32,
        /// Unused.
        pub reserved_0: u32,
        /// Unused.
        pub reserved_1: u32,
        /// Unused.
        pub reserved_2: u32,
    }
}

lumivox::gpu_struct! {
    /// The views of one batch.
    pub struct ShadowBatchUniform {
        /// The first one.
        pub first_view: u32,
        /// How many there are.
        pub view_count: u32,
        /// Whether what stands for leaves has colours.
        pub is_colored: u32,
        /// Unused.
        pub reserved: u32,
    }
}

/// All lights of the picture.
#[derive(Debug)]
pub struct ShadowedLights {
    /// An array of [`LightUniform`].
    pub(crate) lights: Buffer,
    /// An array of [`ShadowViewUniform`].
    pub(crate) views: Buffer,
    /// What is drawn together.
    pub(crate) batches: Vec<ShadowBatch>,
    /// Depth, 1 near to 0 far.
    pub(crate) atlas: Texture,
    samples: Vec<LightSample>,
    /// Texels a side of the tiles of each sample.
    tile_sizes: Vec<u32>,
}

/// Views that fill the atlas once.
#[derive(Debug)]
pub struct ShadowBatch {
    pub(crate) uniform: Uniform<ShadowBatchUniform>,
    pub(crate) tiles: Vec<ShadowTile>,
    /// What stands for objects with visibility fields in its light.
    pub(crate) shade: Shade,
}

/// One view and where it is drawn.
#[derive(Debug)]
pub struct ShadowTile {
    pub(crate) view: Uniform<ViewUniform>,
    /// Upper left corner in texels.
    pub(crate) corner: UVec2,
    /// Side in texels.
    pub(crate) size: u32,
}

impl ShadowedLights {
    /// An atlas of `size` texels a side, and room for these samples; `shade` says for each source of light what stands for objects
    /// with fields.
    pub(crate) fn new(
        gpu: &Gpu,
        samples: Vec<LightSample>,
        size: u32,
        shade: impl Fn(Option<usize>) -> Shade,
    ) -> Result<Self, GpuError> {
        let points = samples.iter().filter(|s| s.shape == ViewShape::All).count();
        let tile_sizes: Vec<u32> =
            samples.iter().map(|s| (size / tiles_per_side(s, points)).max(1)).collect();
        let of_sample =
            |(sample, size): (&LightSample, &u32)| vec![(*size, shade(sample.source)); sample.shape.count()];
        let views: Vec<_> = samples.iter().zip(&tile_sizes).flat_map(of_sample).collect();
        let storage = |label: &str, bytes: usize| Buffer::storage(gpu, label, bytes.max(256) as u64);
        Ok(Self {
            lights: storage("shadow/lights", samples.len() * size_of::<LightUniform>())?,
            views: storage("shadow/views", views.len() * size_of::<ShadowViewUniform>())?,
            batches: batches(gpu, &views, size),
            atlas: Texture::target(gpu, "shadow/atlas", [size; 2], DEPTH_FORMAT)?,
            samples,
            tile_sizes,
        })
    }

    /// Moves and changes the samples: as many and of the same kinds as before.
    pub fn set(&mut self, samples: Vec<LightSample>) {
        if samples.len() == self.samples.len() {
            self.samples = samples;
        }
    }

    /// What lights the picture.
    pub(crate) fn samples(&self) -> &[LightSample] {
        &self.samples
    }

    /// Writes where all views stand. Once per frame, before recording.
    pub fn update(&self, gpu: &Gpu, bounds: &Bounds, camera: &View) {
        let receivers = lights::visible_part(camera, bounds);
        let uniforms: Vec<LightUniform> = self.samples.iter().map(|s| s.uniform).collect();
        gpu.queue.write_buffer(&self.lights.raw, 0, bytemuck::cast_slice(&uniforms));

        let size = self.atlas.size()[0] as f32;
        let mut tiles = self.batches.iter().flat_map(|b| &b.tiles);
        let mut views = Vec::new();
        for (n, (sample, &texels)) in self.samples.iter().zip(&self.tile_sizes).enumerate() {
            for view in lights::light_views(sample, bounds, &receivers, texels) {
                let Some(tile) = tiles.next() else { continue };
                let view = view.with_reversed_depth();
                tile.view
                    .write(gpu, &ViewUniform::new(&view, UVec2::splat(texels), UVec2::ONE, NOTHING_INJECTED));
                views.push(ShadowViewUniform {
                    clip_from_world: view.clip_from_world,
                    world_from_clip: view.world_from_clip(),
                    tile_origin: tile.corner.as_vec2() / size,
                    tile_size: texels as f32 / size,
                    texels: texels as f32,
                    light: n as u32,
                    reserved_0: 0,
                    reserved_1: 0,
                    reserved_2: 0,
                });
            }
        }
        gpu.queue.write_buffer(&self.views.raw, 0, bytemuck::cast_slice(&views));
    }
}

/// How finely the atlas is cut for a sample.
fn tiles_per_side(sample: &LightSample, points: usize) -> u32 {
    match sample.shape {
        ViewShape::Parallel if sample.is_area => 4,
        ViewShape::Parallel | ViewShape::Cone { .. } => 1,
        ViewShape::All if points <= 2 => 2,
        ViewShape::All => 4,
        ViewShape::Half => 8,
    }
}

/// Cuts a row of views, given by their tiles' sizes and what stands for objects, into batches that are equal in both.
fn batches(gpu: &Gpu, views: &[(u32, Shade)], atlas: u32) -> Vec<ShadowBatch> {
    let mut batches = Vec::new();
    let mut first = 0;
    while first < views.len() {
        let (size, shade) = views[first];
        let columns = (atlas / size).max(1);
        let alike = views[first..].iter().take_while(|v| **v == (size, shade)).count();
        let count = alike.min((columns * columns) as usize);
        let tiles = (0..count as u32).map(|n| ShadowTile {
            view: Uniform::new(gpu, "shadow/view", &bytemuck::Zeroable::zeroed()),
            corner: size * UVec2::new(n % columns, n / columns),
            size,
        });
        let value = ShadowBatchUniform {
            first_view: first as u32,
            view_count: count as u32,
            is_colored: u32::from(matches!(shade, Shade::Leaves(_))),
            reserved: 0,
        };
        let uniform = Uniform::new(gpu, "shadow/batch", &value);
        batches.push(ShadowBatch { uniform, tiles: tiles.collect(), shade });
        first += count;
    }
    batches
}
