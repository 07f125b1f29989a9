//! What shadow volumes are made for.

use glam::{Mat4, UVec2, Vec3, Vec4};
use lumivox_core::View;

use crate::gpu::GpuError;

/// Layers at most.
pub const MAX_LAYERS: u32 = 128;
/// Views of a light at most: a cube's.
pub const MAX_LIGHT_VIEWS: usize = 6;

/// A light without extent.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum VolumeLight {
    /// Light of the sun.
    Directional {
        /// The way it travels, of any length.
        direction: Vec3,
    },
    /// A lamp; a spot is one whose views hold its cone.
    Point {
        /// Where it stands.
        position: Vec3,
    },
}

/// How shadow volumes are drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VolumeSettings {
    /// Width and height of the host's depth image.
    pub size: UVec2,
    /// Metres behind a surface, along the light, at which its shadow begins: room for what the depth image rounds. More lets light
    /// through where things touch.
    pub bias: f32,
    /// What is left out of the drawing, in lights that have views. The mask stays as it is.
    pub culling: Option<CullSettings>,
}

impl Default for VolumeSettings {
    /// A millimetre, and everything is drawn.
    fn default() -> Self {
        Self { size: UVec2::new(1280, 720), bias: 1e-3, culling: None }
    }
}

/// How the layers of a caster are found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reduction {
    /// Bits of its footprint's texels ORed in compute: the paper's ideal algorithm.
    Ideal,
    /// An occlusion query for each layer: its practical one. Slower, and all casters at once by as many draws as there are layers.
    Practical,
}

/// What is left out of the drawing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CullSettings {
    /// Layers of the picture, 1 to [`MAX_LAYERS`]. More cut shadows closer, and draw more faces several times.
    pub layers: u32,
    /// Texels a side of each view of the light, 16 to 1024. More tell more casters apart.
    pub map_size: u32,
    /// How the layers of a caster are found; both find the same.
    pub reduction: Reduction,
    /// Pixel-based caster culling: what of a caster lies in shadow asks for no layers.
    pub by_texel: bool,
    /// Pixel-based receiver culling: visible pixels are the receivers, in place of visible meshes. Without it every surface of the depth
    /// image has to be one of the meshes.
    pub by_pixel: bool,
}

impl Default for CullSettings {
    /// All of it, with 32 layers.
    fn default() -> Self {
        Self { layers: 32, map_size: 512, reduction: Reduction::Ideal, by_texel: true, by_pixel: true }
    }
}

impl CullSettings {
    /// Words of bits for the layers.
    pub(super) fn words(&self) -> u32 {
        self.layers.div_ceil(32)
    }

    pub(super) fn check(&self) -> Result<(), GpuError> {
        let Self { layers, map_size, .. } = *self;
        if !(1..=MAX_LAYERS).contains(&layers) || !(16..=1024).contains(&map_size) {
            return Err(GpuError::Validation(format!(
                "shadow volumes in {layers} layers and maps of {map_size} texels; 1 to {MAX_LAYERS} and 16 to 1024 are possible"
            )));
        }
        Ok(())
    }

    /// Layers, up to a power of two.
    pub(super) fn leaves(&self) -> u32 {
        self.layers.next_power_of_two()
    }

    /// Corner and size in pixels of what the lists from 2 on are drawn in: half of the layers of a picture that is cut along an axis (0:
    /// into columns, 1: rows), and so on down to single layers. Nothing of lists behind the last layer.
    pub(super) fn rectangles(&self, size: UVec2, axis: u32) -> Vec<[u32; 4]> {
        let pixels = size.to_array()[axis as usize];
        // The first pixel `p` with `p * layers / pixels` rounded down at least `layer`.
        let first = |layer: u32| (layer.min(self.layers) * pixels).div_ceil(self.layers);
        (2..2 * self.leaves())
            .map(|list| {
                let level = list.ilog2();
                let run = self.leaves() >> level;
                let layer = (list - (1 << level)) * run;
                (first(layer), first(layer + run))
            })
            .map(|(a, b)| if axis == 0 { [a, 0, b - a, size.y] } else { [0, a, size.x, b - a] })
            .collect()
    }
}

