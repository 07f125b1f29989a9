// Points of an irradiance volume, one per invocation.

struct LatticeUniform {
    // Points along x, y, z, and cells between them.
    dims: vec3u,
    spacing: u32,
    // The first point that is asked, and how many.
    first: u32,
    count: u32,
    // Rays of a point.
    rays: u32,
    reserved: u32,
}

// Place of a point among its dims.
fn lattice_point(dims: vec3u, index: u32) -> vec3u {
    let rows = index / dims.x;
    return vec3u(index % dims.x, rows % dims.y, rows / dims.y);
}
