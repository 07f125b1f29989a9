// What is seen through glass, one pixel per invocation, in linear radiance.

struct GlassUniform {
    through: vec3f,
    ior: f32,
    tint: vec3f,
    bend: f32,
    body: vec3f,
    frost: f32,
    roughness: f32,
    gloss: f32,
    is_thin: u32,
    reserved: u32,
}

struct RefractionUniform {
    kinds: array<GlassUniform, 4>,
    pixel_angle: f32,
    uses_picture: u32,
    kind_count: u32,
    reserved: u32,
}

@group(0) @binding(0) var<uniform> view: ViewUniform;
@group(0) @binding(1) var<uniform> refraction: RefractionUniform;
@group(0) @binding(2) var depth: texture_2d<f32>;
@group(0) @binding(3) var picture: texture_2d<f32>;
// World normal, and one and the kind.
@group(0) @binding(4) var glass_normal: texture_2d<f32>;
@group(0) @binding(5) var glass_depth: texture_2d<f32>;
@group(0) @binding(6) var thickness: texture_2d<f32>;
@group(0) @binding(7) var background: texture_2d<f32>;
@group(0) @binding(8) var background_sampler: sampler;
@group(0) @binding(9) var environment: texture_2d<f32>;
@group(0) @binding(10) var environment_sampler: sampler;

const PI: f32 = 3.1415927;
// Rays are bent by at most so many times the refraction at the first surface.
const MOST_BENT: f32 = 4.0;
// A ray looks what it meets at every so many pixels, or less often where it would be too often.
const STEP: f32 = 4.0;
const MOST_STEPS: u32 = 64u;
const HALVINGS: u32 = 5u;
// What a ray meets is at most so deep, as a part of its way.
const THICKNESS: f32 = 0.05;
// Pictures fade into the environment over this share of their size.
const BORDER: f32 = 0.04;

// The way that a pixel looks.
fn way_of(texel: vec2u) -> vec3f {
    let far = world_from_texel(view, texel, mix(view.far_depth, 1.0 - view.far_depth, 0.25));
    let near = world_from_texel(view, texel, mix(view.far_depth, 1.0 - view.far_depth, 0.5));
    return normalize(far - near);
}

// Weights of a cubic B-spline, and where two bilinear look-ups take the place of its four texels along an axis.
fn spline(f: f32) -> vec4f {
    let g = 1.0 - f;
    let w0 = g * g * g / 6.0;
    let w1 = (4.0 - 6.0 * f * f + 3.0 * f * f * f) / 6.0;
    let w2 = (4.0 - 6.0 * g * g + 3.0 * g * g * g) / 6.0;
    let w3 = f * f * f / 6.0;
    return vec4f(w0 + w1, w2 + w3, w1 / (w0 + w1) - 1.0, w3 / (w2 + w3) + 1.0);
}

struct Taps {
    low: vec2f,
    high: vec2f,
    weight: vec2f,
}

// Bilinear look-ups show the texels of coarse levels as diamonds; a spline over 4 x 4 of them does not.
fn taps(uv: vec2f, size: vec2f) -> Taps {
    let at = uv * size - 0.5;
    let middle = floor(at) + 0.5;
    let x = spline(fract(at.x));
    let y = spline(fract(at.y));
    return Taps((middle + vec2f(x.z, y.z)) / size, (middle + vec2f(x.w, y.w)) / size, vec2f(x.y, y.y));
}

fn smooth_background(uv: vec2f, level: f32) -> vec3f {
    let t = taps(uv, max(vec2f(textureDimensions(background)) * exp2(-level), vec2f(1.0)));
    let upper = mix(textureSampleLevel(background, background_sampler, t.low, level).rgb,
        textureSampleLevel(background, background_sampler, vec2f(t.high.x, t.low.y), level).rgb, t.weight.x);
    let lower = mix(textureSampleLevel(background, background_sampler, vec2f(t.low.x, t.high.y), level).rgb,
        textureSampleLevel(background, background_sampler, t.high, level).rgb, t.weight.x);
    return mix(upper, lower, t.weight.y);
}

