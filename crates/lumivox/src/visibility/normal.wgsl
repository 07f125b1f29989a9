// The normal of a hit, after the look-ups in fields and the part for octahedra. The shader that uses this binds
// `field_normals`.

// The world normal at a hit, facing the ray that came along `direction`; that itself, turned round, without normals.
fn hit_normal(object: ObjectUniform, hit: Ahead, direction: vec3f) -> vec3f {
    let field = fields[object.field];
    if field.has_normals == 0u {
        return -normalize(direction);
    }
    let point = nearest_point(field, hit.point);
    let local = local_from_unit(field_points[field.first_point + point].xyz, hit.direction);
    let size = vec2u(field.side);
    let at =
        placed(field.normals_origin, field.normals_columns, field.normals_rows, point, size, texel_of(field, local));
    let steps = vec2f(textureLoad(field_normals, at, 0).rg);
    let normal = direction_from_octahedron(steps / 127.0);
    let world = normalize((object.world_from_normal * vec4f(normal, 0.0)).xyz);
    return select(world, -world, dot(world, direction) > 0.0);
}
