// Four half floats in two words: the storage of every volume channel (with four of them up to half as fast again as 3D textures on a
// software driver, and not bound by the four storage textures of a core stage).

// The largest half float.
const HALF_MAX: f32 = 65504.0;

// What is larger becomes the largest: infinity would turn into NaN and spread from cell to cell.
fn pack_half4(v: vec4f) -> vec2u {
    let held = clamp(v, vec4f(-HALF_MAX), vec4f(HALF_MAX));
    return vec2u(pack2x16float(held.xy), pack2x16float(held.zw));
}

fn unpack_half4(p: vec2u) -> vec4f {
    return vec4f(unpack2x16float(p.x), unpack2x16float(p.y));
}
