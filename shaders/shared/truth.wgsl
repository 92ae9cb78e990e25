// Twin of filter/truth.rs.

const R2_STEP = vec2u(3242174889u, 2447445414u);

fn pcg(input: u32) -> u32 {
    let state = input * 747796405u + 2891336453u;
    let word = ((state >> ((state >> 28u) + 4u)) ^ state) * 277803737u;
    return (word >> 22u) ^ word;
}

// Offset of sample `index` from the pixel's centre, each component in -0.5..0.5.
fn jitter(pixel: vec2u, index: u32) -> vec2f {
    let first = pcg(pixel.x ^ pcg(pixel.y));
    let bits = vec2u(first, pcg(first)) + index * R2_STEP;
    return vec2f(bits >> vec2u(8u)) / 16777216.0 - 0.5;
}

// The base texel under `coordinate` along an axis of `size` texels.
fn nearest_texel(coordinate: f32, size: i32, wraps: bool) -> i32 {
    return address(i32(floor(coordinate * f32(size))), size, wraps);
}
