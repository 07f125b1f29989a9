//! The picture: direct light + albedo / pi * indirect irradiance + emission, under a coat of polish if there is one, or one layer of it
//! alone.

use glam::Vec3;
use lumivox::gpu::{Bindings, FullscreenPass, Gpu, GpuError, Shader, Texture, TextureOptions, Uniform};
use lumivox::{wgpu, wgsl};
use lumivox_scene::SkyMap;

use crate::direct::all_light;
use crate::lights::Sky;
use crate::surface::{HDR_FORMAT, SurfaceView};

/// The shader.
pub const SHADER: Shader = Shader {
    name: "render/composite",
    parts: &[wgsl::VIEW, wgsl::PACK, wgsl::FULLSCREEN, include_str!("composite.wgsl")],
};

/// What a picture shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Layer {
    /// Everything, linear radiance.
    #[default]
    Final,
    /// Radiance that light reflects on its first bounce.
    Direct,
    /// Radiance that indirect light adds, albedo included.
    Indirect,
    /// Reflectance.
    Albedo,
    /// World normal, -1..1 shown as 0..1.
    Normal,
    /// Distance along the view direction in metres, at most 65504.
    Depth,
    /// The cells of the volume, or what [`Settings::voxel_channel`](crate::Settings) says of them.
    Voxels,
    /// The light in free space: a ball at each point of an irradiance volume, which shows what arrives from each side.
    Lobes,
    /// What surfaces would mirror if all of them had [`Settings::roughness`](crate::Settings): gathered light.
    Glossy,
    /// Where light may leak: the share of a pixel's gathered light that comes from surfaces it cannot see.
    Leaks,
    /// What objects with visibility fields let through of the light from all around, 0 to 1.
    Occlusion,
    /// What surfaces mirror, if all are polished: objects with visibility fields, and the rest around them.
    Reflections,
    /// What leaves and other absorbers leave of the first light that has slicemaps, 0 to 1 in each colour.
    Transmittance,
    /// Metres of glass that the ray of a pixel crosses, up to what is opaque.
    Thickness,
}

/// How surfaces mirror.
#[derive(Clone, Copy, Debug)]
pub struct Mirror {
    /// The part of light that is mirrored head on.
    pub reflectance: f32,
    /// Roughness of the polish.
    pub roughness: f32,
    /// Whether the sky stands around the objects, whatever else there is; else what was gathered.
    pub sky: bool,
}

/// What a picture may have besides.
#[derive(Clone, Copy, Debug, Default)]
pub struct Extras<'t> {
    /// What objects let through, for each pixel.
    pub occlusion: Option<&'t Texture>,
    /// What is mirrored of objects.
    pub reflection: Option<&'t Texture>,
    /// What is mirrored of gathered light.
    pub mirrored: Option<&'t Texture>,
}

lumivox::gpu_struct! {
    /// What the composition shows.
    pub struct CompositeUniform {
        /// Radiance where nothing was drawn, without what the map adds.
        pub sky: Vec3,
        /// A [`Layer`] by number.
        pub layer: u32,
        /// The part of light that is mirrored head on.
        pub reflectance: f32,
        /// Roughness of the polish.
        pub roughness: f32,
        /// Whether the sky is mirrored where no object is.
        pub mirrors_sky: u32,
        /// Whether anything is mirrored.
        pub mirrors: u32,
    }
}

/// The pass.
#[derive(Debug)]
pub struct CompositePass {
    pass: FullscreenPass,
    uniform: Uniform<CompositeUniform>,
    sky: Vec3,
    sky_map: Texture,
    /// Stands where there is no occlusion.
    all: Texture,
    /// Stands where nothing is mirrored.
    none: Texture,
}

