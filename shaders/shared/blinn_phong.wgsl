// Twin of brdf/blinn_phong.rs.

const PAPER: u32 = 0u;
const SHIFTED_EXPONENT: u32 = 1u;
const MOMENT: u32 = 2u;

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
