// Twin of filter/truth.rs and filter/pixel_footprint.rs.

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

// How texture coordinates run over one pixel.
struct PixelFootprint {
    dx: vec2f,
    dy: vec2f,
    perspective: vec2f,
}

// The least that 1 + g . o may be.
const HORIZON: f32 = 0.015625;

// The change of uv over `offset` pixels from the centre.
fn uv_step(footprint: PixelFootprint, offset: vec2f) -> vec2f {
    let nearness = max(1.0 + dot(footprint.perspective, offset), HORIZON);
    return (offset.x * footprint.dx + offset.y * footprint.dy) / nearness;
}
