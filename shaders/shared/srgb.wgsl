// Twin of color.rs.

// sRGB code value of linear `value` (IEC 61966-2-1), per channel, both in 0..1.
fn srgb_from_linear(value: vec3f) -> vec3f {
    let linear = clamp(value, vec3f(0.0), vec3f(1.0));
    let curve = 1.055 * pow(max(linear, vec3f(0.0031308)), vec3f(1.0 / 2.4)) - 0.055;
    return select(curve, 12.92 * linear, linear <= vec3f(0.0031308));
}
