//! Binding by name: a pass says `&` for what it reads and `&mut` for what it writes.

use std::collections::HashMap;
use std::sync::{Mutex, PoisonError};

use super::{
    Buffer, GeneratedText, Gpu, GpuError, Sampler, Shader, ShaderBinding, Texture, Uniform,
    bind_group_layouts,
};

/// More than the 8 storage buffers, 4 storage and 16 sampled textures of one core stage are never bound at once here.
const MAX_BINDINGS: usize = 16;
/// Bind groups kept per group of a program; beyond that all are forgotten at once. A frame alternates between a few ping-pong
/// states and up to some thousand views: 64 point lights have 384, an area light of 256 samples 1280.
const CACHE_SIZE: usize = 8192;

/// Something that can be bound.
#[derive(Clone, Copy, Debug)]
pub enum Resource<'a> {
    /// A buffer, or the window of it that it stands for.
    Buffer(&'a Buffer),
    /// A whole texture.
    Texture(&'a Texture),
    /// A sampler.
    Sampler(&'a Sampler),
}

impl Resource<'_> {
    fn id(&self) -> u64 {
        match self {
            Self::Buffer(b) => b.id,
            Self::Texture(t) => t.id,
            Self::Sampler(s) => s.id,
        }
    }

    fn raw(&self) -> wgpu::BindingResource<'_> {
        match self {
            Self::Buffer(b) => b.binding(),
            Self::Texture(t) => wgpu::BindingResource::TextureView(&t.view),
            Self::Sampler(s) => wgpu::BindingResource::Sampler(&s.raw),
        }
    }
}

impl<'a> From<&'a Buffer> for Resource<'a> {
    fn from(buffer: &'a Buffer) -> Self {
        Self::Buffer(buffer)
    }
}

impl<'a, T> From<&'a Uniform<T>> for Resource<'a> {
    fn from(uniform: &'a Uniform<T>) -> Self {
        Self::Buffer(&uniform.buffer)
    }
}

impl<'a> From<&'a Texture> for Resource<'a> {
    fn from(texture: &'a Texture) -> Self {
        Self::Texture(texture)
    }
}

impl<'a> From<&'a Sampler> for Resource<'a> {
    fn from(sampler: &'a Sampler) -> Self {
        Self::Sampler(sampler)
    }
}

/// What one recorded pass reads and writes, by the names in its shader.
#[derive(Debug, Default)]
pub struct Bindings<'a> {
    entries: [Option<(&'static str, Resource<'a>, bool)>; MAX_BINDINGS],
    count: usize,
}

impl<'a> Bindings<'a> {
    /// Nothing bound yet.
    pub fn new() -> Self {
        Self::default()
    }

    /// Binds what the pass only reads.
    #[must_use]
    pub fn read(self, name: &'static str, resource: impl Into<Resource<'a>>) -> Self {
        self.push(name, resource.into(), false)
    }

    /// Binds a buffer that the pass writes.
    #[must_use]
    pub fn write(self, name: &'static str, buffer: &'a mut Buffer) -> Self {
        self.push(name, Resource::Buffer(buffer), true)
    }

    /// Binds a storage texture that the pass writes.
    #[must_use]
    pub fn write_texture(self, name: &'static str, texture: &'a mut Texture) -> Self {
        self.push(name, Resource::Texture(texture), true)
    }

    fn push(mut self, name: &'static str, resource: Resource<'a>, writes: bool) -> Self {
        // One too many is counted and refused in `resolve`, with the pass's name.
        if let Some(slot) = self.entries.get_mut(self.count) {
            *slot = Some((name, resource, writes));
        }
        self.count += 1;
        self
    }

    fn find(&self, name: &str) -> Option<(&Resource<'a>, bool)> {
        self.entries
            .iter()
            .flatten()
            .find(|(n, ..)| *n == name)
            .map(|(_, resource, writes)| (resource, *writes))
    }
}

/// The names, layouts and kept bind groups of a pipeline; the part that compute and render passes share.
#[derive(Debug)]
pub struct Program {
    name: &'static str,
    groups: Vec<Group>,
}

#[derive(Debug)]
struct Group {
    bindings: Vec<ShaderBinding>,
    layout: wgpu::BindGroupLayout,
    kept: Mutex<HashMap<[u64; MAX_BINDINGS], wgpu::BindGroup>>,
}

