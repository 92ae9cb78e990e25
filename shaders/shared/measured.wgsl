// Twin of brdf/measured.rs and brdf/factors.rs.

// By bin: f of theta_h per channel in the first row, scale times g of theta_d in the second; one texel where nothing is
// measured.
@group(0) @binding(3) var measured: texture_2d<f32>;

const HALF_PI: f32 = 1.5707964;

// f(u) per channel; nothing below the horizon.
fn measured_at(cosine: f32) -> vec3f {
    if cosine <= 0.0 {
        return vec3f(0.0);
    }
    return between_bins(0, sqrt(angle_of(cosine) / HALF_PI));
}

// scale g per channel where light and half vector are apart by an angle of this cosine.
fn measured_factor(difference_cosine: f32) -> vec3f {
    return between_bins(1, angle_of(difference_cosine) / HALF_PI);
}

// Linear interpolation between the middles of equal steps of 0..1.
fn between_bins(row: i32, at: f32) -> vec3f {
    let bins = f32(textureDimensions(measured).x);
    let place = clamp(at * bins - 0.5, 0.0, bins - 1.0);
    let first = min(i32(place), i32(bins) - 2);
    let below = textureLoad(measured, vec2i(first, row), 0).rgb;
    let above = textureLoad(measured, vec2i(first + 1, row), 0).rgb;
    return mix(below, above, place - f32(first));
}

// acos() loses the small angles.
fn angle_of(cosine: f32) -> f32 {
    let u = clamp(cosine, -1.0, 1.0);
    return atan2(sqrt(1.0 - u * u), u);
}
