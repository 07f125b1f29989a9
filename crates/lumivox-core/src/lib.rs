//! What every Lumivox crate agrees on, free of any GPU or file format: the [`Grid`] and its cells, [`Bounds`],
//! volumes in memory, rendered [`View`]s, borrowed [`TriangleView`]s, [`PackedField`]s, and [spherical harmonics](sh).
//!
//! Conventions: right-handed, Y up, metres, linear Rec. 709 colour, clip space with depth 0..1.
//! Matrices are named `target_from_source`.

pub mod bounds;
pub mod closed;
pub mod grid;
pub mod host_view;
pub mod packed_field;
pub mod sh;
pub mod triangles;
pub mod view;
pub mod volume;

pub use bounds::Bounds;
pub use closed::{Lids, lids, open_edges};
pub use grid::{Grid, GridError};
pub use host_view::{ClipDepth, LooksAlong, MatrixConventions, ViewError};
pub use packed_field::{PackedField, PackedMapping, PackedMaps, PackedStorage, hit_bias};
pub use triangles::TriangleView;
pub use view::{Projection, View};
pub use volume::HostVolume;
