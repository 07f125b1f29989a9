//! Passes whose text is put together at run time: what a host asks for decides which buffers they bind and what they
//! compute. Their layouts are made from the declarations in the text, so that pipelines which declare a group alike can
//! share its bind groups, whether they use all of it or not.

use super::program::Program;
use super::shader::bindings_of;
use super::{Bindings, Gpu, GpuError, ShaderBinding};

/// WGSL made at run time, with the name it goes by.
#[derive(Clone, Debug)]
pub struct GeneratedText {
    /// Path-like name.
    pub name: &'static str,
    /// The whole WGSL.
    pub source: String,
}

impl GeneratedText {
    /// What the text binds, as [`Shader::bindings`](super::Shader::bindings).
    pub fn bindings(&self) -> Vec<ShaderBinding> {
        bindings_of(&self.source)
    }
}

/// The layouts of all groups that a text declares, group 0 first, none for a group without bindings. What is only read can be seen by all stages, what is
/// written by compute and fragment stages.
///
/// # Errors
/// When the text binds something other than uniforms, storage buffers, sampled textures (not multisampled) and samplers.
pub fn bind_group_layouts(
    gpu: &Gpu,
    text: &GeneratedText,
) -> Result<Vec<Option<wgpu::BindGroupLayout>>, GpuError> {
    let bindings = text.bindings();
    let group_count = bindings.iter().map(|b| b.group + 1).max().unwrap_or(0);
    (0..group_count)
        .map(|group| {
            let in_group = bindings.iter().filter(|b| b.group == group);
            let entries = in_group.map(|b| entry(text.name, b)).collect::<Result<Vec<_>, _>>()?;
            if entries.is_empty() {
                return Ok(None);
            }
            let descriptor = wgpu::BindGroupLayoutDescriptor { label: Some(text.name), entries: &entries };
            validated(gpu, || gpu.device.create_bind_group_layout(&descriptor)).map(Some)
        })
        .collect()
}

fn entry(name: &'static str, binding: &ShaderBinding) -> Result<wgpu::BindGroupLayoutEntry, GpuError> {
    let ty = binding_type(binding).ok_or_else(|| GpuError::Binding {
        pass: name,
        reason: format!("cannot bind {}: {}", binding.name, binding.kind),
    })?;
    let visibility = if binding.writes {
        wgpu::ShaderStages::COMPUTE | wgpu::ShaderStages::FRAGMENT
    } else {
        wgpu::ShaderStages::COMPUTE | wgpu::ShaderStages::VERTEX_FRAGMENT
    };
    Ok(wgpu::BindGroupLayoutEntry { binding: binding.binding, visibility, ty, count: None })
}

fn binding_type(binding: &ShaderBinding) -> Option<wgpu::BindingType> {
    use wgpu::{BufferBindingType, SamplerBindingType, TextureSampleType, TextureViewDimension};
    let buffer = |ty| wgpu::BindingType::Buffer { ty, has_dynamic_offset: false, min_binding_size: None };
    if binding.space == "uniform" {
        return Some(buffer(BufferBindingType::Uniform));
    }
    if binding.space.starts_with("storage") {
        return Some(buffer(BufferBindingType::Storage { read_only: !binding.writes }));
    }
    match binding.kind.as_str() {
        "sampler" => return Some(wgpu::BindingType::Sampler(SamplerBindingType::Filtering)),
        "sampler_comparison" => return Some(wgpu::BindingType::Sampler(SamplerBindingType::Comparison)),
        _ => {}
    }
    let rest = binding.kind.strip_prefix("texture_")?;
    let (shape, sample_type) = match rest.strip_prefix("depth_") {
        Some(shape) => (shape, TextureSampleType::Depth),
        None => {
            let (shape, number) = rest.strip_suffix('>')?.split_once('<')?;
            let sample_type = match number {
                "f32" => TextureSampleType::Float { filterable: true },
                "u32" => TextureSampleType::Uint,
                "i32" => TextureSampleType::Sint,
                _ => return None,
            };
            (shape, sample_type)
        }
    };
    let view_dimension = match shape {
        "1d" => TextureViewDimension::D1,
        "2d" => TextureViewDimension::D2,
        "2d_array" => TextureViewDimension::D2Array,
        "3d" => TextureViewDimension::D3,
        "cube" => TextureViewDimension::Cube,
        "cube_array" => TextureViewDimension::CubeArray,
        _ => return None,
    };
    Some(wgpu::BindingType::Texture { sample_type, view_dimension, multisampled: false })
}

/// A compute pass made of a [`GeneratedText`] with the entry point `main`.
#[derive(Debug)]
pub struct GeneratedPass {
    /// The pipeline, for `set_pipeline`.
    pub pipeline: wgpu::ComputePipeline,
    program: Program,
}

impl GeneratedPass {
    /// Compiles the text.
    ///
    /// # Errors
    /// [`GpuError::Validation`] with the compiler's message when the text is no valid WGSL or exceeds a limit of the device.
    /// In a browser that is reported to the device instead.
    pub fn new(gpu: &Gpu, text: &GeneratedText) -> Result<Self, GpuError> {
        let layouts = bind_group_layouts(gpu, text)?;
        let pipeline = validated(gpu, || {
            let module = gpu.device.create_shader_module(wgpu::ShaderModuleDescriptor {
                label: Some(text.name),
                source: wgpu::ShaderSource::Wgsl(text.source.as_str().into()),
            });
            let groups: Vec<_> = layouts.iter().map(Option::as_ref).collect();
            let layout = gpu.device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
                label: Some(text.name),
                bind_group_layouts: &groups,
                immediate_size: 0,
            });
            gpu.device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
                label: Some(text.name),
                layout: Some(&layout),
                module: &module,
                entry_point: Some("main"),
                compilation_options: Default::default(),
                cache: None,
            })
        })?;
        Ok(Self { pipeline, program: Program::generated(gpu, text)? })
    }

    /// The bind group of these resources: made the first time, looked up from then on.
    pub fn bind(
        &self,
        gpu: &Gpu,
        group: usize,
        bindings: &Bindings<'_>,
    ) -> Result<wgpu::BindGroup, GpuError> {
        self.program.bind(gpu, group, bindings)
    }
}

/// A bind group of raw resources, counted.
pub(crate) fn made_bind_group(
    gpu: &Gpu,
    label: &'static str,
    layout: &wgpu::BindGroupLayout,
    entries: &[wgpu::BindGroupEntry<'_>],
) -> Result<wgpu::BindGroup, GpuError> {
    gpu.count_created();
    let descriptor = wgpu::BindGroupDescriptor { label: Some(label), layout, entries };
    validated(gpu, || gpu.device.create_bind_group(&descriptor))
}

/// Runs `make`, and returns what the device has to say against it.
pub(crate) fn validated<T>(gpu: &Gpu, make: impl FnOnce() -> T) -> Result<T, GpuError> {
    gpu.check()?;
    #[cfg(not(target_arch = "wasm32"))]
    {
        let scope = gpu.device.push_error_scope(wgpu::ErrorFilter::Validation);
        let made = make();
        match pollster::block_on(scope.pop()) {
            Some(error) => Err(GpuError::Validation(error.to_string())),
            None => Ok(made),
        }
    }
    #[cfg(target_arch = "wasm32")]
    Ok(make())
}
