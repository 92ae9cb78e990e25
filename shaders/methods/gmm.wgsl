// Twin of filter/gmm.

const EMPTY_GAUSSIAN: f32 = 1e-7;

fn shade(lookup: Lookup, lod: f32, light: LocalLight, material: Material) -> vec3f {
    var specular = 0.0;
    var diffuse = 0.0;
    for (var slot = 0u; slot < method.parameter; slot++) {
        let stored = channel_layer(lookup, lod, slot);
        let weight = stored.x;
        if weight < EMPTY_GAUSSIAN {
            continue;
        }
        let mean = stored.yz / weight;
        let variance = max(stored.w / weight - 0.5 * dot(mean, mean), 0.0) + 1.0 / material.exponent;
        let normal = normalize(vec3f(mean, sqrt(max(1.0 - dot(mean, mean), 0.0))));
        let cosine = weight * max(dot(normal, light.light_in_tangent), 0.0);
        diffuse += cosine;
        if light.half_in_tangent.z > 0.0 {
            let apart = light.half_in_tangent.xy - mean;
            specular += cosine * exp(-0.5 * dot(apart, apart) / variance) / (TAU * variance);
        }
    }
    return material.specular * specular * material.specular_color + material.diffuse * diffuse * material.diffuse_color;
}

fn ndf_lobe_count() -> u32 {
    return method.parameter;
}

fn ndf_lobe(lookup: Lookup, lod: f32, index: u32) -> NdfLobe {
    let stored = channel_layer(lookup, lod, index);
    if stored.x < EMPTY_GAUSSIAN {
        return NdfLobe(0.0, vec3f(0.0, 0.0, 1.0), 0.0);
    }
    let mean = stored.yz / stored.x;
    let variance = max(stored.w / stored.x - 0.5 * dot(mean, mean), 1.0 / KAPPA_DELTA);
    let normal = normalize(vec3f(mean, sqrt(max(1.0 - dot(mean, mean), 0.0))));
    return NdfLobe(stored.x, normal, 1.0 / variance);
}
