//! The WGSL of a dense volume: what reads and writes its cells is made of the storage and of the number of channels.

use std::fmt::Write;
use std::ops::Range;

use crate::gpu::GeneratedText;
use crate::progressive::CleanupRule;
use crate::progressive::channel::{self, ADD, AttributeChannel, MEAN};
use crate::progressive::cleanup::{CENTER, FOOTPRINT};
use crate::wgsl::{GRID, PACK, POINT, VIEW, VISIBILITY};

use super::Storage;

/// Channels that one pass writes: a stage of core WebGPU has four storage textures.
const PART: usize = 4;
/// How cells that are written are called, and those that textures are read from.
pub(super) const CELLS: [&str; PART] = ["cells_0", "cells_1", "cells_2", "cells_3"];
pub(super) const CELLS_IN: [&str; PART] = ["cells_in_0", "cells_in_1", "cells_in_2", "cells_in_3"];

/// The channels of each pass. The first channel is in the last of them: it says which cells are occupied, and the others ask it before
/// it is cleared.
pub(super) fn parts(channels: usize) -> impl Iterator<Item = Range<usize>> {
    (0..channels).step_by(PART).map(move |first| first..channels.min(first + PART)).rev()
}

/// The cells that a pass writes.
fn outputs(storage: Storage, count: usize) -> String {
    let mut text = String::new();
    for (n, name) in CELLS[..count].iter().enumerate() {
        let at = 4 + n;
        let _ = match storage {
            Storage::Buffers => {
                writeln!(text, "@group(0) @binding({at}) var<storage, read_write> {name}: array<vec2u>;")
            }
            Storage::Textures => {
                writeln!(text, "@group(0) @binding({at}) var {name}: texture_storage_3d<rgba16float, write>;")
            }
        };
    }
    text
}

/// The statement that stores a value of four numbers in the `n`-th cell of a part.
fn store(storage: Storage, n: usize, value: &str) -> String {
    match storage {
        Storage::Buffers => format!("{}[cell_index(grid, cell)] = pack_half4({value});", CELLS[n]),
        // Rounded here: how the device would round is not said.
        Storage::Textures => {
            format!("textureStore({}, cell, unpack_half4(pack_half4({value})));", CELLS[n])
        }
    }
}

/// Cleanup of a part of the channels.
pub(super) fn clean(storage: Storage, part: Range<usize>, rule: CleanupRule) -> GeneratedText {
    let mut text = outputs(storage, part.len());
    let mut body = String::new();
    let is_first = part.start == 0;
    let (mut asked, kind) = match storage {
        Storage::Buffers => ("cells_0[cell_index(grid, cell)]", "var<storage, read> occupied: array<vec2u>"),
        Storage::Textures => ("cells_in_0", "var occupied: texture_3d<f32>"),
    };
    if !is_first {
        let _ = writeln!(text, "@group(0) @binding(13) {kind};");
        asked = if storage == Storage::Buffers { "occupied[cell_index(grid, cell)]" } else { "occupied" };
    }
    let occupancy = match storage {
        Storage::Buffers => format!("unpack_half4({asked}).w"),
        Storage::Textures => format!("textureLoad({asked}, cell, 0).w"),
    };
    for n in 0..part.len() {
        let _ = match storage {
            Storage::Buffers => {
                writeln!(body, "    if cleared {{ {} }}", store(storage, n, "vec4f(0.0)"))
            }
            Storage::Textures => {
                let name = CELLS_IN[n];
                let _ = writeln!(text, "@group(0) @binding({}) var {name}: texture_3d<f32>;", 8 + n);
                let kept = format!("select(textureLoad({name}, cell, 0), vec4f(0.0), cleared)");
                writeln!(body, "    textureStore({}, cell, {kept});", CELLS[n])
            }
        };
    }
    let _ = writeln!(text, "\nfn is_occupied(cell: vec3u) -> bool {{\n    return {occupancy} > 0.0;\n}}");
    let _ = writeln!(text, "\nfn finish(cell: vec3u, cleared: bool) {{\n{body}}}");
    let rule = if rule == CleanupRule::Center { [VISIBILITY, CENTER] } else { ["", FOOTPRINT] };
    let parts = [GRID, VIEW, PACK, rule[0], rule[1], include_str!("clean.wgsl"), &text];
    GeneratedText { name: "dense/clean", source: parts.join("\n") }
}

/// Injection of points.
pub(super) fn add(channels: &[AttributeChannel]) -> GeneratedText {
    let (sizes, pictures) = (channel::sizes_text(channels), channel::pictures_text(channels));
    let parts = [GRID, VIEW, POINT, &sizes, ADD, include_str!("add.wgsl"), &pictures];
    GeneratedText { name: "dense/add", source: parts.join("\n") }
}

/// Sums to means, of a part of the channels.
pub(super) fn resolve(channels: &[AttributeChannel], storage: Storage, part: Range<usize>) -> GeneratedText {
    let mut text = outputs(storage, part.len());
    let _ = writeln!(text, "\nfn store_means(cell: vec3u, at: u32, count: f32) {{");
    for n in 0..part.len() {
        let channel = part.start + n;
        let mean = format!("mean(at + {}u, count, channel_largest({channel}u))", 4 * channel);
        let _ = writeln!(text, "    {}", store(storage, n, &mean));
    }
    text += "}\n";
    let sizes = channel::sizes_text(channels);
    let parts = [GRID, VIEW, PACK, &sizes, MEAN, include_str!("resolve.wgsl"), &text];
    GeneratedText { name: "dense/resolve", source: parts.join("\n") }
}
