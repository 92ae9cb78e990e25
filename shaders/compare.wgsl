// One or two pictures of the surface, side by side at a wipe, over a background; exposed, then encoded once.

struct Compare {
    // What each side's sum is multiplied by: exposure over samples.
    left_scale: f32,
    right_scale: f32,
    // Where the left side ends, in pixels from the left edge.
    wipe: f32,
    // Half the divider's width in pixels; 0 for none.
    divider: f32,
}

// Linear grey at the head and the foot of the background.
const BACKGROUND_TOP: f32 = 0.016;
const BACKGROUND_BOTTOM: f32 = 0.006;
const DIVIDER: f32 = 0.8;

@group(0) @binding(0) var<uniform> compare: Compare;
// The pictures' floats, bit for bit.
@group(0) @binding(1) var left: texture_2d<u32>;
@group(0) @binding(2) var right: texture_2d<u32>;

struct Corner {
    @builtin(position) position: vec4f,
    // 0..1 over the viewport, y down.
    @location(0) at: vec2f,
}

// One triangle that covers the viewport.
@vertex
fn vertex(@builtin(vertex_index) index: u32) -> Corner {
    let at = vec2f(f32((index << 1u) & 2u), f32(index & 2u));
    return Corner(vec4f(2.0 * at.x - 1.0, 1.0 - 2.0 * at.y, 0.0, 1.0), at);
}

@fragment
fn fragment(corner: Corner) -> @location(0) vec4f {
    let size = vec2f(textureDimensions(left));
    let texel = vec2i(clamp(corner.at * size, vec2f(0.0), size - 1.0));
    let x = corner.at.x * size.x;
    var color = vec4f(0.0);
    if x < compare.wipe {
        color = bitcast<vec4f>(textureLoad(left, texel, 0)) * vec4f(vec3f(compare.left_scale), 1.0);
    } else {
        color = bitcast<vec4f>(textureLoad(right, texel, 0)) * vec4f(vec3f(compare.right_scale), 1.0);
    }
    let background = mix(BACKGROUND_TOP, BACKGROUND_BOTTOM, corner.at.y);
    var linear = select(vec3f(background), color.rgb, color.a > 0.5);
    if abs(x - compare.wipe) < compare.divider {
        linear = vec3f(DIVIDER);
    }
    return vec4f(srgb_from_linear(linear), 1.0);
}
