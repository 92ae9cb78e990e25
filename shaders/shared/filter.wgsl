// Twin of filter/mod.rs.

// A Lambertian and a Blinn-Phong part.
struct Material {
    shininess: f32,
    specular: f32,
    diffuse: f32,
    convolution: u32,
    diffuse_rule: u32,
    specular_color: vec3f,
    diffuse_color: vec3f,
}

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

// (Ks f(h) + Kd) max(cos, 0) of one lobe or normal (Han et al. 2007, Algorithm 2), linear RGB.
fn reflect(material: Material, exponent: f32, half_cosine: f32, light_cosine: f32) -> vec3f {
    let specular = material.specular * blinn_phong(exponent, half_cosine);
    return (specular * material.specular_color + material.diffuse * material.diffuse_color) * max(light_cosine, 0.0);
}
