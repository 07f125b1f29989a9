// The light that one surfel per invocation begins with, if it is new: the mean of those around it that face its way and that it can see.

@group(0) @binding(0) var<uniform> grid: GridUniform;
@group(0) @binding(1) var<uniform> settings: GatherUniform;
@group(0) @binding(2) var<storage, read> mask: array<vec2u>;
@group(0) @binding(3) var<storage, read> blocks: array<vec2u>;
@group(0) @binding(4) var<storage, read> table: array<u32>;
@group(0) @binding(5) var<storage, read> surfels: array<vec4u>;
@group(0) @binding(6) var<storage, read> hits: array<u32>;
@group(0) @binding(7) var<storage, read_write> light: array<vec4f>;
@group(0) @binding(8) var<storage, read_write> shine: array<vec4u>;
@group(0) @binding(9) var<storage, read_write> shown: array<vec4u>;

// One that was made in this frame has no rays yet; only these are written here, and only the others read.
fn is_just_made(place: u32) -> bool {
    return hits[place * settings.rays] == UNTRACED;
}

// The sums of what is sent out, and of the irradiance that is shown; the last number is the sum of weights.
struct Taken {
    leaving: vec4f,
    shown_leaving: vec4f,
    shown_arriving: vec4f,
}

fn with_donor(sum: Taken, weight: f32, place: u32) -> Taken {
    let before = shown[place];
    return Taken(
        sum.leaving + weight * vec4f(unpack_half4(shine[place].xy).rgb, 1.0),
        sum.shown_leaving + weight * unpack_half4(before.xy),
        sum.shown_arriving + weight * unpack_half4(before.zw),
    );
}

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) workgroups: vec3u) {
    let place = linear_id(id, workgroups);
    if place >= settings.capacity || surfels[place].x == NO_SURFEL || !is_just_made(place) {
        return;
    }
    let surfel = unpack_surfel(surfels[place]);
    var sum = Taken(vec4f(0.0), vec4f(0.0), vec4f(0.0));
    for (var n = 0u; n < PLACES_AROUND; n++) {
        let donor = place_around(surfel, n);
        if donor == NO_SURFEL || is_just_made(donor) {
            continue;
        }
        let other = unpack_surfel(surfels[donor]);
        let way = way_beside(surfel, other);
        if dot(other.normal, surfel.normal) > ALIKE && sees_beside(surfel, way) {
            // A cell away counts 15 times as much as two cells across: light changes over that.
            let nearness = 1.0 / (1.0 + dot(way, way));
            sum = with_donor(sum, nearness * nearness * nearness * nearness, donor);
        }
    }
    let has_donor = sum.leaving.w > 0.0;
    let share = 1.0 / max(sum.leaving.w, 1e-20);
    light[place] = vec4f(0.0, 0.0, 0.0, select(NEW, INHERITED, has_donor));
    shine[place] = vec4u(pack_half4(vec4f(share * sum.leaving.rgb, 0.0)), 0u, 0u);
    shown[place] = vec4u(pack_half4(share * sum.shown_leaving), pack_half4(share * sum.shown_arriving));
}
