//! Which model a material's specular part follows.

use super::{Brdf, ModelKind, blinn_phong, ggx, measured, torrance_sparrow};

/// A model without its value, as session files name it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Model {
    /// No specular part.
    Lambert,
    /// Blinn-Phong, normalised.
    #[default]
    BlinnPhong,
    /// The Torrance-Sparrow form, a Gaussian of the angle.
    TorranceSparrow,
    /// GGX.
    Ggx,
    /// A measured reflectance; Blinn-Phong while none was read.
    Measured,
}

/// `lambert`.
static LAMBERT: ModelKind = ModelKind {
    name: "lambert",
    label: "Lambert",
    tooltip: "Lambert: the diffuse part alone, max(n.l, 0).",
    parameter: None,
};

impl Model {
    /// Every model, in the order they are offered.
    pub const ALL: [Self; 5] = [Self::BlinnPhong, Self::TorranceSparrow, Self::Ggx, Self::Measured, Self::Lambert];

    /// Its description.
    pub fn kind(self) -> &'static ModelKind {
        match self {
            Self::Lambert => &LAMBERT,
            Self::BlinnPhong => &blinn_phong::KIND,
            Self::TorranceSparrow => &torrance_sparrow::KIND,
            Self::Ggx => &ggx::KIND,
            Self::Measured => &measured::KIND,
        }
    }
}

impl From<Brdf> for Model {
    fn from(brdf: Brdf) -> Self {
        match brdf {
            Brdf::Lambert => Self::Lambert,
            Brdf::BlinnPhong(_) => Self::BlinnPhong,
            Brdf::TorranceSparrow(_) => Self::TorranceSparrow,
            Brdf::Ggx(_) => Self::Ggx,
            Brdf::Measured(_) => Self::Measured,
        }
    }
}
