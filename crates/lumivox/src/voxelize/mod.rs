//! Voxelization of triangles: any soup of meshes whose buffers are on the GPU already, to a volume of any channels.
//!
//! Sources: *Two simple single-pass GPU methods for multi-channel surface voxelization of dynamic scenes* (2011);
//! dissertation 5.5.1 and chapter 6.
//!
//! ```text
//! Mesh (views of the host's buffers)
//!    |
//!    +-- method (one of several)         which cells a triangle marks
//!    |      +-- surface                  the piece of the triangle in the cell, and what the mesh says there
//!    |      +-- channels                 built in, or WGSL functions of the host's
//!    v
//! sums (integers, by rule)  <-- merge -- layers: sums of what stands still, kept over frames
//!    |
//!    +-- resolve                         means, maxima; packed in the channel's format
//!    v
//! VolumeBuffer
//! ```
//!
//! A [`Voxelizer`] is made for a grid, [`Channel`]s and [`Options`]; [`Voxelizer::record`] then turns meshes into cells
//! whenever it is asked. Nothing depends on the order of triangles or on how they are spread over meshes, since sums
//! are integers.
//!
//! | [`Method`] | what a triangle costs | cells | when |
//! | --- | --- | --- | --- |
//! | [`direct`] | its cells, tested in compute shaders | exact, thin or sampled | always, unless there is a reason |
//! | [`clipping`] | a copy for each slice that it meets | sampled | many triangles of a few cells, on devices that rasterize faster than they compute |
//! | [`slicing`] | a strip for each slice that it meets | sampled | the same for large triangles |
//! | [`slice_per_pass`] | to be looked at once for each slice of the grid, three times | sampled along each axis | for comparison |
//! | [`slicemap`] | one copy for each direction | sampled along one axis or each | occupancy alone, gaps allowed |
//!
//! **Windows.** The sums of a cell take up to eight bytes a number, and a binding of core WebGPU holds 128 MiB. Grids whose sums
//! are larger are done in windows of cells, one pass over the triangles each, with the same result. Grids whose cells are too many for
//! one binding are done in slabs of layers, one recording each ([`Voxelizer::for_slabs`]).
//!
//! **Limits.** Arithmetic is in single precision: cells are those of exact arithmetic as long as no corner of a triangle
//! lies more than some 500 cells away; one at 10,000 cells moves edges by up to a thousandth of a cell. A mesh that is turned or scaled is as
//! precise as its coordinates in the world are. An average counts up to 2^28 cell faces of surface in one cell.

pub mod clipping;
pub mod direct;
pub mod slice_per_pass;
pub mod slicemap;
pub mod slicing;

mod channel;
mod error;
mod interleaved;
mod layer;
mod lights;
mod mesh;
mod method;
mod raster;
mod text;
mod views;
mod voxelizer;

use crate::gpu::GeneratedText;
use crate::volume::Format;

pub(crate) use raster::{UNWRITTEN, writing_pipeline};
pub(crate) use text::{mesh_layout, mesh_text};

pub use channel::{Channel, Rule, SurfaceFunction};
pub use error::VoxelizeError;
pub use interleaved::Interleaved;
pub use layer::{Layer, WindowUniform};
pub use lights::{LightChannels, MAX_VOXEL_LIGHTS, VoxelLight, VoxelLights};
pub use mesh::{BATCH_TRIANGLES, BatchUniform, Material, Mesh, MeshDescriptor, MeshUniform};
pub use method::{Coverage, Directions, Method, Options, SeeThrough};
pub use views::{IndexView, VertexView};
pub use voxelizer::Voxelizer;

/// The most that all channels of a cell may take: the papers' eight targets of four floats.
pub const MAX_CELL_BITS: u64 = 1024;

/// The texts of some channels and all coverages, for validation and for reading.
pub(crate) fn texts() -> Vec<GeneratedText> {
    use text::{Layout, Phase};
    let plain = [Channel::normal(), Channel::albedo(), Channel::emission()];
    let mixed = [
        Channel::area(),
        Channel::normal().unit(true).format(Format::F32).rule(Rule::Nearest).named("nearest"),
        Channel::albedo().format(Format::U8).rule(Rule::Maximum).named("largest"),
        Channel::emission().format(Format::F16).rule(Rule::Sum).named("sum"),
    ];
    let light = [lights::any_channel()];
    let mut texts = Vec::new();
    let veiled = plain.clone().map(|c| c.fitted(1.0, SeeThrough::Opacity));
    let kinds = [
        (&[][..], SeeThrough::Dithered),
        (&plain, SeeThrough::Cut),
        (&veiled, SeeThrough::Opacity),
        (&mixed, SeeThrough::Cut),
        (&light, SeeThrough::Cut),
    ];
    for (channels, see_through) in kinds {
        let layout = Layout::new(channels);
        for coverage in [Coverage::Exact, Coverage::Thin, Coverage::Sampled] {
            for phase in [Phase::Sums, Phase::Nearest] {
                let options = Options { coverage, see_through, ..Options::default() };
                for is_plain in [false, true] {
                    texts.extend(direct::texts(&layout, &options, phase, (16, is_plain)));
                }
            }
        }
        for phase in [Phase::Sums, Phase::Nearest] {
            let options = Options { see_through, ..Options::default() };
            for is_plain in [false, true] {
                let geometries = [slicing::geometry(None), clipping::geometry(Some(9))];
                texts.extend(
                    geometries.iter().flat_map(|g| raster::texts(&layout, &options, phase, is_plain, g)),
                );
                texts.push(slice_per_pass::text(&layout, &options, phase, is_plain));
                texts.push(slicemap::text(&layout, &options, phase, is_plain));
            }
        }
        texts.extend(
            (0..channels.len().div_ceil(text::RESOLVE_OUTPUTS)).map(|part| text::resolve_text(&layout, part)),
        );
        texts.push(text::merge_text(&layout));
    }
    texts
}
