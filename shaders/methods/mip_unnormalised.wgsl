// Twin of filter/plain_mip.rs, the mean normal left as it is.

fn shade(lookup: Lookup, lod: f32, light: LocalLight, material: Material) -> vec3f {
    let normal = mean_normal(lookup, lod);
    let specular = specular_at(material, dot(normal, light.half_in_tangent));
    return reflect(material, specular, dot(normal, light.light_in_tangent));
}

fn ndf_lobe_count() -> u32 {
    return 1u;
}

fn ndf_lobe(lookup: Lookup, lod: f32, index: u32) -> NdfLobe {
    return lobe_of_normal(mean_normal(lookup, lod));
}