fn smooth_environment(uv: vec2f, level: f32) -> vec3f {
    let t = taps(uv, max(vec2f(textureDimensions(environment)) * exp2(-level), vec2f(1.0)));
    let upper = mix(textureSampleLevel(environment, environment_sampler, t.low, level).rgb,
        textureSampleLevel(environment, environment_sampler, vec2f(t.high.x, t.low.y), level).rgb, t.weight.x);
    let lower = mix(textureSampleLevel(environment, environment_sampler, vec2f(t.low.x, t.high.y), level).rgb,
        textureSampleLevel(environment, environment_sampler, t.high, level).rgb, t.weight.x);
    return mix(upper, lower, t.weight.y);
}

// What lies far away along a direction, blurred by so many radians.
fn environment_along(d: vec3f, blur: f32) -> vec3f {
    let uv = vec2f(0.5 + atan2(d.x, -d.z) / (2.0 * PI), 0.5 - asin(clamp(d.y, -1.0, 1.0)) / PI);
    let texel = 2.0 * PI / f32(textureDimensions(environment).x);
    let level = max(log2(max(blur / texel, 1e-6)), 0.0);
    if level <= 0.0 {
        return textureSampleLevel(environment, environment_sampler, uv, 0.0).rgb;
    }
    return smooth_environment(uv, level);
}

// Where in the picture a ray is after so many metres; a negative number of them is very far.
fn place_along(start: vec3f, d: vec3f, reach: f32) -> vec4f {
    if reach < 0.0 {
        return view.clip_from_world * vec4f(d, 0.0);
    }
    return view.clip_from_world * vec4f(start + reach * d, 1.0);
}

// How far a ray can go in the picture, between the near and the far plane; below zero without end, and zero if it begins outside.
fn reach_inside(a: vec4f, e: vec4f) -> f32 {
    var least = -1.0;
    // Sides of the picture, then the planes; what is inside is not below zero.
    let here = array<vec3f, 2>(vec3f(a.w + a.xy, a.z), vec3f(a.w - a.xy, a.w - a.z));
    let change = array<vec3f, 2>(vec3f(e.w + e.xy, e.z), vec3f(e.w - e.xy, e.w - e.z));
    for (var side = 0u; side < 2u; side++) {
        for (var axis = 0u; axis < 3u; axis++) {
            if here[side][axis] < 0.0 {
                return 0.0;
            }
            if change[side][axis] < 0.0 {
                let reach = -here[side][axis] / change[side][axis];
                least = select(min(least, reach), reach, least < 0.0);
            }
        }
    }
    return least;
}

// A ray on its way through the picture: normalized device coordinates of both ends, between which it is straight.
struct Path {
    first: vec3f,
    to: vec3f,
    // Metres between the ends, below zero without end, and what they are divided by at the ends.
    reach: f32,
    w: vec2f,
}

fn world_from_ndc(place: vec3f) -> vec3f {
    let world = view.world_from_clip * vec4f(place, 1.0);
    return world.xyz / world.w;
}

fn metres_at(path: Path, s: f32) -> f32 {
    if path.reach < 0.0 {
        return s * path.w.x / max((1.0 - s) * path.w.y, 1e-20);
    }
    let after = s * path.w.x;
    return path.reach * after / max(after + (1.0 - s) * path.w.y, 1e-20);
}

fn found_depth(place: vec3f) -> f32 {
    let found = vec2u(saturate(uv_from_ndc(place.xy)) * vec2f(view.size));
    return textureLoad(depth, min(found, view.size - 1u), 0).r;
}

// Whether a place is behind what the picture shows there.
fn is_behind(place: vec3f) -> bool {
    let found = found_depth(place);
    return found != view.far_depth && select(place.z > found, place.z < found, view.far_depth == 0.0);
}

