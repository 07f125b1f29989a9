//! Shadow volumes: hard shadows, exact to the pixel, of a light without extent.
//!
//! Source: Crow 1977; culling and clamping are those of Eisemann and Decoret, *Fast Scene Voxelization and Applications* (2006),
//! section 3.2.
//!
//! [`ShadowVolumes`] takes the host's depth image, the meshes that cast and a light, and hands out a mask: 0 in shadow, 1 elsewhere.
//!
//! | stage | does |
//! | --- | --- |
//! | `world` | vertices of all casters to the world |
//! | `around` | which casters a lamp may be inside of |
//! | `facing` | which triangles cast |
//! | `nets` | how many sides the volume has at each edge |
//! | `caps`, `sides`, `plan` | lists of the faces, for indirect draws |
//! | `receivers` | metres to the surface of each pixel |
//! | `rects` to `collect` | if asked for: what of all this no pixel needs |
//! | `draw` | faces behind the surface count in a stencil: back faces up, front faces down |
//! | `mask` | where the count is not 0 there is shadow |
//!
//! **Which triangles cast.** Where a part of a mesh is closed ([`Topology`]), the triangles that the light sees from outside. Where
//! it is open, or a lamp stands within the box around its caster and so may be inside of it, all, each turned so that it faces the light. A volume has a cap at each triangle that casts, one more at infinity, and at each edge
//! as many sides as casting triangles run along it in one direction more than in the other. So the borders of the caps
//! are closed whatever the mesh is, and the count of a point is the number of casting triangles between it and the light: never
//! negative, so that volumes never cancel each other. A closed body counts once for each time that the light enters it, a sheet
//! for each that it crosses.
//!
//! **Endless.** Volumes reach to infinity by homogeneous corners with 0 at the end, in a projection without a far plane. What
//! lies behind the surface counts (*z-fail*), so a camera inside of a volume is no special case, and the near plane cuts nothing that counts.
//!
//! **Limits.** The stencil has 8 bits: a point behind 256 casting triangles, or another multiple, is lit. Surfaces between
//! facets that the light just misses are in shadow by whole triangles, however their normals are interpolated.

mod casters;
mod culling;
mod draw;
mod settings;
mod topology;
mod volumes;

pub use casters::PartUniform;
pub use culling::{MapUniform, QueriedUniform};
pub use settings::{
    CullSettings, MAX_LAYERS, MAX_LIGHT_VIEWS, Reduction, VolumeLight, VolumeSettings, VolumeUniform,
};
pub use topology::Topology;
pub use volumes::VolumeCounts;

use lumivox_core::View;

use crate::gpu::{Buffer, GeneratedText, Gpu, GpuError, Shader, Texture, Uniform};
use crate::visibility::FACTOR_FORMAT;
use crate::voxelize::Mesh;
use casters::Casters;
use culling::{Culling, Seen};
use draw::{Draw, Drawn};
use volumes::Volumes;

const VOLUME: &str = include_str!("volume.wgsl");
const PIXEL: &str = include_str!("pixel.wgsl");

/// The shadows of meshes in the light of some lamps.
#[derive(Debug)]
pub struct ShadowVolumes {
    settings: VolumeSettings,
    casters: Casters,
    volumes: Volumes,
    draw: Draw,
    lights: Vec<Light>,
    culling: Option<Culling>,
    /// Stands where nothing is culled.
    no_kept: Buffer,
}

#[derive(Debug)]
struct Light {
    value: VolumeUniform,
    uniform: Uniform<VolumeUniform>,
    /// Its views, where anything is culled.
    maps: Vec<Uniform<MapUniform>>,
    mask: Texture,
}

impl ShadowVolumes {
    /// Of meshes with these topologies, one of each in the order in which [`Self::record`] gets them, in so many lights.
    ///
    /// # Errors
    /// More triangles than the device binds the volumes of (with the numbers), or a picture larger than its textures.
    pub fn new(
        gpu: &Gpu,
        topologies: &[&Topology],
        lights: usize,
        settings: VolumeSettings,
    ) -> Result<Self, GpuError> {
        let size = settings.size.to_array();
        let light = |_| {
            let value = bytemuck::Zeroable::zeroed();
            let map = |_| Uniform::new(gpu, "volumes/map", &bytemuck::Zeroable::zeroed());
            Ok(Light {
                value,
                uniform: Uniform::new(gpu, "volumes", &value),
                maps: settings.culling.iter().flat_map(|_| 0..MAX_LIGHT_VIEWS).map(map).collect(),
                mask: Texture::target(gpu, "volumes/mask", size, FACTOR_FORMAT)?,
            })
        };
        let casters = Casters::new(gpu, topologies)?;
        Ok(Self {
            lights: (0..lights).map(light).collect::<Result<_, GpuError>>()?,
            volumes: Volumes::new(gpu, &casters)?,
            draw: Draw::new(gpu, size)?,
            culling: settings.culling.map(|c| Culling::new(gpu, &casters, c, size)).transpose()?,
            no_kept: Buffer::storage(gpu, "volumes/kept", 16)?,
            casters,
            settings,
        })
    }

