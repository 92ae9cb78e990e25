// One cell of the picture: one or two pictures of the surface at a wipe over a background, exposed, then encoded once;
// or what two pictures differ by, in false colour.

struct Compare {
    // The cell's top left corner and its size, in viewports, y down.
    origin: vec2f,
    extent: vec2f,
    // What each side's sum is multiplied by: exposure over samples.
    left_scale: f32,
    right_scale: f32,
    // Where the left side ends, in pixels from the left edge.
    wipe: f32,
    // Half the divider's width in pixels; 0 for none.
    divider: f32,
    // Pixels of the left and upper edge that part the cell from its neighbours.
    border: vec2f,
    // The differences at both ends of the scale.
    ends: vec2f,
    shown: u32,
    padding: u32,
    more_padding: vec2u,
    // The scale's stops, sRGB.
    scale: array<vec4f, 9>,
}

// What is shown.
const PICTURES: u32 = 0;
const ABSOLUTE_DIFFERENCE: u32 = 1;

// Linear grey at the head and the foot of the background.
const BACKGROUND_TOP: f32 = 0.016;
const BACKGROUND_BOTTOM: f32 = 0.006;
const DIVIDER: f32 = 0.8;
const BORDER: f32 = 0.06;
// Weights of the luminance of linear sRGB (IEC 61966-2-1, ITU-R BT.709).
const LUMINANCE: vec3f = vec3f(0.2126, 0.7152, 0.0722);

@group(0) @binding(0) var<uniform> compare: Compare;
// The pictures' floats, bit for bit.
@group(0) @binding(1) var left: texture_2d<u32>;
@group(0) @binding(2) var right: texture_2d<u32>;

struct Corner {
    @builtin(position) position: vec4f,
    // 0..1 over the cell, y down.
    @location(0) at: vec2f,
}

// Two triangles that cover the cell.
@vertex
fn vertex(@builtin(vertex_index) index: u32) -> Corner {
    let at = vec2f(f32(index & 1u), f32(index >> 1u));
    let place = compare.origin + compare.extent * at;
    return Corner(vec4f(2.0 * place.x - 1.0, 1.0 - 2.0 * place.y, 0.0, 1.0), at);
}

@fragment
fn fragment(corner: Corner) -> @location(0) vec4f {
    let size = vec2f(textureDimensions(left));
    let texel = vec2i(clamp(corner.at * size, vec2f(0.0), size - 1.0));
    let pixel = corner.at * size;
    if any(pixel < compare.border) {
        return vec4f(vec3f(srgb_from_linear(vec3f(BORDER))), 1.0);
    }
    let on_left = exposed(textureLoad(left, texel, 0), compare.left_scale);
    let on_right = exposed(textureLoad(right, texel, 0), compare.right_scale);
    let background = vec3f(mix(BACKGROUND_TOP, BACKGROUND_BOTTOM, corner.at.y));
    if compare.shown != PICTURES {
        let color = difference_color(on_left.rgb, on_right.rgb);
        return vec4f(select(srgb_from_linear(background), color, min(on_left.a, on_right.a) > 0.5), 1.0);
    }
    let color = select(on_right, on_left, pixel.x < compare.wipe);
    // What is not the surface is the sky, where there is one.
    var linear = select(background, color.rgb, color.a > 0.0);
    if abs(pixel.x - compare.wipe) < compare.divider {
        linear = vec3f(DIVIDER);
    }
    return vec4f(srgb_from_linear(linear), 1.0);
}

// Linear RGB, and whether the surface is seen.
fn exposed(bits: vec4u, scale: f32) -> vec4f {
    return bitcast<vec4f>(bits) * vec4f(vec3f(scale), 1.0);
}

// sRGB, the twin of `comparison/difference.rs`.
fn difference_color(on_left: vec3f, on_right: vec3f) -> vec3f {
    let difference = on_right - on_left;
    let signed = dot(LUMINANCE, difference);
    let absolute = dot(abs(difference), vec3f(1.0)) / 3.0;
    let value = select(signed, absolute, compare.shown == ABSOLUTE_DIFFERENCE);
    let stop = color_stop((value - compare.ends.x) / (compare.ends.y - compare.ends.x));
    return mix(compare.scale[stop.index].rgb, compare.scale[stop.index + 1u].rgb, stop.blend);
}
