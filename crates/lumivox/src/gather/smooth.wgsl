// Takes grain off the irradiance of one surfel per invocation that is due: the mean of its own and of those beside it that it can see,
// as far as they differ by no more than their rays leave open.

@group(0) @binding(0) var<uniform> grid: GridUniform;
@group(0) @binding(1) var<uniform> settings: GatherUniform;
@group(0) @binding(2) var<storage, read> mask: array<vec2u>;
@group(0) @binding(3) var<storage, read> blocks: array<vec2u>;
@group(0) @binding(4) var<storage, read> table: array<u32>;
@group(0) @binding(5) var<storage, read> surfels: array<vec4u>;
@group(0) @binding(6) var<storage, read> due: DueSurfels;
@group(0) @binding(7) var<storage, read> sky_light: array<vec2u>;
@group(0) @binding(8) var<storage, read> shine: array<vec4u>;
@group(0) @binding(9) var<storage, read_write> smoothed: array<vec2u>;

const PI: f32 = 3.1415927;
// A difference by this part is not seen.
const FINE: f32 = 0.004;
// Half of the weight is gone at a cell, in sub-cells.
const REACH: f32 = 3.4;
// Less is not worth a look.
const LEAST_WEIGHT: f32 = 0.02;

// Irradiance, and the variance of its brightness, below zero of one that keeps its grain.
fn estimate(place: u32) -> vec4f {
    let surfaces = unpack_half4(shine[place].zw);
    var irradiance = surfaces.rgb;
    var variance = surfaces.w * surfaces.w;
    if settings.sky_apart == 0u {
        let sky = PI * unpack_half4(sky_light[place]);
        irradiance += sky.rgb;
        variance += sky.w * sky.w;
    }
    return vec4f(irradiance, select(variance, KEEPS_GRAIN, surfaces.w < 0.0));
}

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) workgroups: vec3u) {
    let nth = linear_id(id, workgroups);
    if nth >= due.count {
        return;
    }
    let place = due.surfels[nth].x;
    let own = estimate(place);
    let surfel = unpack_surfel(surfels[place]);
    var sum = vec4f(own.rgb, 1.0);
    let around = select(PLACES_AROUND, 0u, own.w < 0.0);
    for (var n = 0u; n < around; n++) {
        let beside = place_around(surfel, n);
        if beside == NO_SURFEL || beside == place {
            continue;
        }
        let other = unpack_surfel(surfels[beside]);
        if dot(other.normal, surfel.normal) < ALIKE {
            continue;
        }
        let theirs = estimate(beside);
        if theirs.w < 0.0 {
            continue;
        }
        let apart = abs(brightness(own.rgb) - brightness(theirs.rgb));
        let way = way_beside(surfel, other);
        // The same from both sides, so that what one gives the other gets: those that missed a small lamp know of no doubt.
        let doubt = 0.5 * apart * apart / max(own.w + theirs.w, 1e-30);
        let weight = exp(-doubt - 0.5 * dot(way, way) / (REACH * REACH));
        // Who brings the same need not be seen.
        let is_same = apart < FINE * brightness(own.rgb);
        if weight > LEAST_WEIGHT && (is_same || sees_beside(surfel, way)) {
            sum += weight * vec4f(theirs.rgb, 1.0);
        }
    }
    smoothed[place] = pack_half4(vec4f(sum.rgb / sum.w, 0.0));
}