impl Program {
    /// Reads the names from `shader`; `layout` gives the pipeline's layout of a group.
    pub fn new(shader: &Shader, layout: impl Fn(u32) -> wgpu::BindGroupLayout) -> Self {
        Self::with_bindings(shader.name, shader.bindings(), layout)
    }

    /// As [`Self::new`], of a text made at run time.
    pub(crate) fn of_text(text: &GeneratedText, layout: impl Fn(u32) -> wgpu::BindGroupLayout) -> Self {
        Self::with_bindings(text.name, text.bindings(), layout)
    }

    /// The program of a text made at run time. Groups without bindings have an empty layout.
    pub fn generated(gpu: &Gpu, text: &GeneratedText) -> Result<Self, GpuError> {
        let layouts = bind_group_layouts(gpu, text)?;
        let empty = wgpu::BindGroupLayoutDescriptor { label: Some("empty"), entries: &[] };
        let layout = |n: u32| {
            let made = layouts.get(n as usize).and_then(Option::clone);
            made.unwrap_or_else(|| gpu.device.create_bind_group_layout(&empty))
        };
        Ok(Self::with_bindings(text.name, text.bindings(), layout))
    }

    fn with_bindings(
        name: &'static str,
        bindings: Vec<ShaderBinding>,
        layout: impl Fn(u32) -> wgpu::BindGroupLayout,
    ) -> Self {
        let group_count = bindings.iter().map(|b| b.group + 1).max().unwrap_or(0);
        let groups = (0..group_count).map(|g| Group {
            bindings: bindings.iter().filter(|b| b.group == g).cloned().collect(),
            layout: layout(g),
            kept: Mutex::default(),
        });
        Self { name, groups: groups.collect() }
    }

    /// The bind group of these resources: made the first time, looked up from then on.
    pub fn bind(
        &self,
        gpu: &Gpu,
        group: usize,
        bindings: &Bindings<'_>,
    ) -> Result<wgpu::BindGroup, GpuError> {
        let Some(group) = self.groups.get(group) else {
            return Err(self.error(format!("has no bind group {group}")));
        };
        let resources = self.resolve(group, bindings)?;
        let key: [u64; MAX_BINDINGS] =
            std::array::from_fn(|i| resources[i].as_ref().map_or(u64::MAX, Resource::id));
        let mut kept = group.kept.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(found) = kept.get(&key) {
            return Ok(found.clone());
        }
        let entries: Vec<_> = group
            .bindings
            .iter()
            .zip(resources.iter().flatten())
            .map(|(b, r)| wgpu::BindGroupEntry { binding: b.binding, resource: r.raw() })
            .collect();
        let made = gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some(self.name),
            layout: &group.layout,
            entries: &entries,
        });
        gpu.count_created();
        if kept.len() == CACHE_SIZE {
            kept.clear();
        }
        kept.insert(key, made.clone());
        Ok(made)
    }

    /// The resources in the order of the shader's declarations.
    fn resolve<'b>(
        &self,
        group: &Group,
        bindings: &'b Bindings<'b>,
    ) -> Result<[Option<Resource<'b>>; MAX_BINDINGS], GpuError> {
        if bindings.count != group.bindings.len() || bindings.count > MAX_BINDINGS {
            let names: Vec<_> = group.bindings.iter().map(|b| b.name.as_str()).collect();
            let reason = format!("was given {} resources; it binds {}", bindings.count, names.join(", "));
            return Err(self.error(reason));
        }
        let mut resources = [None; MAX_BINDINGS];
        for (slot, wanted) in resources.iter_mut().zip(&group.bindings) {
            let (resource, writes) = bindings
                .find(&wanted.name)
                .ok_or_else(|| self.error(format!("was not given {}", wanted.name)))?;
            if writes != wanted.writes {
                let verb = if wanted.writes { "writes" } else { "only reads" };
                return Err(self.error(format!("{verb} {}, bind it so", wanted.name)));
            }
            *slot = Some(*resource);
        }
        Ok(resources)
    }

    fn error(&self, reason: String) -> GpuError {
        GpuError::Binding { pass: self.name, reason }
    }
}
