// A direction as two numbers in -1..1: the sphere folded onto an octahedron, and that unfolded into a square.

fn fold(v: vec2f) -> vec2f {
    return (1.0 - abs(v.yx)) * select(vec2f(-1.0), vec2f(1.0), v >= vec2f(0.0));
}

fn octahedron_from_direction(n: vec3f) -> vec2f {
    let p = n.xy / (abs(n.x) + abs(n.y) + abs(n.z));
    return select(fold(p), p, n.z >= 0.0);
}

fn direction_from_octahedron(p: vec2f) -> vec3f {
    let z = 1.0 - abs(p.x) - abs(p.y);
    return normalize(vec3f(select(fold(p), p, z >= 0.0), z));
}
