// Twin of filter/lean.rs.

const LEAST_HALF_Z: f32 = 0.02;

// The density of half vectors, per steradian: a Gaussian over slopes, widened by the material's own.
fn slope_density(first: vec4f, second: vec4f, exponent: f32, half: vec3f) -> f32 {
    if half.z <= LEAST_HALF_Z {
        return 0.0;
    }
    let own = 1.0 / exponent;
    let variance = max(first.zw - first.xy * first.xy, vec2f(0.0)) + own;
    let covariance = second.x - first.x * first.y;
    let determinant = max(variance.x * variance.y - covariance * covariance, own * own);
    let d = half.xy / half.z - first.xy;
    let squared = (variance.y * d.x * d.x - 2.0 * covariance * d.x * d.y + variance.x * d.y * d.y) / determinant;
    return exp(-0.5 * max(squared, 0.0)) / (TAU * sqrt(determinant)) / (half.z * half.z * half.z);
}

fn shade(lookup: Lookup, lod: f32, light: LocalLight, material: Material) -> vec3f {
    let first = channel_layer(lookup, lod, 0u);
    let second = channel_layer(lookup, lod, 1u);
    let specular = slope_density(first, second, material.exponent, light.half_in_tangent);
    return reflect(material, vec3f(specular), dot(normalize(vec3f(first.xy, 1.0)), light.light_in_tangent));
}

fn ndf_lobe_count() -> u32 {
    return 1u;
}

// One isotropic lobe stands for the Gaussian: as wide as its two variances are on the mean.
fn ndf_lobe(lookup: Lookup, lod: f32, index: u32) -> NdfLobe {
    let first = channel_layer(lookup, lod, 0u);
    let variance = max(first.zw - first.xy * first.xy, vec2f(0.0));
    var lobe = lobe_of_normal(normalize(vec3f(first.xy, 1.0)));
    lobe.concentration = 1.0 / max(0.5 * (variance.x + variance.y), 1.0 / KAPPA_DELTA);
    return lobe;
}