crate::gpu_struct! {
    /// All of it as shaders see it.
    pub struct VolumeUniform {
        /// World to the picture's clip space.
        pub clip_from_world: Mat4,
        /// And back.
        pub world_from_clip: Mat4,
        /// Metres along the view, as a product with a homogeneous point.
        pub distance: Vec4,
        /// A point, or a direction with 0 at the end.
        pub light: Vec4,
        /// Size of the picture.
        pub size: UVec2,
        /// Depth of what has not been drawn.
        pub far_depth: f32,
        /// The least last coordinate in clip space that counts; 0 for a parallel view.
        pub near: f32,
        /// Metres behind a surface.
        pub bias: f32,
        /// Which coordinate of pixels layers cut.
        pub axis: u32,
        /// How many layers there are.
        pub layers: u32,
        /// Words of bits for them.
        pub words: u32,
        /// Triangles of all casters.
        pub triangles: u32,
        /// Their edges.
        pub edges: u32,
        /// Their number.
        pub casters: u32,
        /// Triangles that fit into the lists.
        pub capacity: u32,
        /// 1 where layers are dropped.
        pub culls: u32,
        /// Views of the light.
        pub light_views: u32,
        /// Layers, up to a power of two; 1 without any.
        pub leaves: u32,
        /// Unused.
        pub reserved: u32,
        /// World to the clip space of each view of the light.
        pub clip_from_world_of_light: [Mat4; MAX_LIGHT_VIEWS],
    }
}

impl VolumeUniform {
    /// What belongs to a picture and a light; the rest is zero.
    pub(super) fn new(settings: &VolumeSettings, view: &View, light: &VolumeLight, lit: &[View]) -> Self {
        let world_from_clip = view.world_from_clip();
        let (near_depth, far_depth) = if view.reversed_depth { (1.0, 0.0) } else { (0.0, 1.0) };
        let is_parallel = view.clip_from_world.row(3).truncate() == Vec3::ZERO;
        // Half of the near plane's: nothing visible lies before it, and volumes count only behind what is visible.
        let near =
            if is_parallel { 0.0 } else { 0.5 / (world_from_clip * Vec4::new(0.0, 0.0, near_depth, 1.0)).w };
        let light = match *light {
            VolumeLight::Directional { direction } => direction.normalize_or(Vec3::NEG_Y).extend(0.0),
            VolumeLight::Point { position } => position.extend(1.0),
        };
        let mut uniform: Self = bytemuck::Zeroable::zeroed();
        let views = lit.iter().take(MAX_LIGHT_VIEWS);
        for (matrix, view) in uniform.clip_from_world_of_light.iter_mut().zip(views) {
            *matrix = view.clip_from_world;
        }
        Self {
            clip_from_world: view.clip_from_world,
            world_from_clip,
            distance: -view.eye_from_world.row(2),
            light,
            size: settings.size,
            far_depth,
            near,
            bias: settings.bias,
            axis: axis(settings.size, &view.clip_from_world, light),
            light_views: lit.len().min(MAX_LIGHT_VIEWS) as u32,
            ..uniform
        }
    }
}

/// Which coordinate of pixels changes most on the way away from the light, from the middle of the picture.
fn axis(size: UVec2, clip_from_world: &Mat4, light: Vec4) -> u32 {
    let toward = clip_from_world * light;
    let way = toward.truncate().truncate() * size.as_vec2();
    u32::from(way.y.abs() > way.x.abs())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn layers_are_the_pixels_that_the_shader_counts_to_them() {
        for (layers, size) in [(1, 7), (32, 480), (32, 479), (128, 100), (77, 1000)] {
            let settings = CullSettings { layers, ..CullSettings::default() };
            let leaves = settings.leaves();
            for axis in [0, 1] {
                let mut picture = UVec2::splat(5);
                picture[axis as usize] = size;
                let rectangles = settings.rectangles(picture, axis);
                for pixel in 0..size {
                    // A layer's list, and those of the runs that hold it.
                    let leaf = leaves + pixel * layers / size;
                    for (list, rectangle) in (2..).zip(&rectangles) {
                        let (first, count) = (rectangle[axis as usize], rectangle[2 + axis as usize]);
                        let holds = list <= leaf && leaf >> (leaf.ilog2() - list.ilog2()) == list;
                        assert_eq!(
                            (first..first + count).contains(&pixel),
                            holds,
                            "{layers} of {size}, {list}"
                        );
                    }
                }
            }
        }
    }
}
