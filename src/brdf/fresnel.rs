//! Schlick's Fresnel factor, `F = F0 + (1 - F0) (1 - cos theta_d)^5` (Schlick 1994, eq. 15).
//!
//! theta_d is the angle between light and half vector, which does not depend on the normal: the factor multiplies what is
//! filtered and is not filtered itself (Han et al. 2007, section 4.3). It is written by the strength `1 - F0`, of which 0
//! leaves the material alone.

/// The factor of a material of strength `1 - F0`, for `cos theta_d`.
pub fn fresnel(strength: f32, cosine: f32) -> f32 {
    1.0 - strength * (1.0 - (1.0 - cosine.clamp(0.0, 1.0)).powi(5))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_is_f0_at_normal_incidence_and_1_at_grazing() {
        for f0 in [0.04_f32, 0.5, 1.0] {
            assert!((fresnel(1.0 - f0, 1.0) - f0).abs() < 1e-6 && (fresnel(1.0 - f0, 0.0) - 1.0).abs() < 1e-6);
        }
    }
}
