// The sky behind the surface. Linear light before exposure, bit for bit as the surface's pictures have it; an alpha of
// BEHIND says that it is no surface.

struct Environment {
    world_from_clip: mat4x4f,
    eye_in_world: vec3f,
    intensity: f32,
    // Cosine and sine of the sky's rotation.
    turn: vec2f,
    padding: vec2u,
}

const BEHIND: f32 = 0.25;

@group(0) @binding(0) var<uniform> environment: Environment;
@group(0) @binding(1) var sky_texels: texture_2d<f32>;

struct Corner {
    @builtin(position) position: vec4f,
    @location(0) clip: vec2f,
}

// A triangle that covers the picture.
@vertex
fn vertex(@builtin(vertex_index) index: u32) -> Corner {
    let clip = vec2f(f32(index & 1u), f32(index >> 1u)) * 4.0 - 1.0;
    return Corner(vec4f(clip, 0.5, 1.0), clip);
}

@fragment
fn fragment(corner: Corner) -> @location(0) vec4u {
    let far = environment.world_from_clip * vec4f(corner.clip, 1.0, 1.0);
    let direction = normalize(far.xyz / far.w - environment.eye_in_world);
    let color = environment.intensity * seen(sky_from_world(environment.turn, direction));
    return bitcast<vec4u>(vec4f(color, BEHIND));
}

// Linear RGB between the texels around a direction.
fn seen(direction: vec3f) -> vec3f {
    let size = vec2i(textureDimensions(sky_texels));
    let at = lat_long(direction) * vec2f(size) - 0.5;
    let first = vec2i(floor(at));
    let blend = at - floor(at);
    let upper = mix(texel(first, size), texel(first + vec2i(1, 0), size), blend.x);
    let lower = mix(texel(first + vec2i(0, 1), size), texel(first + vec2i(1, 1), size), blend.x);
    return mix(upper, lower, blend.y);
}

fn texel(at: vec2i, size: vec2i) -> vec3f {
    let place = vec2i((at.x + size.x) % size.x, clamp(at.y, 0, size.y - 1));
    return textureLoad(sky_texels, place, 0).rgb;
}
