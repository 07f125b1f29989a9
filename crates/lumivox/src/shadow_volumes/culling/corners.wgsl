// The corners of a triangle. The shader that uses this binds `vertices` and `triangles`.

fn corners_of(triangle: vec4u) -> array<vec3f, 3> {
    return array<vec3f, 3>(vertices[triangle.x].xyz, vertices[triangle.y].xyz, vertices[triangle.z].xyz);
}
