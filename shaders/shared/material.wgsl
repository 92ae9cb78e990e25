// Twin of brdf/material.rs. A pipeline is made for each MODEL.

const BLINN_PHONG: u32 = 0u;
const TORRANCE_SPARROW: u32 = 1u;
const GGX: u32 = 2u;
const MEASURED: u32 = 3u;

override MODEL: u32 = BLINN_PHONG;

// A Lambertian part and a specular one.
struct Material {
    specular_color: vec3f,
    specular: f32,
    diffuse_color: vec3f,
    diffuse: f32,
    // Of the Blinn-Phong of the same width.
    exponent: f32,
    // sigma or alpha.
    roughness: f32,
    // f at the normal.
    peak: f32,
    fresnel: f32,
    convolution: u32,
    diffuse_rule: u32,
}

// Blinn-Phong lobes that stand for a model (brdf/projection.rs), and bands of multipliers.
const MODEL_LOBES: u32 = 8u;
const BANDS: u32 = 13u;

struct Reflectance {
    material: Material,
    // Weight per channel, exponent.
    lobes: array<vec4f, MODEL_LOBES>,
    // rho_l of the specular part per channel, then of the diffuse one.
    multipliers: array<vec4f, BANDS>,
}

@group(0) @binding(2) var<uniform> reflectance: Reflectance;

// What multiplies the specular part unfiltered where light and half vector are apart by an angle of this cosine: it does
// not depend on the normal.
fn unfiltered(difference_cosine: f32) -> vec3f {
    let factor = vec3f(fresnel(reflectance.material.fresnel, difference_cosine));
    if MODEL == MEASURED {
        return factor * measured_factor(difference_cosine);
    }
    return factor;
}

// The material with that factor on its specular part.
fn with_factor(factor: vec3f) -> Material {
    var material = reflectance.material;
    material.specular_color *= factor;
    return material;
}

// Schlick's factor of strength 1 - F0; twin of brdf/fresnel.rs.
fn fresnel(strength: f32, cosine: f32) -> f32 {
    let rest = 1.0 - clamp(cosine, 0.0, 1.0);
    return 1.0 - strength * (1.0 - rest * rest * rest * rest * rest);
}

// The specular part's f(u) per channel, before its strength.
fn specular_at(material: Material, cosine: f32) -> vec3f {
    if MODEL == TORRANCE_SPARROW {
        return vec3f(torrance_sparrow(material.roughness, cosine));
    }
    if MODEL == GGX {
        return vec3f(ggx(material.roughness, material.peak, cosine));
    }
    if MODEL == MEASURED {
        return measured_at(cosine);
    }
    return vec3f(blinn_phong(material.exponent, cosine));
}

// The specular part's f convolved with a lobe, exactly.
fn exact_blurred(exponent: f32, kappa: f32, cosine: f32) -> vec3f {
    let red = exact_convolved(OF_MATERIAL, kappa, exponent, cosine);
    if MODEL == MEASURED {
        let green = exact_convolved(OF_MATERIAL + 1, kappa, exponent, cosine);
        return vec3f(red, green, exact_convolved(OF_MATERIAL + 2, kappa, exponent, cosine));
    }
    return vec3f(red);
}

// The same by the material's rule, for a lobe of concentration `kappa`, at the cosine to the lobe's mean direction.
fn blurred_at(material: Material, kappa: f32, cosine: f32) -> vec3f {
    if EXACT_RULES {
        if material.convolution == EXACT && kappa <= KAPPA_MAX {
            return exact_blurred(material.exponent, kappa, cosine);
        }
    }
    if MODEL == TORRANCE_SPARROW {
        return vec3f(torrance_sparrow(blurred_sigma(material.roughness, kappa), cosine));
    }
    if MODEL == GGX || MODEL == MEASURED {
        let share = own_share(kappa);
        var sum = vec3f(0.0);
        if share < 1.0 {
            for (var i = 0u; i < MODEL_LOBES; i++) {
                let lobe = reflectance.lobes[i];
                sum += lobe.xyz * blurred_power(material.convolution, kappa, lobe.w, cosine);
            }
        }
        if share > 0.0 {
            sum = mix(sum, specular_at(material, cosine), share);
        }
        return sum;
    }
    return vec3f(blinn_phong(blurred_exponent(material.convolution, kappa, material.exponent), cosine));
}
