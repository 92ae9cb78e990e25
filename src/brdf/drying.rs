//! A material that dries: while it does, the highlight weakens and widens and the diffuse part brightens.
//!
//! Measured surfaces follow `p(t) = p_dry + (p_wet - p_dry) exp(-lambda t)` in every parameter (Sun, Sunkavalli,
//! Ramamoorthi, Belhumeur and Nayar 2007), which Han et al. 2007 animate in their figure 8. Here t runs from 0 to 1 and
//! the law is scaled to end dry; the exponent goes by its logarithm. The fit knows nothing of it.

use serde::{Deserialize, Serialize};

use super::{Ggx, Material, Model, TorranceSparrow};

/// How much of the way the law's exponential has gone at the end: `1 - exp(-3)`, 95 %.
const LAMBDA: f32 = 3.0;

/// What changes of a material.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Moment {
    /// Specular strength Ks.
    pub specular: f32,
    /// Diffuse strength Kd.
    pub diffuse: f32,
    /// The exponent of the Blinn-Phong as wide as the specular part.
    pub exponent: f32,
}

/// The track from wet to dry.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Drying {
    /// At t = 0.
    pub wet: Moment,
    /// At t = 1.
    pub dry: Moment,
}

impl Default for Drying {
    fn default() -> Self {
        Self {
            wet: Moment { specular: 0.2, diffuse: 0.3, exponent: 300.0 },
            dry: Moment { specular: 0.03, diffuse: 0.7, exponent: 12.0 },
        }
    }
}

impl Drying {
    /// The moment at time t, 0 to 1.
    pub fn at(&self, time: f32) -> Moment {
        let gone = (1.0 - (-LAMBDA * time.clamp(0.0, 1.0)).exp()) / (1.0 - (-LAMBDA).exp());
        let between = |wet: f32, dry: f32| wet + (dry - wet) * gone;
        Moment {
            specular: between(self.wet.specular, self.dry.specular),
            diffuse: between(self.wet.diffuse, self.dry.diffuse),
            exponent: between(self.wet.exponent.ln(), self.dry.exponent.ln()).exp(),
        }
    }
}

impl Material {
    /// What of it may change while it dries.
    pub fn moment(&self) -> Moment {
        Moment { specular: self.specular, diffuse: self.diffuse, exponent: self.exponent() }
    }

    /// Takes a moment of a track; a measured model keeps its width.
    pub fn set_moment(&mut self, moment: Moment) {
        (self.specular, self.diffuse) = (moment.specular, moment.diffuse);
        let exponent = f64::from(moment.exponent);
        match self.model {
            Model::BlinnPhong => self.shininess = moment.exponent,
            Model::TorranceSparrow => self.sigma = TorranceSparrow::of_exponent(exponent).sigma as f32,
            Model::Ggx => self.alpha = Ggx::of_exponent(exponent).alpha as f32,
            Model::Measured | Model::Lambert => {}
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn while_it_dries_the_highlight_falls_and_widens_and_the_diffuse_part_rises() {
        let drying = Drying::default();
        let moments: Vec<Moment> = (0..=10).map(|i| drying.at(i as f32 / 10.0)).collect();
        for pair in moments.windows(2) {
            let [earlier, later] = [pair[0], pair[1]];
            assert!(later.specular < earlier.specular && later.exponent < earlier.exponent, "{pair:?}");
            assert!(later.diffuse > earlier.diffuse, "{pair:?}");
        }
        assert!((moments[0].exponent - 300.0).abs() < 1e-3 && (moments[10].exponent - 12.0).abs() < 1e-4);
    }

    #[test]
    fn every_model_takes_a_moments_width() {
        for model in [Model::BlinnPhong, Model::TorranceSparrow, Model::Ggx] {
            let mut material = Material { model, ..Material::DEFAULT };
            let moment = Moment { specular: 0.4, diffuse: 0.2, exponent: 37.0 };
            material.set_moment(moment);
            let found = material.moment();
            assert!((found.exponent - 37.0).abs() < 1e-3, "{model:?}: {found:?}");
            assert_eq!((found.specular, found.diffuse), (0.4, 0.2));
        }
    }
}
