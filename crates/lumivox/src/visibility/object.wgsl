// A rigid object, or a part of one, in the world.

struct ObjectUniform {
    // From the world to where the bounding sphere is the unit sphere, and normals back.
    unit_from_world: mat4x4f,
    world_from_normal: mat4x4f,
    // A sphere around the bounding sphere, in the world.
    center: vec3f,
    radius: f32,
    // Radiance that the surface reflects of unit irradiance, times pi: its albedo.
    albedo: vec3f,
    field: u32,
    // Parts of one object have one number and follow each other.
    caster: u32,
    // How far a hit must lie ahead, in radii, of rays that start within the sphere.
    bias: f32,
    reserved_0: u32,
    reserved_1: u32,
}
