//! What of the volumes needs no drawing (3.2).
//!
//! **Layers.** The paper cuts the picture into layers by planes through the eye, which show as lines. Here these are lines between columns
//! of pixels, or between rows, whichever lies more across the light's way in the picture. So a layer is a rectangle, and what a volume
//! has in it is drawn with that rectangle as the scissor: the same triangles as without layers, which therefore
//! cover the same pixels at the same depths, bit for bit. Corners that are cut anew at planes, as in the paper, would each be rounded
//! to the raster in its own way, and edges with them. Runs of layers have rectangles too, halves of halves, and faces of which all
//! layers are kept are drawn once.
//!
//! **Slices.** In a view of the light each texel has a bit for each layer: whether a visible surface lies in it there. That is the paper's slicemap,
//! made of the depth image's pixels, each put where the light would see it (its *pixel-based receiver culling*, and exact), or of the
//! triangles of all meshes that show in the picture (its plain form).
//!
//! **Footprints.** Of each caster the texels that any of it touches, with the range of distances in each. A texel is *covered* by
//! a caster that touches it and whose outline does not; what lies behind the nearest such distance is in shadow. A caster that is so in
//! all of its texels is left out; with *pixel-based caster culling* each such texel is.
//!
//! **Reduction.** A caster keeps the layers of all texels of its footprint that are not left out: ORed in compute, the paper's
//! *ideal* algorithm, or asked by an occlusion query for each caster and layer, its *practical* one. Both keep the same.
//!
//! All of it errs on the side of keeping: texels are touched as a whole, an eighth of a texel around them too. So a pixel differs from that
//! without culling only where a volume's border is off by as much, or where a volume is counted that the pixel is not in.

mod queries;
mod stages;

use glam::{Mat4, UVec2, Vec4};
use lumivox_core::View;

use super::casters::Casters;
use super::settings::{CullSettings, MAX_LIGHT_VIEWS, Reduction, VolumeUniform};
use super::volumes::Volumes;
use crate::gpu::{Bindings, Buffer, Gpu, GpuError, Shader, Texture, Uniform, read_buffer};
use crate::wgsl::linear_groups;
pub use queries::QueriedUniform;
use queries::Queries;
use stages::Stages;

crate::gpu_struct! {
    /// A view of the light as shaders see it.
    pub struct MapUniform {
        /// World to the view's clip space.
        pub clip_from_world: Mat4,
        /// Metres along the view, as a product with a homogeneous point.
        pub distance: Vec4,
        /// Texels.
        pub size: UVec2,
        /// Texels that casters may have of their own together.
        pub capacity: u32,
        /// Whether texels in shadow are left out, or whole casters.
        pub by_texel: u32,
    }
}

/// The passes, and what lies between them.
#[derive(Debug)]
pub(super) struct Culling {
    settings: CullSettings,
    stages: Stages,
    queries: Option<Queries>,
    store: Store,
    groups: [u32; 3],
}

/// Buffers of one view of a light, used by one after the other.
#[derive(Debug)]
struct Store {
    rects: Buffer,
    footprints: Buffer,
    covered: Buffer,
    slices: Buffer,
    visible: Buffer,
    kept: Buffer,
    /// Texels in `footprints`.
    capacity: u32,
}

/// What the stages take besides.
pub(super) struct Seen<'a> {
    pub(super) uniform: &'a Uniform<VolumeUniform>,
    pub(super) casters: &'a Casters,
    pub(super) volumes: &'a Volumes,
    pub(super) depth: &'a Texture,
    pub(super) receivers: &'a Texture,
    pub(super) maps: &'a [Uniform<MapUniform>],
}

impl Culling {
    pub(super) fn new(
        gpu: &Gpu,
        casters: &Casters,
        settings: CullSettings,
        picture: [u32; 2],
    ) -> Result<Self, GpuError> {
        settings.check()?;
        let count = casters.count().max(1) as u64;
        let texels = u64::from(settings.map_size).pow(2);
        let words = u64::from(settings.words());
        // A few times over all of the map, as far as one binding goes.
        let most = gpu.device.limits().max_storage_buffer_binding_size / 8;
        let capacity = (4 * texels).max(1 << 16).min(most);
        let storage = |label: &str, words: u64| Buffer::storage(gpu, label, 4 * words);
        let store = Store {
            rects: storage("volumes/rects", 8 * count)?,
            footprints: storage("volumes/footprints", 2 * capacity)?,
            covered: storage("volumes/covered", texels)?,
            slices: storage("volumes/slices", words * texels)?,
            visible: storage("volumes/visible", count)?,
            kept: storage("volumes/kept", count * (words + 1))?,
            capacity: capacity as u32,
        };
        let is_practical = settings.reduction == Reduction::Practical;
        let queries = is_practical.then(|| Queries::new(gpu, casters, &settings)).transpose()?;
        let columns = casters.count().clamp(1, 32_768) as u32;
        let groups = [columns, (count as u32).div_ceil(columns), 1];
        Ok(Self { stages: Stages::new(gpu, &settings, picture)?, queries, store, settings, groups })
    }

