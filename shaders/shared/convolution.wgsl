// Twin of brdf/convolution.rs.

const PAPER: u32 = 0u;
const SHIFTED_EXPONENT: u32 = 1u;
const MOMENT: u32 = 2u;
const EXACT: u32 = 3u;

// The clamped cosine, and its convolution with the lobe.
const COSINE: u32 = 0u;
const EXACT_COSINE: u32 = 1u;

// Concentrations between which lobes that stand for a model give way to the model itself.
const SHARP = vec2f(1e4, 1e6);

// The share of the model itself under a lobe of concentration `kappa`.
fn own_share(kappa: f32) -> f32 {
    return clamp(log(max(kappa, 1.0) / SHARP.x) / log(SHARP.y / SHARP.x), 0.0, 1.0);
}

// A lobe's max(n . w, 0), for the cosine between its mean direction and the light.
fn diffuse_cosine(rule: u32, kappa: f32, cosine: f32) -> f32 {
    if EXACT_RULES {
        if rule == EXACT_COSINE {
            if kappa > KAPPA_MAX {
                return 0.5 * TAU * blinn_phong(blurred_exponent(SHIFTED_EXPONENT, kappa, 1.0), cosine);
            }
            return 0.5 * TAU * exact_convolved(OF_LAMBERTIAN, kappa, 1.0, cosine);
        }
    }
    return max(cosine, 0.0);
}

// The exponent of Blinn-Phong with exponent `shininess` convolved with a lobe of concentration `kappa`.
fn blurred_exponent(rule: u32, kappa: f32, shininess: f32) -> f32 {
    switch rule {
        case PAPER: {
            return kappa * shininess / (kappa + shininess);
        }
        case MOMENT: {
            // (2m-1)/(1-m) with m = A (s+1)/(s+2), written with 1-m = (1 + (s+1)(1-A))/(s+2): m itself rounds to 1.
            var shortfall = 1.0 / max(kappa, 1.0);
            if kappa <= 50.0 {
                shortfall = 1.0 - mean_resultant_length(kappa);
            }
            return max((shininess + 2.0) / (1.0 + (shininess + 1.0) * shortfall) - 2.0, 0.0);
        }
        default: {
            return max(kappa * (shininess + 1.0) / (kappa + shininess + 1.0) - 1.0, 0.0);
        }
    }
}

// A Blinn-Phong lobe that stands for a part of a model, convolved with a lobe: twin of brdf/blurred_powers.rs.
fn blurred_power(rule: u32, kappa: f32, shininess: f32, cosine: f32) -> f32 {
    if shininess >= 1.0 {
        return blinn_phong(blurred_exponent(rule, kappa, shininess), cosine);
    }
    // All but a step at the horizon, which becomes a Gaussian one.
    let steepness = kappa / sqrt(kappa + 8.0 / (0.5 * TAU));
    let x = clamp(steepness * cosine, -8.0, 8.0);
    let lit = 1.0 / (1.0 + exp(-x * (1.5976 + 0.07056 * x * x)));
    let reach = 2.0 / (0.5 * TAU) / max(steepness * steepness, 1e-12);
    let far = sqrt(cosine * cosine + reach);
    // The sum cancels below the horizon.
    let rise = select(0.5 * reach / (far - cosine), 0.5 * (cosine + far), cosine > 0.0);
    return (shininess + 1.0) / TAU * exp((1.0 - shininess) * log(lit) + shininess * log(rise));
}