// How far a ray goes until it meets what the picture shows, below zero for ever. It looks at places a few pixels apart, one after the other,
// so that neighboring rays find the same thing.
fn reach_along(start: vec3f, d: vec3f) -> f32 {
    let a = view.clip_from_world * vec4f(start, 1.0);
    let e = view.clip_from_world * vec4f(d, 0.0);
    let end = reach_inside(a, e);
    if end == 0.0 {
        return 0.0;
    }
    var path: Path;
    var last = a + max(end, 0.0) * e;
    if end < 0.0 {
        last = e;
    }
    path.first = a.xyz / max(a.w, 1e-20);
    path.to = last.xyz / max(last.w, 1e-20);
    path.reach = end;
    path.w = vec2f(a.w, last.w);
    if is_behind(path.first) {
        return 0.0;
    }
    let pixels = length(0.5 * (path.to.xy - path.first.xy) * vec2f(view.size));
    let steps = clamp(u32(ceil(pixels / STEP)), 1u, MOST_STEPS);
    var was_behind = false;
    for (var n = 1u; n <= steps; n++) {
        let is_here = is_behind(mix(path.first, path.to, f32(n) / f32(steps)));
        if is_here && !was_behind {
            var before = f32(n - 1u) / f32(steps);
            var after = f32(n) / f32(steps);
            for (var halving = 0u; halving < HALVINGS; halving++) {
                let middle = 0.5 * (before + after);
                if is_behind(mix(path.first, path.to, middle)) {
                    after = middle;
                } else {
                    before = middle;
                }
            }
            // What it passes behind stands nearer by more than it went in a step, and is not what it meets.
            let place = mix(path.first, path.to, after);
            let found = world_from_ndc(vec3f(place.xy, found_depth(place)));
            let metres = metres_at(path, after);
            let gap = distance(found, start + metres * d);
            if gap <= THICKNESS * metres + (metres - metres_at(path, f32(n - 1u) / f32(steps))) {
                return metres;
            }
        }
        was_behind = is_here;
    }
    return end;
}

// What a ray sees that is at a place of the picture: the picture, else the environment. `spread` is how far apart the places and the ways of
// neighboring pixels are, in pixels and in radians.
fn seen_along(clip: vec4f, d: vec3f, blur: f32, spread: vec2f) -> vec3f {
    if refraction.uses_picture == 0u {
        return environment_along(d, max(blur, spread.y));
    }
    let uv = uv_from_ndc(clip.xy / max(clip.w, 1e-20));
    let inside = min(uv, 1.0 - uv) / BORDER;
    var share = saturate(min(inside.x, inside.y));
    if clip.w <= 0.0 {
        share = 0.0;
    }
    var around = vec3f(0.0);
    if share < 1.0 {
        around = environment_along(d, max(blur, spread.y));
    }
    if share <= 0.0 {
        return around;
    }
    // The spline of a level is as wide as two of its texels.
    let level = max(log2(max(max(blur / refraction.pixel_angle, 0.5 * spread.x), 1e-6)), 0.0);
    var found = textureSampleLevel(background, background_sampler, uv, 0.0).rgb;
    if level > 0.0 {
        // It blurs on the finest level too.
        found = mix(found, smooth_background(uv, level), saturate(level));
    }
    return mix(around, found, share);
}

// What a pixel's ray does at the nearest glass.
struct Look {
    is_glass: bool,
    kind: u32,
    n: vec3f,
    // Of each kind that is not thin.
    metres: vec4f,
    way: vec3f,
    // Where the bent ray begins, as far behind the surface as the glass is thick.
    start: vec3f,
    bent: vec3f,
    mirrored: vec3f,
}

