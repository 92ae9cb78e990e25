// Twin of brdf/blinn_phong.rs. EXACT_RULES is the pass's to override.

const PAPER: u32 = 0u;
const SHIFTED_EXPONENT: u32 = 1u;
const MOMENT: u32 = 2u;
const EXACT: u32 = 3u;

// The clamped cosine, and its convolution with the lobe.
const COSINE: u32 = 0u;
const EXACT_COSINE: u32 = 1u;

const TAU: f32 = 6.2831855;

// (s+1)/(2 pi) max(u, 0)^s.
fn blinn_phong(shininess: f32, cosine: f32) -> f32 {
    // pow(0, 0) differs between processors; a cosine of 0 contributes only where the exponent is 0.
    var power = select(0.0, 1.0, shininess == 0.0);
    if cosine > 0.0 {
        power = exp(shininess * log(cosine));
    }
    return (shininess + 1.0) / TAU * power;
}

// Blinn-Phong of exponent `shininess` convolved with a lobe of concentration `kappa`, at the cosine to its direction.
fn convolved(rule: u32, kappa: f32, shininess: f32, cosine: f32) -> f32 {
    if EXACT_RULES {
        if rule == EXACT {
            return exact_convolved(OF_MATERIAL, kappa, shininess, cosine);
        }
    }
    return blinn_phong(blurred_exponent(rule, kappa, shininess), cosine);
}

// A lobe's max(n . w, 0), for the cosine between its mean direction and the light.
fn diffuse_cosine(rule: u32, kappa: f32, cosine: f32) -> f32 {
    if EXACT_RULES {
        if rule == EXACT_COSINE {
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
