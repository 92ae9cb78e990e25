// Follows shared/vmf.wgsl; LOBES is the exporter's to write before it.

struct Material {
    // Ks times the specular colour, linear RGB.
    specular: vec3f,
    // Blinn-Phong exponent s.
    shininess: f32,
    // Kd times the diffuse colour, linear RGB.
    diffuse: vec3f,
    padding: f32,
}

@group(0) @binding(0) var lobes: texture_2d_array<f32>;
@group(0) @binding(1) var trilinear: sampler;
@group(0) @binding(2) var<uniform> material: Material;

const TAU: f32 = 6.2831855;

// Weights below this are an empty slot.
const EMPTY_WEIGHT: f32 = 1e-7;

// What one stored lobe reflects: Blinn-Phong of exponent s convolved with it has the exponent s' with
// s' + 1 = kappa (s + 1) / (kappa + s + 1).
fn shade_lobe(stored: vec4f, light_in_tangent: vec3f, half_in_tangent: vec3f) -> vec3f {
    let resultant = stored.yzw / stored.x;
    let r = length(resultant);
    let mu = resultant / max(r, 1e-12);
    let kappa = concentration(1.0 - r);
    let exponent = max(kappa * (material.shininess + 1.0) / (kappa + material.shininess + 1.0) - 1.0, 0.0);
    let specular = (exponent + 1.0) / TAU * pow(max(dot(mu, half_in_tangent), 1e-6), exponent);
    return stored.x * (material.specular * specular + material.diffuse) * max(dot(mu, light_in_tangent), 0.0);
}

@fragment
fn shade(
    @location(0) uv: vec2f,
    @location(1) light_in_tangent: vec3f,
    @location(2) eye_in_tangent: vec3f,
) -> @location(0) vec4f {
    let light = normalize(light_in_tangent);
    let half_way = normalize(light + normalize(eye_in_tangent));
    var radiance = vec3f(0.0);
    for (var slot = 0u; slot < LOBES; slot++) {
        let stored = textureSample(lobes, trilinear, uv, slot);
        if stored.x > EMPTY_WEIGHT {
            radiance += shade_lobe(stored, light, half_way);
        }
    }
    return vec4f(radiance, 1.0);
}
