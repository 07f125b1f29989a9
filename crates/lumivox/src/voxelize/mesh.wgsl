// Group 1: one mesh over the host's buffers, all read as words.

struct MeshUniform {
    world_from_local: mat4x4f,
    normal_x: vec3f,
    side: f32,
    normal_y: vec3f,
    alpha_cutoff: f32,
    normal_z: vec3f,
    flags: u32,
    base_color: vec4f,
    emission: vec3f,
    number: u32,
    // Vertices, triangles, bits of an index (0 for none), first index.
    counts: vec4u,
    // Of each attribute: first word, words from one to the next, format code.
    positions: vec4u,
    normals: vec4u,
    uvs: vec4u,
    colors: vec4u,
}

struct BatchUniform {
    first: u32,
    count: u32,
}

@group(1) @binding(0) var<uniform> mesh: MeshUniform;
@group(1) @binding(1) var<uniform> batch: BatchUniform;
@group(1) @binding(2) var<storage, read> mesh_positions: array<u32>;
@group(1) @binding(3) var<storage, read> mesh_indices: array<u32>;
@group(1) @binding(4) var<storage, read> mesh_normals: array<u32>;
@group(1) @binding(5) var<storage, read> mesh_uvs: array<u32>;
@group(1) @binding(6) var<storage, read> mesh_colors: array<u32>;
@group(1) @binding(7) var base_color_texture: texture_2d<f32>;
@group(1) @binding(8) var emission_texture: texture_2d<f32>;
@group(1) @binding(9) var material_sampler: sampler;

fn lv_mesh_has(flag: u32) -> bool {
    return (mesh.flags & flag) != 0u;
}

// Words that a format takes.
fn lv_format_words(code: u32) -> u32 {
    if code <= 4u {
        return code;
    }
    return select(1u, 2u, code == 6u || code == 8u || code == 10u);
}

fn lv_decode(code: u32, words: vec4u) -> vec4f {
    let f = bitcast<vec4f>(words);
    switch code {
        case 2u: { return vec4f(f.xy, 0.0, 1.0); }
        case 3u: { return vec4f(f.xyz, 1.0); }
        case 4u: { return f; }
        case 5u: { return vec4f(unpack2x16float(words.x), 0.0, 1.0); }
        case 6u: { return vec4f(unpack2x16float(words.x), unpack2x16float(words.y)); }
        case 7u: { return vec4f(unpack2x16unorm(words.x), 0.0, 1.0); }
        case 8u: { return vec4f(unpack2x16unorm(words.x), unpack2x16unorm(words.y)); }
        case 9u: { return vec4f(unpack2x16snorm(words.x), 0.0, 1.0); }
        case 10u: { return vec4f(unpack2x16snorm(words.x), unpack2x16snorm(words.y)); }
        case 11u: { return unpack4x8unorm(words.x); }
        default: { return unpack4x8snorm(words.x); }
    }
}

fn lv_index(at: u32) -> u32 {
    let bits = mesh.counts.z;
    if bits == 0u {
        return at;
    }
    let index = mesh.counts.w + at;
    if bits == 32u {
        return mesh_indices[index];
    }
    return (mesh_indices[index / 2u] >> (16u * (index % 2u))) & 0xffffu;
}

fn lv_local_position(vertex: u32) -> vec3f {
    let at = mesh.positions.x + vertex * mesh.positions.y;
    let code = mesh.positions.z;
    var words = vec4u(mesh_positions[at], 0u, 0u, 0u);
    if code != 11u && code != 12u {
        words.y = mesh_positions[at + 1u];
    }
    if code == 3u || code == 4u {
        words.z = mesh_positions[at + 2u];
        return bitcast<vec3f>(words.xyz);
    }
    return lv_decode(code, words).xyz;
}

fn lv_local_normal(vertex: u32) -> vec3f {
    let at = mesh.normals.x + vertex * mesh.normals.y;
    let count = lv_format_words(mesh.normals.z);
    var words = vec4u(mesh_normals[at], 0u, 0u, 0u);
    if count > 1u { words.y = mesh_normals[at + 1u]; }
    if count > 2u { words.z = mesh_normals[at + 2u]; }
    return lv_decode(mesh.normals.z, words).xyz;
}

fn lv_uv(vertex: u32) -> vec2f {
    let at = mesh.uvs.x + vertex * mesh.uvs.y;
    var words = vec4u(mesh_uvs[at], 0u, 0u, 0u);
    if lv_format_words(mesh.uvs.z) > 1u { words.y = mesh_uvs[at + 1u]; }
    return lv_decode(mesh.uvs.z, words).xy;
}

fn lv_color(vertex: u32) -> vec4f {
    let at = mesh.colors.x + vertex * mesh.colors.y;
    let count = lv_format_words(mesh.colors.z);
    var words = vec4u(mesh_colors[at], 0u, 0u, 0u);
    if count > 1u { words.y = mesh_colors[at + 1u]; }
    if count > 2u { words.z = mesh_colors[at + 2u]; }
    if count > 3u { words.w = mesh_colors[at + 3u]; }
    return lv_decode(mesh.colors.z, words);
}
