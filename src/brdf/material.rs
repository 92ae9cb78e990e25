//! What the lit surface is made of.

use glam::{DVec3, Vec3};

use super::blinn_phong::blinn_phong;
use super::fresnel::fresnel;
use super::{BlinnPhong, Brdf, ConvolutionRule, DiffuseRule, Ggx, Measured, Model, TorranceSparrow};

/// A Lambertian part and a specular one, of one of several models; the others keep their parameters.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(default)]
pub struct Material {
    /// The specular part's model.
    pub model: Model,
    /// Blinn-Phong exponent s.
    pub shininess: f32,
    /// Roughness sigma of the Torrance-Sparrow form.
    pub sigma: f32,
    /// Roughness alpha of GGX.
    pub alpha: f32,
    /// The measured reflectance that was read last; session files name its file apart.
    #[serde(skip)]
    pub measured: Option<Measured>,
    /// Specular strength Ks.
    pub specular: f32,
    /// Diffuse strength Kd.
    pub diffuse: f32,
    /// Linear RGB of the specular part.
    pub specular_color: Vec3,
    /// Linear RGB of the diffuse part.
    pub diffuse_color: Vec3,
    /// Strength `1 - F0` of Schlick's Fresnel factor on the specular part, 0 for none.
    pub fresnel: f32,
    /// How a lobe and the BRDF are convolved.
    pub convolution: ConvolutionRule,
    /// How a lobe reflects diffusely.
    pub diffuse_rule: DiffuseRule,
}

impl Material {
    /// What a new session starts with.
    pub const DEFAULT: Self = Self {
        model: Model::BlinnPhong,
        shininess: 64.0,
        sigma: 0.088,
        alpha: 0.22,
        measured: None,
        specular: 0.1,
        diffuse: 0.5,
        specular_color: Vec3::new(1.0, 0.96, 0.9),
        diffuse_color: Vec3::new(0.32, 0.36, 0.45),
        fresnel: 0.0,
        convolution: ConvolutionRule::ShiftedExponent,
        diffuse_rule: DiffuseRule::Cosine,
    };

    /// The specular part's model with its parameter.
    pub fn brdf(&self) -> Brdf {
        match (self.model, self.measured) {
            (Model::Lambert, _) => Brdf::Lambert,
            (Model::Measured, Some(measured)) => Brdf::Measured(measured),
            (Model::BlinnPhong | Model::Measured, _) => {
                Brdf::BlinnPhong(BlinnPhong { shininess: self.shininess.into() })
            }
            (Model::TorranceSparrow, _) => Brdf::TorranceSparrow(TorranceSparrow { sigma: self.sigma.into() }),
            (Model::Ggx, _) => Brdf::Ggx(Ggx { alpha: self.alpha.into() }),
        }
    }

    /// That by name, as the command line writes it, its parameter as short as it is kept.
    pub fn brdf_name(&self) -> String {
        let (brdf, mut own) = (self.brdf(), *self);
        match &Model::from(brdf).kind().parameter {
            Some(parameter) => format!("{}:{}", Model::from(brdf).kind().name, (parameter.field)(&mut own)),
            None => brdf.to_string(),
        }
    }

    /// Takes up a model with its parameter. A measured one is the whole reflectance: it is taken as it is, without a
    /// diffuse part beside it.
    pub fn set_brdf(&mut self, brdf: Brdf) {
        self.model = brdf.into();
        match brdf {
            Brdf::Lambert => {}
            Brdf::BlinnPhong(model) => self.shininess = model.shininess as f32,
            Brdf::TorranceSparrow(model) => self.sigma = model.sigma as f32,
            Brdf::Ggx(model) => self.alpha = model.alpha as f32,
            Brdf::Measured(measured) => {
                self.measured = Some(measured);
                (self.specular, self.specular_color, self.diffuse) = (1.0, Vec3::ONE, 0.0);
            }
        }
    }

    /// Ks, none for a material without a specular part.
    pub fn specular_strength(&self) -> f32 {
        if self.model == Model::Lambert { 0.0 } else { self.specular }
    }

    /// The exponent of the Blinn-Phong of the same width.
    pub fn exponent(&self) -> f32 {
        self.brdf().exponent() as f32
    }

    /// The material as it reflects where light and half vector are apart by an angle of this cosine: factors that do
    /// not depend on the normal are put on the specular part and are not filtered (Han et al. 2007, section 4.3).
    pub fn towards(&self, difference_cosine: f32) -> Self {
        Self { specular_color: self.unfiltered(difference_cosine) * self.specular_color, ..*self }
    }

    /// Those factors, per channel.
    pub fn unfiltered(&self, difference_cosine: f32) -> Vec3 {
        let fresnel = fresnel(self.fresnel, difference_cosine);
        match self.brdf() {
            Brdf::Lambert => Vec3::ZERO,
            Brdf::Measured(measured) => fresnel * measured.factor(difference_cosine),
            Brdf::BlinnPhong(_) | Brdf::TorranceSparrow(_) | Brdf::Ggx(_) => Vec3::splat(fresnel),
        }
    }

    /// The specular part's `f(u)` per channel, before its strength.
    pub fn specular_at(&self, cosine: f32) -> Vec3 {
        match self.model {
            Model::BlinnPhong => Vec3::splat(blinn_phong(self.shininess, cosine)),
            Model::Lambert | Model::TorranceSparrow | Model::Ggx | Model::Measured => {
                self.per_channel(|brdf| brdf.zonal(cosine.into()))
            }
        }
    }

    /// That convolved with a lobe of concentration `kappa`, at the cosine to the lobe's mean direction.
    pub fn blurred_at(&self, kappa: f64, cosine: f32) -> Vec3 {
        self.per_channel(|brdf| brdf.convolved(self.convolution, kappa, cosine.into()))
    }

    /// The multipliers per channel for `l < bands`.
    pub fn multipliers(&self, bands: usize) -> Vec<DVec3> {
        let [r, g, b] = self.channels().map(|brdf| brdf.multipliers(self.convolution, bands));
        (0..bands).map(|l| DVec3::new(r[l], g[l], b[l])).collect()
    }

    /// The model of each channel: the same three times, but of a measured reflectance.
    pub fn channels(&self) -> [Brdf; 3] {
        match self.brdf() {
            Brdf::Measured(measured) => measured.channels().map(Brdf::Measured),
            brdf => [brdf; 3],
        }
    }

    fn per_channel(&self, value: impl Fn(Brdf) -> f64) -> Vec3 {
        match self.channels() {
            [r, g, b] if r != g => DVec3::new(value(r), value(g), value(b)).as_vec3(),
            [all, ..] => Vec3::splat(value(all) as f32),
        }
    }
}

impl Default for Material {
    fn default() -> Self {
        Self::DEFAULT
    }
}
