//! Rust structs that have a twin in WGSL, and the table that a test holds them together with.

/// One field of a [`GpuStruct`]: name, offset in bytes, size in bytes.
pub type Field = (&'static str, usize, usize);

/// A plain struct with the same name, fields and offsets in WGSL. Declared with `gpu_struct!`; the shader test
/// compares every one with naga's view of the WGSL struct of the same name.
pub trait GpuStruct: bytemuck::Pod {
    /// Name in Rust and in WGSL.
    const NAME: &'static str;
    /// All fields in order.
    const FIELDS: &'static [Field];
}

/// Declares a `repr(C)` struct that is [`GpuStruct`] and [`bytemuck::Pod`]. Padding is written out as fields, so the
/// bytes are all initialised.
#[macro_export]
macro_rules! gpu_struct {
    ($(#[$meta:meta])* pub struct $name:ident { $($(#[$field_meta:meta])* pub $field:ident: $type:ty,)* }) => {
        $(#[$meta])*
        #[repr(C)]
        #[derive(Clone, Copy, Debug, PartialEq, $crate::bytemuck::Pod, $crate::bytemuck::Zeroable)]
        #[bytemuck(crate = "::lumivox::bytemuck")]
        pub struct $name { $($(#[$field_meta])* pub $field: $type,)* }

        impl $crate::gpu::GpuStruct for $name {
            const NAME: &'static str = stringify!($name);
            const FIELDS: &'static [$crate::gpu::Field] =
                &[$((stringify!($field), std::mem::offset_of!($name, $field), size_of::<$type>())),*];
        }
    };
}
