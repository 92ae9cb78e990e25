// Twin of filter/plain_mip.rs.

fn shade(lookup: Lookup, lod: f32, light: LocalLight, material: Material) -> vec3f {
    let normal = normalize_or_zero(mean_normal(lookup, lod));
    let half_cosine = dot(normal, light.half_in_tangent);
    return reflect(material, material.shininess, half_cosine, dot(normal, light.light_in_tangent));
}
