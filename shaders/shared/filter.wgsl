// Twin of filter/mod.rs.

// A pixel's view of the map.
struct Lookup {
    uv: vec2f,
    uv_dx: vec2f,
    uv_dy: vec2f,
    pixel: vec2u,
}

// Light and view at a surface point, in the tangent space of the surface.
struct LocalLight {
    light_in_tangent: vec3f,
    half_in_tangent: vec3f,
}

// The unit vector along `v`, or zero where it has no length: normalize() would give NaN.
fn normalize_or_zero(v: vec3f) -> vec3f {
    let squared = dot(v, v);
    if squared > 1e-30 {
        return v * inverseSqrt(squared);
    }
    return vec3f(0.0);
}

// (Ks f(h) + Kd) max(cos, 0) of one lobe or normal (Han et al. 2007, Algorithm 2), linear RGB; `specular` is f(h).
fn reflect(material: Material, specular: vec3f, light_cosine: f32) -> vec3f {
    return (material.specular * specular * material.specular_color + material.diffuse * material.diffuse_color)
        * max(light_cosine, 0.0);
}
