// The cells of a volume, one pixel per invocation.

struct VoxelViewUniform {
    headlight: f32,
    light: f32,
    channel: u32,
    reserved_0: u32,
    low: vec3f,
    reserved_1: u32,
    high: vec3f,
    reserved_2: u32,
}

@group(0) @binding(0) var<uniform> grid: GridUniform;
@group(0) @binding(1) var<uniform> view: ViewUniform;
@group(0) @binding(2) var<uniform> voxel_view: VoxelViewUniform;
@group(0) @binding(3) var<storage, read> normal: array<vec2u>;
@group(0) @binding(4) var<storage, read> albedo: array<vec2u>;
@group(0) @binding(5) var<storage, read> emission: array<vec2u>;
@group(0) @binding(6) var<storage, read> light: array<vec2u>;
// Normals of the volume that there would be if all surfaces had been seen.
@group(0) @binding(7) var<storage, read> expected: array<vec2u>;
// Of cells that views have shown 1 more than the frames since then, else 0.
@group(0) @binding(8) var<storage, read> ages: array<u32>;

const UNSEEN: u32 = 5u;
const AGE: u32 = 6u;
const PINK: vec3f = vec3f(1.0, 0.13, 0.45);

struct Ray {
    origin: vec3f,
    direction: vec3f,
}

// The pixel's ray in units of cells.
fn pixel_ray(position: vec2f) -> Ray {
    let ndc = ndc_from_uv(position / vec2f(view.size));
    let a = view.world_from_clip * vec4f(ndc, 1.0 - view.far_depth, 1.0);
    let b = view.world_from_clip * vec4f(ndc, view.far_depth, 1.0);
    let origin = grid_from_world(grid, a.xyz / a.w);
    return Ray(origin, normalize(grid_from_world(grid, b.xyz / b.w) - origin));
}

fn is_occupied(index: u32) -> bool {
    return unpack_half4(normal[index]).w > 0.0;
}

fn is_shown(index: u32) -> bool {
    return is_occupied(index) || (voxel_view.channel == UNSEEN && unpack_half4(expected[index]).w > 0.0);
}

// The most frames that are told apart.
const LONG: f32 = 64.0;

fn age_color(index: u32) -> vec3f {
    let age = f32(ages[index]) - 1.0;
    if age < 0.0 || age > LONG {
        return vec3f(0.35);
    }
    if age == 0.0 {
        return vec3f(0.9, 0.05, 0.03);
    }
    let old = log2(age) / log2(LONG);
    let green = vec3f(0.1, 0.55, 0.25);
    return mix(mix(vec3f(0.95, 0.75, 0.05), green, saturate(2.0 * old)), vec3f(0.05, 0.12, 0.75), saturate(2.0 * old - 1.0));
}

fn shade(index: u32, face: vec3f, direction: vec3f, shade_edge: f32) -> vec3f {
    let color = unpack_half4(albedo[index]).rgb;
    let lobe = SH_Y0 * vec4f(1.0, 1.7320508 * face);
    let leaving = vec3f(
        dot(unpack_half4(light[3u * index]), lobe),
        dot(unpack_half4(light[3u * index + 1u]), lobe),
        dot(unpack_half4(light[3u * index + 2u]), lobe),
    );
    switch voxel_view.channel {
        case 1u: { return shade_edge * color; }
        case 2u: { return shade_edge * (0.5 + 0.5 * unpack_half4(normal[index]).xyz); }
        case 3u: { return shade_edge * unpack_half4(emission[index]).rgb; }
        case 4u: { return shade_edge * max(leaving, vec3f(0.0)); }
        default: {}
    }
    // A different brightness for each axis, so that cubes read as cubes.
    let axis_shade = dot(abs(face), vec3f(0.8, 1.0, 0.62)) * (0.6 + 0.4 * abs(dot(face, direction)));
    if voxel_view.channel == AGE {
        return shade_edge * axis_shade * age_color(index);
    }
    if !is_occupied(index) {
        return shade_edge * axis_shade * PINK;
    }
    let headlight = voxel_view.headlight * axis_shade * color;
    return shade_edge * (headlight + voxel_view.light * max(leaving, vec3f(0.0)) + unpack_half4(emission[index]).rgb);
}

@fragment
fn fragment(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let ray = pixel_ray(position.xy);
    let safe = select(ray.direction, vec3f(1e-9), abs(ray.direction) < vec3f(1e-9));
    let inverse = 1.0 / safe;
    let to_low = (vec3f(0.0) - ray.origin) * inverse;
    let to_high = (vec3f(grid.dims) - ray.origin) * inverse;
    let enter3 = min(to_low, to_high);
    let enter = max(max(max(enter3.x, enter3.y), enter3.z), 0.0);
    let leave3 = max(to_low, to_high);
    let leave = min(min(leave3.x, leave3.y), leave3.z);
    if enter >= leave {
        return vec4f(0.0);
    }
    var cell = vec3i(clamp(floor(ray.origin + (enter + 1e-4) * ray.direction), vec3f(0.0), vec3f(grid.dims) - 1.0));
    let step = vec3i(sign(safe));
    let delta = abs(inverse);
    var next = (vec3f(cell) + select(vec3f(0.0), vec3f(1.0), step > vec3i(0)) - ray.origin) * inverse;
    var face = select(vec3f(0.0), -vec3f(step), enter3 >= vec3f(enter));
    var distance = enter;
    // A ray crosses at most nx + ny + nz cells.
    for (var i = 0u; i < grid.dims.x + grid.dims.y + grid.dims.z; i++) {
        if !cell_in_grid(grid, cell) {
            break;
        }
        let index = cell_index(grid, vec3u(cell));
        // The cell that the eye is in would hide everything.
        let middle = cell_center(grid, vec3u(cell));
        let shown = all(middle >= voxel_view.low) && all(middle <= voxel_view.high);
        if shown && is_shown(index) && distance > 0.5 {
            let p = fract(ray.origin + distance * ray.direction);
            let across = select(min(p, 1.0 - p), vec3f(1.0), abs(face) > vec3f(0.5));
            let edge = min(min(across.x, across.y), across.z);
            // Edge lines fade with distance, where they would only flicker.
            let line = mix(0.7, 1.0, saturate(max(edge * 14.0, distance / 60.0)));
            return vec4f(min(shade(index, face, ray.direction, line), vec3f(HALF_MAX)), 1.0);
        }
        let axis = select(select(vec3f(0.0, 0.0, 1.0), vec3f(0.0, 1.0, 0.0), next.y <= next.z),
            vec3f(1.0, 0.0, 0.0), next.x <= next.y && next.x <= next.z);
        distance = dot(axis, next);
        cell += vec3i(axis) * step;
        face = -axis * vec3f(step);
        next += axis * delta;
    }
    return vec4f(0.0);
}
