// Twin of filter/harmonics.rs and of sphere/harmonics.rs. Both parts of the material go together: sums hold the specular
// one per channel, then the diffuse one; pairs the half vector's value in x, the light's in y.

const PI: f32 = 3.1415927;

// sum_l (2l+1)/(4 pi) rho_l P_l(u).
fn zonal_series(cosine: vec2f) -> vec4f {
    let u = clamp(cosine, vec2f(-1.0), vec2f(1.0));
    var previous = vec2f(0.0);
    var current = vec2f(1.0);
    var sum = vec4f(0.0);
    for (var l = 0u; l <= method.parameter; l++) {
        let band = f32(l);
        sum += (2.0 * band + 1.0) * reflectance.multipliers[l] * current.xxxy;
        let next = ((2.0 * band + 1.0) * u * current - band * previous) / (band + 1.0);
        previous = current;
        current = next;
    }
    return sum / (4.0 * PI);
}

// The series between the base texels around a point, each one normal.
fn base_series(lookup: Lookup, light: LocalLight) -> vec4f {
    var taps = bilinear(lookup.uv, vec2i(textureDimensions(means)), frame.wraps != 0u);
    var sum = vec4f(0.0);
    for (var i = 0; i < 4; i++) {
        let normal = textureLoad(means, taps.texel[i], 0).xyz;
        if any(normal != vec3f(0.0)) {
            let cosine = vec2f(dot(normal, light.half_in_tangent), dot(normal, light.light_in_tangent));
            sum += taps.weight[i] * zonal_series(cosine);
        }
    }
    return sum;
}

// The normalised Legendre functions of l > m from those of l - 1 and l - 2.
fn legendre_step(l: f32, m: f32, z: vec2f, last: vec2f, second_last: vec2f) -> vec2f {
    let k = (l - 1.0) * (l - 1.0);
    let a = sqrt((4.0 * l * l - 1.0) / (l * l - m * m));
    // 0 where l = m + 1.
    let b = sqrt(max(k - m * m, 0.0) / (4.0 * k - 1.0 + select(0.0, 2.0, k == 0.0)));
    return a * (z * last - b * second_last);
}

// sum_lm rho_l gamma_lm Y_lm between the coarse levels around a point, in the order of the stored coefficients.
fn coarse_series(lookup: Lookup, lod: f32, light: LocalLight) -> vec4f {
    let x = vec2f(light.half_in_tangent.x, light.light_in_tangent.x);
    let y = vec2f(light.half_in_tangent.y, light.light_in_tangent.y);
    let z = vec2f(light.half_in_tangent.z, light.light_in_tangent.z);
    var diagonal = sqrt(0.25 / PI);
    var cosine = vec2f(1.0);
    var sine = vec2f(0.0);
    var sum = vec4f(0.0);
    var stored = vec4f(0.0);
    var index = 0u;
    for (var m = 0u; m <= method.parameter; m++) {
        if m > 0u {
            diagonal *= sqrt(f32(2u * m + 1u) / f32(2u * m));
            let turned = cosine * x - sine * y;
            sine = sine * x + cosine * y;
            cosine = turned;
        }
        var previous = vec2f(0.0);
        var current = vec2f(diagonal);
        for (var l = m; l <= method.parameter; l++) {
            if l > m {
                let next = legendre_step(f32(l), f32(m), z, current, previous);
                previous = current;
                current = next;
            }
            // Y_lm, then Y_l,-m.
            for (var side = 0u; side < min(m, 1u) + 1u; side++) {
                if index % 4u == 0u {
                    stored = channel_layer(lookup, lod, index / 4u);
                }
                let turn = select(sqrt(2.0) * select(cosine, sine, side == 1u), vec2f(1.0), m == 0u);
                sum += stored[index % 4u] * reflectance.multipliers[l] * (current * turn).xxxy;
                index++;
            }
        }
    }
    return sum;
}

fn shade(lookup: Lookup, lod: f32, light: LocalLight, material: Material) -> vec3f {
    // Base texels are not stored: below level 1 their series are blended in by hand.
    let base_share = clamp(1.0 - lod, 0.0, 1.0);
    var sum = vec4f(0.0);
    if base_share > 0.0 {
        sum += base_share * base_series(lookup, light);
    }
    if base_share < 1.0 {
        sum += (1.0 - base_share) * coarse_series(lookup, max(lod, 1.0), light);
    }
    let normal = normalize_or_zero(mean_normal(lookup, lod));
    let specular = sum.xyz * max(dot(normal, light.light_in_tangent), 0.0);
    return material.specular * specular * material.specular_color
        + material.diffuse * PI * sum.w * material.diffuse_color;
}

fn ndf_lobe_count() -> u32 {
    return 1u;
}

// The lobe of the same mean vector.
fn ndf_lobe(lookup: Lookup, lod: f32, index: u32) -> NdfLobe {
    let mean = mean_normal(lookup, lod);
    var lobe = lobe_of_mean(mean);
    lobe.weight = select(0.0, 1.0, any(mean != vec3f(0.0)));
    return lobe;
}
