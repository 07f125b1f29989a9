// Direct light with shadows, and the light that leaves a surface as spherical harmonics: functions of a surface point.

struct VoxelLight {
    clip_from_world: mat4x4f,
    // Of a point light its place, of a directional one the way the light travels.
    position: vec3f,
    is_directional: u32,
    // W/sr of a point light, W/m2 of a directional one.
    color: vec3f,
    // Subtracted from a point's depth before it is compared.
    bias: f32,
    // Corner and size of the light's tile in the shadow map, 0 to 1.
    tile: vec4f,
}

struct VoxelLights {
    lights: array<VoxelLight, 16>,
    count: u32,
}

@group(2) @binding(0) var<uniform> voxel_lights: VoxelLights;
@group(2) @binding(1) var voxel_shadows: texture_depth_2d;
@group(2) @binding(2) var voxel_shadow_sampler: sampler_comparison;

// How much of a light reaches a point: 0 or 1, and between at the border of texels. What no map shows is lit.
fn lv_visibility(light: VoxelLight, position: vec3f) -> f32 {
    let clip = light.clip_from_world * vec4f(position, 1.0);
    let ndc = clip.xyz / clip.w;
    if clip.w <= 0.0 || any(abs(ndc.xy) > vec2f(1.0)) || ndc.z > 1.0 || ndc.z < 0.0 {
        return 1.0;
    }
    let uv = light.tile.xy + light.tile.zw * (vec2f(0.5, -0.5) * ndc.xy + 0.5);
    return textureSampleCompareLevel(voxel_shadows, voxel_shadow_sampler, uv, ndc.z - light.bias);
}

// The side that faces the light reflects it: surfaces reflect on both sides.
fn lv_irradiance(point: SurfacePoint, light: VoxelLight) -> vec3f {
    var to_light = -light.position;
    var arriving = light.color;
    if light.is_directional == 0u {
        to_light = light.position - point.position;
        arriving /= max(dot(to_light, to_light), 1e-12);
    }
    return arriving * (abs(dot(point.normal, normalize(to_light))) * lv_visibility(light, point.position));
}

// Radiance that leaves the point, W/(m2 sr): reflected and emitted. Then its spherical harmonics, of its mean and of each
// colour: the radiance times the clamped cosine about the normal.
fn lv_direct_light(point: SurfacePoint) -> array<vec4f, 5> {
    var irradiance = vec3f(0.0);
    for (var i = 0u; i < min(voxel_lights.count, 16u); i++) {
        irradiance += lv_irradiance(point, voxel_lights.lights[i]);
    }
    let radiance = point.emission + point.color.rgb * irradiance / 3.14159265;
    let lobe = sh_cosine_lobe(point.normal);
    let mean = (radiance.r + radiance.g + radiance.b) / 3.0;
    return array<vec4f, 5>(
        vec4f(radiance, 0.0), mean * lobe, radiance.r * lobe, radiance.g * lobe, radiance.b * lobe,
    );
}