impl CompositePass {
    /// Compiles it, for a sky to be seen behind everything.
    ///
    /// # Errors
    /// Those of the device.
    pub fn new(gpu: &Gpu, sky: &Sky) -> Result<Self, GpuError> {
        let nothing: CompositeUniform = bytemuck::Zeroable::zeroed();
        Ok(Self {
            pass: FullscreenPass::new(gpu, &SHADER, HDR_FORMAT, false),
            uniform: Uniform::new(gpu, "render/composite", &nothing),
            sky: sky.constant,
            sky_map: sky_texture(gpu, sky)?,
            all: all_light(gpu)?,
            none: Texture::target(gpu, "composite/none", [1, 1], HDR_FORMAT)?,
        })
    }

    /// Chooses the layer, from the next submission on.
    pub fn update(&self, gpu: &Gpu, layer: Layer, mirror: Option<Mirror>) {
        let number = match layer {
            Layer::Final | Layer::Voxels | Layer::Lobes | Layer::Thickness | Layer::Transmittance => 0,
            Layer::Direct => 1,
            Layer::Indirect => 2,
            Layer::Albedo => 3,
            Layer::Normal => 4,
            Layer::Depth => 5,
            Layer::Leaks => 6,
            Layer::Glossy => 7,
            Layer::Occlusion => 8,
            Layer::Reflections => 9,
        };
        let uniform = CompositeUniform {
            sky: self.sky,
            layer: number,
            reflectance: mirror.map_or(0.0, |m| m.reflectance.clamp(0.0, 1.0)),
            roughness: mirror.map_or(1.0, |m| m.roughness.clamp(0.0, 1.0)),
            mirrors_sky: u32::from(mirror.is_some_and(|m| m.sky)),
            mirrors: u32::from(mirror.is_some()),
        };
        self.uniform.write(gpu, &uniform);
    }

    /// Makes the picture.
    pub fn record(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        camera: &SurfaceView,
        irradiance: &Texture,
        extras: Extras<'_>,
        picture: &mut Texture,
    ) -> Result<(), GpuError> {
        let gbuffer = &camera.input.textures;
        let bindings = Bindings::new()
            .read("view", &camera.input.uniform)
            .read("composite", &self.uniform)
            .read("depth", &gbuffer.depth)
            .read("normal", &gbuffer.normal)
            .read("albedo", &gbuffer.albedo)
            .read("emission", &gbuffer.emission)
            .read("radiance", &gbuffer.radiance)
            .read("sky_map", &self.sky_map)
            .read("irradiance", irradiance)
            .read("occlusion", extras.occlusion.unwrap_or(&self.all))
            .read("reflection", extras.reflection.unwrap_or(&self.none))
            .read("mirrored", extras.mirrored.unwrap_or(&self.none));
        self.pass.record(gpu, encoder, &bindings, picture, false)
    }
}

/// The sky's map, of at most as many rows as every device takes twice of as columns; black where there is none.
fn sky_texture(gpu: &Gpu, sky: &Sky) -> Result<Texture, GpuError> {
    let black = SkyMap { width: 1, height: 1, pixels: vec![Vec3::ZERO] };
    let rows = gpu.device.limits().max_texture_dimension_2d / 2;
    let map = sky.map.as_ref().map_or(black, |map| map.shrunk(rows));
    let half = |c: f32| half::f16::from_f32(c.clamp(0.0, lumivox::wgsl::HALF_MAX));
    let texels: Vec<[half::f16; 4]> =
        map.pixels.iter().map(|p| [half(p.x), half(p.y), half(p.z), half::f16::ZERO]).collect();
    let usage = wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST;
    let options = TextureOptions { size: [map.width, map.height], format: HDR_FORMAT, usage, mips: 1 };
    let texture = Texture::new(gpu, "render/sky", options)?;
    gpu.queue.write_texture(
        texture.raw.as_image_copy(),
        lumivox::bytemuck::cast_slice(&texels),
        wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(8 * map.width), rows_per_image: None },
        wgpu::Extent3d { width: map.width, height: map.height, depth_or_array_layers: 1 },
    );
    Ok(texture)
}
