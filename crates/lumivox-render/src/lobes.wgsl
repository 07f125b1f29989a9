// A ball at each point of a lattice, one pixel per invocation.

@group(0) @binding(5) var<uniform> view: ViewUniform;
@group(0) @binding(6) var depth: texture_depth_2d;
@group(0) @binding(7) var radiance: texture_2d<f32>;

const PI: f32 = 3.1415927;
// Radius of a ball in spacings.
const RADIUS: f32 = 0.18;
// Surfaces behind the balls.
const DIMMED: f32 = 0.35;

@fragment
fn fragment(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let texel = vec2u(position.xy);
    let pixel_depth = textureLoad(depth, texel, 0);
    let eye = world_from_texel(view, texel, 1.0 - view.far_depth);
    let ahead = world_from_texel(view, texel, mix(1.0 - view.far_depth, view.far_depth, 0.5));
    let direction = normalize(ahead - eye);
    var reach = 1e30;
    if pixel_depth != view.far_depth {
        reach = distance(world_from_texel(view, texel, pixel_depth), eye);
    }
    // In spacings, a ball in the middle of each cube.
    let origin = (eye - lumivox_lattice.origin) / lumivox_lattice.spacing;
    let dims = lumivox_lattice.extent / lumivox_lattice.spacing;
    let safe = select(direction, vec3f(1e-9), abs(direction) < vec3f(1e-9));
    let a = -origin / safe;
    let b = (dims - origin) / safe;
    let enter = max(max(min(a.x, b.x), min(a.y, b.y)), max(min(a.z, b.z), 0.0));
    let leave = min(min(max(a.x, b.x), max(a.y, b.y)), max(a.z, b.z));
    var at = enter + 1e-3;
    // A ray crosses at most the sum of the sides.
    for (var step = 0u; step < u32(dims.x + dims.y + dims.z) + 3u && at < leave; step++) {
        let cube = floor(origin + at * direction);
        let middle = cube + 0.5;
        let along = dot(middle - origin, direction);
        let off = middle - origin - along * direction;
        let inside = RADIUS * RADIUS - dot(off, off);
        if inside > 0.0 {
            let hit = along - sqrt(inside);
            if hit > 0.0 && hit * lumivox_lattice.spacing < reach {
                let n = normalize(origin + hit * direction - middle);
                let center = lumivox_lattice.origin + lumivox_lattice.spacing * middle;
                return vec4f(min(lumivox_irradiance_at(center, n) / PI, vec3f(HALF_MAX)), 1.0);
            }
        }
        let exits = (cube + select(vec3f(0.0), vec3f(1.0), safe > vec3f(0.0)) - origin) / safe;
        at = min(exits.x, min(exits.y, exits.z)) + 1e-3;
    }
    return vec4f(min(DIMMED * textureLoad(radiance, texel, 0).rgb, vec3f(HALF_MAX)), 1.0);
}