    /// Where the camera and the lights stand, from the next submission on. With each light the views that together hold all that it
    /// shines on, at most [`MAX_LIGHT_VIEWS`]: what lies outside of them is in no shadow. None for light that reaches everything.
    pub fn update(&mut self, gpu: &Gpu, view: &View, lights: &[(VolumeLight, &[View])]) {
        for (light, (lamp, lit)) in self.lights.iter_mut().zip(lights) {
            let culling = self.settings.culling.filter(|_| !lit.is_empty());
            light.value = VolumeUniform {
                culls: u32::from(culling.is_some()),
                layers: culling.map_or(0, |c| c.layers),
                words: culling.map_or(0, |c| c.words()),
                leaves: culling.map_or(1, |c| c.leaves()),
                triangles: self.casters.triangle_count,
                edges: self.casters.edge_count,
                casters: self.casters.count() as u32,
                capacity: self.volumes.capacity,
                ..VolumeUniform::new(&self.settings, view, lamp, lit)
            };
            light.uniform.write(gpu, &light.value);
            if let Some(culling) = &self.culling {
                light.maps.iter().zip(*lit).for_each(|(map, view)| map.write(gpu, &culling.map(view)));
            }
        }
    }

    /// Makes the masks for the surfaces that `depth` shows: depth of the view in [`Self::update`], a depth texture or 32-bit floats.
    /// Meshes that hold moving vertices of the host's are taken as they are when this runs.
    ///
    /// # Errors
    /// Another number of meshes than of topologies, or a depth image of another size.
    pub fn record(
        &mut self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        depth: &Texture,
        meshes: &[&Mesh],
    ) -> Result<(), GpuError> {
        gpu.check()?;
        let Self { settings, casters, volumes, draw, lights, culling, no_kept } = self;
        if meshes.len() != casters.count() || depth.size() != settings.size.to_array() {
            return Err(GpuError::Validation(format!(
                "shadow volumes of {} meshes over {} pixels were given {} and {:?}",
                casters.count(),
                settings.size,
                meshes.len(),
                depth.size(),
            )));
        }
        casters.record(gpu, encoder, meshes)?;
        for Light { value, uniform, maps, mask } in lights {
            volumes.record_silhouettes(gpu, encoder, uniform, casters)?;
            draw.record_receivers(gpu, encoder, uniform, depth)?;
            let mut layers = Vec::new();
            let mut kept = &*no_kept;
            if let Some(culling) = culling.as_mut().filter(|_| value.culls != 0) {
                let maps = &maps[..value.light_views as usize];
                let receivers = &draw.receivers;
                let seen = Seen { uniform, casters, volumes, depth, receivers, maps };
                culling.record(gpu, encoder, &seen)?;
                kept = culling.kept();
                layers = culling.rectangles(settings.size, value.axis);
            }
            volumes.record_lists(gpu, encoder, uniform, (casters, kept))?;
            let drawn = Drawn {
                uniform,
                vertices: &casters.vertices,
                primitives: &volumes.primitives,
                draws: &volumes.draws,
                layers: &layers,
            };
            draw.record(gpu, encoder, &drawn, mask)?;
        }
        Ok(())
    }

    /// 0 in the shadow of a light, 1 elsewhere, in red: what the light is multiplied by.
    /// [`FACTOR_FORMAT`]. None for a light that there is not.
    pub fn mask(&self, light: usize) -> Option<&Texture> {
        self.lights.get(light).map(|light| &light.mask)
    }

    /// The count of the last light's volumes around each pixel's surface, modulo 256: `Stencil8`, for hosts that draw with a stencil test.
    pub fn stencil(&self) -> &Texture {
        &self.draw.stencil
    }

    /// Begins or ends to count fragments, for measuring: slower.
    ///
    /// # Errors
    /// The device's.
    pub fn set_counting(&mut self, gpu: &Gpu, counts: bool) -> Result<(), GpuError> {
        self.draw.set_counting(gpu, counts)
    }

    /// How much the last recording drew for its last light. Waits.
    pub fn read_counts(&self, gpu: &Gpu) -> Result<VolumeCounts, GpuError> {
        let [fragments, updates] = self.draw.read_fill(gpu)?;
        let casters = self.casters.count() as u32;
        let kept_casters = self
            .read_layers(gpu)?
            .map_or(casters, |kept| kept.iter().filter(|layers| **layers != 0).count() as u32);
        Ok(VolumeCounts { fragments, updates, casters, kept_casters, ..self.volumes.read_counts(gpu)? })
    }

    /// Of each caster the layers of the picture that the last recording drew it in for its last light, the first in the lowest bit;
    /// none where nothing is culled. Waits.
    pub fn read_layers(&self, gpu: &Gpu) -> Result<Option<Vec<u128>>, GpuError> {
        let culls = self.lights.last().is_some_and(|light| light.value.culls != 0);
        self.culling.as_ref().filter(|_| culls).map(|culling| culling.read_kept(gpu)).transpose()
    }
}

pub(crate) fn shaders() -> Vec<Shader> {
    let drawing = vec![
        volumes::AROUND,
        volumes::FACING,
        volumes::NETS,
        volumes::CAPS,
        volumes::SIDES,
        volumes::PLAN,
        draw::RECEIVERS,
        draw::DRAW,
        draw::COUNTED_DRAW,
        draw::MASK,
    ];
    [drawing, culling::shaders()].concat()
}

/// For validation and for reading.
pub(crate) fn texts() -> Vec<GeneratedText> {
    vec![casters::text()]
}
