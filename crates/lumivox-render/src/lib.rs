//! A compact deferred renderer that plays the host of [`lumivox`]: G-buffer, reflective shadow maps, direct light, composition
//! and debug views, on the same public interface as any other host.
//!
//! [`Renderer::frame`] is one frame on one page.
//!
//! | module | one line |
//! | --- | --- |
//! | [`gpu_scene`] | a scene's meshes and materials on the GPU |
//! | [`material_textures`] | their textures, filtered or looked up at a point |
//! | [`surface`] | rasterizes surfaces into G-buffers and reflective shadow maps |
//! | [`lights`] | a light's views, and what it sends where |
//! | [`shadow`] | depth from a light's view |
//! | [`direct`] | shadowed direct light, light by light |
//! | [`triangle_voxelizer`] | a volume from a scene's triangles, with sub-cells for gathered light |
//! | [`composite`] | direct + indirect + emission, or one layer alone |
//! | [`voxel_view`] | draws a volume's cells |
//! | [`lobes`] | draws the light in free space |
//! | [`tone`] | the tone curve of PNG output |
//! | [`renderer`] | the frame |
//!
//! **See-through surfaces.** `Blend` materials are drawn as masks with a cutoff of one half: glass lets light and view
//! pass unchanged, denser veils are solid. Indirect light of volumes from triangles goes through veils and masks by their mean opacity.

mod camera_slicemap;
pub mod composite;
pub mod direct;
pub mod gpu_scene;
pub mod lights;
pub mod lobes;
pub mod material_textures;
pub mod renderer;
pub mod shadow;
pub mod surface;
pub mod tone;
pub mod triangle_voxelizer;
mod voxel_meshes;
pub mod voxel_view;

pub use camera_slicemap::camera_slicemap;
pub use composite::Layer;
pub use renderer::{
    Caster, Environment, FrameStats, GiMethod, GlassIssue, GlassKind, GlassNote, GlassSettings,
    LeafShadowSettings, ObjectFields, Polish, Renderer, RendererError, Settings, VoxelSource,
};

/// Every shader of this crate, for validation and for reading.
pub fn shaders() -> Vec<lumivox::gpu::Shader> {
    vec![
        surface::GBUFFER_SHADER,
        surface::RSM_SHADER,
        shadow::OPAQUE_SHADER,
        shadow::MASKED_SHADER,
        direct::SHADER,
        composite::SHADER,
        voxel_view::SHADER,
        lobes::SHADER,
    ]
}

/// Every struct of this crate that has a twin in WGSL: name, size and fields.
pub fn gpu_structs() -> Vec<(&'static str, usize, &'static [lumivox::gpu::Field])> {
    fn entry<T: lumivox::gpu::GpuStruct>() -> (&'static str, usize, &'static [lumivox::gpu::Field]) {
        (T::NAME, size_of::<T>(), T::FIELDS)
    }
    vec![
        entry::<gpu_scene::MaterialUniform>(),
        entry::<lights::LightUniform>(),
        entry::<renderer::ShadowViewUniform>(),
        entry::<renderer::ShadowBatchUniform>(),
        entry::<composite::CompositeUniform>(),
        entry::<voxel_view::VoxelViewUniform>(),
    ]
}
