//! The small layer between Lumivox and wgpu: a device with its [`Tier`], passes that bind resources by name, buffers
//! and textures with an identity, readback and per-stage timing.
//!
//! Nothing here submits, waits or allocates while a frame is recorded. Bind groups are made the first time a pass
//! meets a set of resources and kept; from then on recording only looks them up.

mod buffer;
mod context;
mod error;
mod generated;
mod layout;
mod pass;
mod program;
mod readback;
mod ring;
mod shader;
mod stamps;
mod texture;
mod timing;

pub use buffer::{Buffer, Uniform};
pub use context::{AdapterChoice, Gpu, Tier};
pub use error::GpuError;
pub use generated::{GeneratedPass, GeneratedText, bind_group_layouts};
pub(crate) use generated::{made_bind_group, validated};
pub use layout::{Field, GpuStruct};
pub(crate) use pass::shader_module;
pub use pass::{ComputePass, FullscreenPass};
pub use program::{Bindings, Program, Resource};
pub use readback::{read_buffer, read_texture};
pub(crate) use ring::ReadbackRing;
pub(crate) use shader::renumbered;
pub use shader::{Shader, ShaderBinding};
pub(crate) use stamps::{STAMP_BYTES, Stamps};
pub use texture::{Sampler, Texture, TextureOptions};
pub use timing::{StageTime, StageTimer};
