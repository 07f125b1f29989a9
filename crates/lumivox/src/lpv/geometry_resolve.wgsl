// Sums of one view to blockers, one corner per invocation: the view that has seen more surface there counts.

@group(0) @binding(0) var<uniform> grid: GridUniform;
@group(0) @binding(1) var<storage, read_write> geometry_sums: array<i32>;
@group(0) @binding(2) var<storage, read_write> geometry: array<vec4u>;

override AREA_STEPS: f32;
override GEOMETRY_SUM_WORDS: u32;

fn taken(at: u32) -> f32 {
    let sum = f32(geometry_sums[at]) / AREA_STEPS;
    geometry_sums[at] = 0;
    return sum;
}

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) workgroups: vec3u) {
    let index = linear_id(id, workgroups);
    if index >= corner_count(grid) {
        return;
    }
    let at = GEOMETRY_SUM_WORDS * index;
    let area = taken(at);
    let facing = vec3f(taken(at + 1u), taken(at + 2u), taken(at + 3u));
    let reflected = vec3f(taken(at + 4u), taken(at + 5u), taken(at + 6u));
    let blocking = vec4f(SH_COS0 * area, SH_COS1 * facing);
    if area == 0.0 || unpack_half4(geometry[index].xy).x >= blocking.x {
        return;
    }
    geometry[index] = vec4u(pack_half4(blocking), pack_half4(vec4f(reflected / area, 0.0)));
}