    /// What the lists are made from: of each caster whether any of it is left, and its layers.
    pub(super) fn kept(&self) -> &Buffer {
        &self.store.kept
    }

    /// Corner and size in pixels of what each list from 2 on is drawn in.
    pub(super) fn rectangles(&self, size: UVec2, axis: u32) -> Vec<[u32; 4]> {
        self.settings.rectangles(size, axis)
    }

    /// Of each caster its layers, none if the light does not see it. Waits.
    pub(super) fn read_kept(&self, gpu: &Gpu) -> Result<Vec<u128>, GpuError> {
        let words: Vec<u32> = read_buffer(gpu, &self.store.kept)?;
        let below = u128::MAX >> (128 - self.settings.layers);
        let layers = |words: &[u32]| words.iter().rev().fold(0, |bits, &word| bits << 32 | u128::from(word));
        let of_caster = |words: &[u32]| if words[0] == 0 { 0 } else { layers(&words[1..]) & below };
        Ok(words.chunks_exact(self.settings.words() as usize + 1).map(of_caster).collect())
    }

    /// A view of the light.
    pub(super) fn map(&self, view: &View) -> MapUniform {
        MapUniform {
            clip_from_world: view.clip_from_world,
            distance: -view.eye_from_world.row(2),
            size: UVec2::splat(self.settings.map_size),
            capacity: self.store.capacity,
            by_texel: u32::from(self.settings.by_texel),
        }
    }

    /// Finds what is kept, for a light with views `seen.maps`.
    pub(super) fn record(
        &mut self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        seen: &Seen<'_>,
    ) -> Result<(), GpuError> {
        let Self { settings, stages, queries, store, groups } = self;
        let Seen { uniform, casters, volumes, .. } = *seen;
        encoder.clear_buffer(&store.kept.raw, 0, None);
        if !settings.by_pixel {
            encoder.clear_buffer(&store.visible.raw, 0, None);
            stages.record_visible(gpu, encoder, seen, &mut store.visible)?;
        }
        for map in seen.maps.iter().take(MAX_LIGHT_VIEWS) {
            for buffer in [&store.rects, &store.footprints, &store.covered, &store.slices] {
                encoder.clear_buffer(&buffer.raw, 0, None);
            }
            let bindings = Bindings::new()
                .read("volume", uniform)
                .read("map", map)
                .read("vertices", &casters.vertices)
                .read("triangles", &casters.triangles)
                .read("facing", &volumes.facing)
                .write("rects", &mut store.rects);
            stages.rects.record(gpu, encoder, &bindings, linear_groups(casters.triangle_count))?;
            let bindings =
                Bindings::new().read("volume", uniform).read("map", map).write("rects", &mut store.rects);
            stages.places.record(gpu, encoder, &bindings, [1, 1, 1])?;
            if settings.by_pixel {
                stages.record_pixels(gpu, encoder, seen, map, &mut store.slices)?;
            } else {
                stages.record_slices(gpu, encoder, seen, map, (&store.visible, &mut store.slices))?;
            }
            stages.record_footprints(gpu, encoder, seen, map, (&store.rects, &mut store.footprints))?;
            let bindings = Bindings::new()
                .read("volume", uniform)
                .read("map", map)
                .read("rects", &store.rects)
                .read("footprints", &store.footprints)
                .write("covered", &mut store.covered);
            stages.cover.record(gpu, encoder, &bindings, *groups)?;
            if let Some(queries) = queries {
                let asked = (&store.covered, &store.slices, &mut store.kept);
                queries.record(gpu, encoder, seen, map, asked)?;
                continue;
            }
            let bindings = Bindings::new()
                .read("volume", uniform)
                .read("map", map)
                .read("rects", &store.rects)
                .read("footprints", &store.footprints)
                .read("covered", &store.covered)
                .read("slices", &store.slices)
                .write("kept", &mut store.kept);
            stages.reduce.record(gpu, encoder, &bindings, *groups)?;
        }
        Ok(())
    }
}

pub(super) fn shaders() -> Vec<Shader> {
    [stages::SHADERS, queries::SHADERS].concat()
}
