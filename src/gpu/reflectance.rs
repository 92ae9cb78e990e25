//! The material as the surface's shader reads it.

use crate::brdf::projection::LOBES;
use crate::brdf::{Brdf, ConvolutionRule, DiffuseRule, Material, Model};

/// Bands of multipliers: as many as pictures of harmonics have.
pub const BANDS: usize = 13;

/// The material's numbers; `Material` in the shader.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct MaterialData {
    /// Linear RGB.
    pub specular_color: [f32; 3],
    /// Ks.
    pub specular: f32,
    /// Linear RGB.
    pub diffuse_color: [f32; 3],
    /// Kd.
    pub diffuse: f32,
    /// Of the Blinn-Phong of the same width.
    pub exponent: f32,
    /// sigma or alpha.
    pub roughness: f32,
    /// The specular part's f at the normal.
    pub peak: f32,
    /// Strength of the Fresnel factor.
    pub fresnel: f32,
    /// The convolution rule, by the shader's number.
    pub convolution: u32,
    /// The rule for the diffuse part, by the shader's number.
    pub diffuse_rule: u32,
    padding: [u32; 2],
}

/// The material with what is worked out of its model; `Reflectance` in the shader.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct ReflectanceData {
    /// The material.
    pub material: MaterialData,
    /// Blinn-Phong lobes that stand for the model: weight per channel, exponent.
    pub lobes: [[f32; 4]; LOBES],
    /// `rho_l` of the specular part per channel, then of the diffuse one.
    pub multipliers: [[f32; 4]; BANDS],
}

impl MaterialData {
    fn of_material(material: &Material) -> Self {
        Self {
            specular_color: material.specular_color.to_array(),
            specular: material.specular_strength(),
            diffuse_color: material.diffuse_color.to_array(),
            diffuse: material.diffuse,
            exponent: material.exponent(),
            roughness: match material.model {
                Model::TorranceSparrow => material.sigma,
                Model::Lambert | Model::BlinnPhong | Model::Ggx | Model::Measured => material.alpha,
            },
            peak: material.brdf().zonal(1.0) as f32,
            fresnel: material.fresnel,
            convolution: match material.convolution {
                ConvolutionRule::Paper => 0,
                ConvolutionRule::ShiftedExponent => 1,
                ConvolutionRule::Moment => 2,
                ConvolutionRule::Exact => 3,
            },
            diffuse_rule: match material.diffuse_rule {
                DiffuseRule::Cosine => 0,
                DiffuseRule::Exact => 1,
            },
            padding: [0; 2],
        }
    }
}

/// The lobes of every channel, whose exponents are the same.
fn lobes(material: &Material) -> [[f32; 4]; LOBES] {
    let [r, g, b] = material.channels().map(Brdf::lobes);
    std::array::from_fn(|k| [r[k].weight, g[k].weight, b[k].weight, r[k].shininess].map(|number| number as f32))
}

impl ReflectanceData {
    /// What the shader reads of a material.
    pub fn of_material(material: &Material) -> Self {
        let specular = material.multipliers(BANDS);
        let diffuse = Brdf::Lambert.multipliers(ConvolutionRule::Exact, BANDS);
        Self {
            material: MaterialData::of_material(material),
            lobes: lobes(material),
            multipliers: std::array::from_fn(|l| specular[l].extend(diffuse[l]).as_vec4().to_array()),
        }
    }
}
