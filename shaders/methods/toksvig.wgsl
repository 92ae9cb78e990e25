// Twin of filter/toksvig.rs.

fn widened_exponent(length: f32, exponent: f32) -> f32 {
    let bounded = min(length, 1.0);
    return exponent * bounded / (bounded + exponent * (1.0 - bounded));
}

fn shade(lookup: Lookup, lod: f32, light: LocalLight, material: Material) -> vec3f {
    let mean = mean_normal(lookup, lod);
    let normal = normalize_or_zero(mean);
    let exponent = widened_exponent(length(mean), material.exponent);
    let specular = blinn_phong(exponent, dot(normal, light.half_in_tangent));
    return reflect(material, vec3f(specular), dot(normal, light.light_in_tangent));
}

fn ndf_lobe_count() -> u32 {
    return 1u;
}

// Toksvig's exponent f s = kappa s / (kappa + s) is that of a lobe of kappa = |N| / (1 - |N|).
fn ndf_lobe(lookup: Lookup, lod: f32, index: u32) -> NdfLobe {
    let mean = mean_normal(lookup, lod);
    var lobe = lobe_of_normal(normalize_or_zero(mean));
    lobe.concentration = length(mean) / max(1.0 - length(mean), 1.0 / KAPPA_DELTA);
    return lobe;
}
