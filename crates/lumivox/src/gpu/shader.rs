//! Shader sources and the names of what they bind.
//!
//! A shader is plain WGSL: the shared modules it uses ([`crate::wgsl`]: pure functions and structs, no bindings) followed
//! by its own file, which stands beside the Rust file of the same stem. All parts are compiled in. The joined text is
//! valid WGSL as it is: a host or a browser needs no tool of ours to read it. Line numbers in messages count through
//! the joined text, which [`Shader::source`] gives.

/// A named shader.
#[derive(Clone, Copy, Debug)]
pub struct Shader {
    /// Path-like name, for example `progressive/cleanup`.
    pub name: &'static str,
    /// The texts it is joined from, its own file last.
    pub parts: &'static [&'static str],
}

/// A resource that a shader declares.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ShaderBinding {
    /// `@group`.
    pub group: u32,
    /// `@binding`.
    pub binding: u32,
    /// Name of the variable.
    pub name: String,
    /// Its type, as written.
    pub kind: String,
    /// Its address space and access, as written between `<` and `>`; empty for textures and samplers.
    pub space: String,
    /// Whether the shader may write it.
    pub writes: bool,
}

impl Shader {
    /// The joined WGSL.
    pub fn source(&self) -> String {
        self.parts.join("\n")
    }

    /// What the shader binds, read from its declarations. Each stands on one line, in the form
    /// `@group(G) @binding(B) var<..> name: type;`; a test compares the result with naga's reading of the same text.
    pub fn bindings(&self) -> Vec<ShaderBinding> {
        self.parts.iter().flat_map(|part| bindings_of(part)).collect()
    }
}

/// What a text binds; see [`Shader::bindings`].
pub(super) fn bindings_of(source: &str) -> Vec<ShaderBinding> {
    source.lines().filter_map(parse_binding).collect()
}

/// A text of group 0 with its bindings in `group` from `first` on, in the order they stand.
pub(crate) fn renumbered(source: &str, group: u32, first: u32) -> String {
    // In one go from front to back, so that no new number is taken for an old one.
    let mut pieces = source.split("@group(0) @binding(");
    let mut text = pieces.next().unwrap_or_default().to_owned();
    for (piece, binding) in pieces.zip(first..) {
        let rest = piece.split_once(')').map_or(piece, |(_, rest)| rest);
        text += &format!("@group({group}) @binding({binding}){rest}");
    }
    text
}

fn parse_binding(line: &str) -> Option<ShaderBinding> {
    let rest = line.trim().strip_prefix("@group(")?;
    let (group, rest) = rest.split_once(") @binding(")?;
    let (binding, rest) = rest.split_once(") var")?;
    let (space, rest) = match rest.strip_prefix('<') {
        Some(rest) => rest.split_once('>')?,
        None => ("", rest),
    };
    let (name, kind) = rest.split_once(':')?;
    let writes = space.contains("read_write") || kind.trim_start().starts_with("texture_storage");
    Some(ShaderBinding {
        group: group.trim().parse().ok()?,
        binding: binding.trim().parse().ok()?,
        name: name.trim().to_owned(),
        kind: kind.trim().trim_end_matches(';').to_owned(),
        space: space.to_owned(),
        writes,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reads_names_numbers_and_access() {
        let shader = Shader {
            name: "test",
            parts: &["@group(0) @binding(2) var<storage, read_write> cells_out: array<vec2u>;\n\
                     // @group(0) @binding(9) var nothing: texture_2d<f32>;\n\
                     @group(1) @binding(0) var depth: texture_depth_2d;\n\
                     @group(0) @binding(3) var<uniform> grid: Grid;"],
        };
        let bindings = shader.bindings();
        assert_eq!(bindings.len(), 3);
        let first = ShaderBinding {
            group: 0,
            binding: 2,
            name: "cells_out".to_owned(),
            kind: "array<vec2u>".to_owned(),
            space: "storage, read_write".to_owned(),
            writes: true,
        };
        assert_eq!(bindings[0], first);
        assert_eq!((bindings[1].group, bindings[1].name.as_str()), (1, "depth"));
        assert_eq!((bindings[1].kind.as_str(), bindings[1].space.as_str()), ("texture_depth_2d", ""));
        assert!(!bindings[2].writes);
    }
}