fn look_of(texel: vec2u) -> Look {
    var look: Look;
    let glass = textureLoad(glass_normal, texel, 0);
    look.is_glass = glass.w >= 0.5;
    if !look.is_glass {
        return look;
    }
    look.kind = min(u32(glass.w - 0.5), 3u);
    look.n = normalize(glass.xyz);
    look.way = way_of(texel);
    let columns = vec2f(textureDimensions(thickness));
    let column = vec2u((vec2f(texel) + 0.5) / vec2f(view.size) * columns);
    look.metres = textureLoad(thickness, min(column, vec2u(columns) - 1u), 0);
    for (var k = 0u; k < 4u; k++) {
        if k >= refraction.kind_count || refraction.kinds[k].is_thin != 0u {
            look.metres[k] = 0.0;
        }
    }
    let own = refraction.kinds[look.kind];
    let refracted = refract(look.way, look.n, 1.0 / own.ior);
    let share = min(own.bend * look.metres[look.kind], MOST_BENT);
    look.bent = normalize(look.way + share * (refracted - look.way));
    look.start = world_from_texel(view, texel, textureLoad(glass_depth, texel, 0).r) + look.metres[look.kind] * look.way;
    look.mirrored = reflect(look.way, look.n);
    return look;
}

// How far apart a pixel and its neighbors see: pixels of the picture, radians of the bent way and of the mirrored one. A bumpy surface brings
// places far apart side by side, and what lies between them is to be seen too. On each axis the neighbor that differs less counts, so
// that rims stay sharp.
fn spread_of(texel: vec2u, here: Look, clip: vec4f, reach: f32) -> vec3f {
    var widest = vec3f(0.0);
    let own = clip.xy / max(clip.w, 1e-20);
    for (var axis = 0u; axis < 2u; axis++) {
        var least = vec3f(1e30);
        for (var side = -1; side <= 1; side += 2) {
            let at = vec2i(texel) + side * vec2i(i32(1u - axis), i32(axis));
            if any(at < vec2i(0)) || any(at >= vec2i(view.size)) {
                continue;
            }
            let there = look_of(vec2u(at));
            if there.is_glass && there.kind == here.kind {
                let other = place_along(there.start, there.bent, reach);
                let pixels = 0.5 * vec2f(view.size) * (other.xy / max(other.w, 1e-20) - own);
                let angles = vec2f(distance(there.bent, here.bent), distance(there.mirrored, here.mirrored));
                least = min(least, vec3f(length(pixels), angles));
            }
        }
        widest = max(widest, select(vec3f(0.0), least, least < vec3f(1e30)));
    }
    return widest;
}

@fragment
fn fragment(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let texel = vec2u(position.xy);
    let plain = textureLoad(picture, texel, 0);
    let front_depth = textureLoad(glass_depth, texel, 0).r;
    let behind_depth = textureLoad(depth, texel, 0).r;
    let is_hidden = (view.far_depth == 0.0 && behind_depth > front_depth)
        || (view.far_depth != 0.0 && behind_depth < front_depth);
    let look = look_of(texel);
    if !look.is_glass || is_hidden {
        return plain;
    }
    let own = refraction.kinds[look.kind];

    // All kinds on the way take light and blur; the first bends.
    var left = own.tint;
    var lost = vec3f(0.0);
    var blur = own.roughness;
    for (var k = 0u; k < refraction.kind_count; k++) {
        let glass_k = refraction.kinds[k];
        // Powers of zero are not the same everywhere, least of all the zeroth.
        let passes = pow(max(glass_k.through, vec3f(1e-6)), vec3f(look.metres[k]));
        lost += (1.0 - passes) * glass_k.body;
        left *= passes;
        blur += glass_k.frost * look.metres[k];
    }
    let reach = reach_along(look.start, look.bent);
    let clip = place_along(look.start, look.bent, reach);
    let spread = spread_of(texel, look, clip, reach);
    var shown = left * seen_along(clip, look.bent, blur, spread.xy) + lost;

    // Schlick.
    let head_on = pow((own.ior - 1.0) / (own.ior + 1.0), 2.0);
    let share = own.gloss * (head_on + (1.0 - head_on) * pow(1.0 - saturate(-dot(look.way, look.n)), 5.0));
    shown = mix(shown, environment_along(look.mirrored, max(own.roughness, spread.z)), share);
    return vec4f(min(shown, vec3f(HALF_MAX)), plain.a);
}
