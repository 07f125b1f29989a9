//! **Lumivox** turns what a renderer already has (G-buffers, shadow views, triangles) into voxel volumes on any GPU,
//! and lights scenes with them: real-time, dynamic, no ray-tracing hardware, no baking.
//!
//! ```text
//! G-buffer (camera), RSM (each light)                            the host renders these
//!    |
//!    +-- progressive::cleanup     cells that a depth image proves empty are cleared
//!    +-- progressive::injection   surface points become cells; light that leaves them is summed per light
//!    |   (or progressive::SinglePass in place of both: cheaper, coarser)
//!           |
//!           v
//!      VolumeBuffer (normal + occupancy, albedo, emission)  +  direct light (SH)
//!           |
//!           +-- light::transport      which faces of a cell let light out
//!           +-- light::seed           light that leaves surfaces, as flux
//!           +-- light::propagation    through empty cells, reflected at occupied ones, n times
//!           +-- light::reconstruction irradiance at every pixel of the G-buffer
//!                  |
//!                  v
//!             irradiance texture: the host multiplies by albedo / pi and adds it
//! ```
//!
//! A volume can be made of triangles too, from buffers that the host has already: see [`voxelize`].
//!
//! **Contract with a host.** Every stage records into the host's `CommandEncoder`. Nothing submits, waits, maps or
//! allocates inside a frame; pipelines are made beforehand. Results are textures and buffers. Everything runs on
//! [`Tier::Core`](gpu::Tier::Core): WebGPU with default limits.
//!
//! | paper | module |
//! | --- | --- |
//! | *Progressive Screen-Space Multichannel Surface Voxelization*, 6.2 and 6.3; dissertation chapter 7 | [`progressive`] |
//! | dissertation chapter 5: volume-based indirect light | [`light`] |
//! | *Cascaded Light Propagation Volumes*, 2010, and before: what chapter 5 is measured against | [`lpv`] |
//! | beyond the papers: indirect light along rays, all bounces, thin walls | [`gather`] |
//! | the same light for any other shader: surfaces, particles, fog | [`irradiance`] |
//! | dissertation chapter 4: visibility fields of rigid objects | [`visibility`] |
//! | *Two single-pass multichannel voxelizers*: the Volume Buffer | [`volume`] |
//! | the same; dissertation 5.5.1 and chapter 6: voxelization of triangles | [`voxelize`] |
//! | *Fast Scene Voxelization and Applications*, 2006: a bit for each cell of a column, and light behind leaves | [`slicemap`] |
//! | the same, 3.2: shadow volumes, culled and clamped | [`shadow_volumes`] |
//! | the same, 3.3: refraction and frosted glass | [`refraction`] |

// The macros of this crate name it from outside and from inside.
extern crate self as lumivox;

pub mod gather;
pub mod gpu;
pub mod irradiance;
pub mod light;
pub mod lpv;
pub mod progressive;
pub mod refraction;
pub mod shadow_volumes;
pub mod slicemap;
pub mod visibility;
pub mod volume;
pub mod voxelize;
pub mod wgsl;

pub use bytemuck;
pub use glam;
pub use lumivox_core as core;
pub use volume::VolumeBuffer;
pub use wgpu;

/// Every shader of this crate, for validation and for reading.
pub fn shaders() -> Vec<gpu::Shader> {
    [
        progressive::shaders(),
        light::shaders(),
        lpv::shaders(),
        gather::shaders(),
        irradiance::shaders(),
        visibility::shaders(),
        slicemap::shaders(),
        refraction::shaders(),
        shadow_volumes::shaders(),
    ]
    .concat()
}

/// The texts that [`voxelize`] and [`progressive::ProgressiveVoxelizer`] make of some sets of channels, for validation and for reading.
pub fn generated_texts() -> Vec<gpu::GeneratedText> {
    [voxelize::texts(), progressive::texts(), slicemap::texts(), refraction::texts(), shadow_volumes::texts()]
        .concat()
}

/// Every number that both Rust and WGSL spell out: its name in WGSL and its value in Rust.
pub fn shader_constants() -> Vec<(&'static str, f32)> {
    use lumivox_core::sh;
    let mut all = vec![
        ("SH_Y0", sh::Y0),
        ("SH_Y1", sh::Y1),
        ("SH_COS0", sh::COS0),
        ("SH_COS1", sh::COS1),
        ("SH_INTEGRAL", 1.0 / sh::Y0),
        ("COSINE_RATIO", sh::COS1 / sh::COS0),
        ("FACE_FLUX0", 1.0 / (6.0 * sh::Y0)),
        ("FACE_FLUX1", light::FACE_FLUX1),
        ("HALF_MAX", wgsl::HALF_MAX),
        ("LUMIVOX_MEAN", sh::Y0),
        ("LUMIVOX_COSINE_0", sh::COS0),
        ("LUMIVOX_COSINE_1", sh::COS1),
    ];
    all.extend(gather::CONSTANTS);
    all.extend(progressive::CONSTANTS);
    all
}

/// Every struct of this crate that has a twin in WGSL: name, size and fields.
pub fn gpu_structs() -> Vec<(&'static str, usize, &'static [gpu::Field])> {
    fn entry<T: gpu::GpuStruct>() -> (&'static str, usize, &'static [gpu::Field]) {
        (T::NAME, size_of::<T>(), T::FIELDS)
    }
    vec![
        entry::<wgsl::GridUniform>(),
        entry::<wgsl::ViewUniform>(),
        entry::<light::PropagationUniform>(),
        entry::<progressive::BrickUniform>(),
        entry::<progressive::StaticUniform>(),
        entry::<progressive::LumivoxCascade>(),
        entry::<voxelize::MeshUniform>(),
        entry::<voxelize::BatchUniform>(),
        entry::<voxelize::WindowUniform>(),
        entry::<gather::GatherUniform>(),
        entry::<irradiance::LatticeUniform>(),
        entry::<gather::GlossyUniform>(),
        entry::<irradiance::LumivoxIrradianceUniform>(),
        entry::<voxelize::VoxelLight>(),
        entry::<slicemap::SlicemapUniform>(),
        entry::<slicemap::TransmittanceUniform>(),
        entry::<refraction::GlassUniform>(),
        entry::<refraction::RefractionUniform>(),
        entry::<refraction::ThicknessUniform>(),
        entry::<refraction::PyramidUniform>(),
        entry::<shadow_volumes::VolumeUniform>(),
        entry::<shadow_volumes::PartUniform>(),
        entry::<shadow_volumes::MapUniform>(),
        entry::<shadow_volumes::QueriedUniform>(),
        entry::<visibility::FieldUniform>(),
        entry::<visibility::ObjectUniform>(),
        entry::<visibility::TileUniform>(),
        entry::<visibility::OcclusionUniform>(),
        entry::<visibility::QueryUniform>(),
        entry::<visibility::ShadowUniform>(),
        entry::<visibility::ReflectionUniform>(),
        entry::<visibility::HitLampUniform>(),
        entry::<visibility::HitLightUniform>(),
    ]
}
