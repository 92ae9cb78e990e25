//! Spherical harmonics of the NDF: `gamma_lm = E[Y_lm(n)]` averages linearly, and the effective BRDF is
//! `sum_l rho_l sum_m gamma_lm Y_lm(w)` (Han et al. 2007, section 5, eq. 11 and 12).
//!
//! The multipliers `rho_l` are the model's exact ones, or the paper's `exp(-l^2/(2s))` where the material's convolution
//! rule is [`ConvolutionRule::Paper`]; the diffuse part is the Lambertian's, which is s = 1. The specular
//! part takes the cosine of the normalised mean normal. Nothing is fitted; what the bands left out held is lost, so
//! sharp materials ring: about `sqrt(4 s)` bands are needed.
//!
//! A base texel is one normal, whose series is zonal, `sum_l (2l+1)/(4 pi) rho_l P_l(n . w)`: it needs no store, and
//! level 1 is the first that is kept. Coefficients stand in the order of [`each_harmonic`].

use std::f64::consts::PI;
use std::sync::{Arc, OnceLock};

use glam::{DVec3, DVec4, Vec3};

use super::channels::ChannelPyramid;
use super::rival::{Built, Parameter, Rival, RivalFilter, RivalKind, Source};
use super::vmf::{Cancelled, Monitor};
use super::{EffectiveBrdf, Filter, LocalLight, LocalSky, Lookup, NdfLobe, PlainMip};
use crate::brdf::{Brdf, ConvolutionRule, Material};
use crate::ndf::Ndf;
use crate::normal_map::NormalMap;
use crate::normal_map::pyramid::Texel;
use crate::sphere::harmonics::{each_harmonic, harmonics_to, zonal_series};
use crate::sphere::vmf;

/// `sh:LMAX`.
pub static KIND: RivalKind = RivalKind {
    name: "sh",
    label: "sh l* =",
    parameter: Some(Parameter {
        symbol: "LMAX",
        range: [0, MAX_BAND as u8],
        most_drawn: 12,
        default: 7,
        offered: &[2, 4, 7, 12],
    }),
    has_channels: true,
    shader: include_str!("../../shaders/methods/harmonics.wgsl"),
    build,
};

/// The last band there may be: 529 coefficients a texel.
pub const MAX_BAND: usize = 22;

/// Harmonics of the NDF up to a band.
#[derive(Debug)]
pub struct Harmonics {
    mip: Arc<PlainMip>,
    last_band: usize,
    /// How the model's multipliers are found for effective BRDFs; pictures go by their material's rule.
    rule: ConvolutionRule,
    coefficients: OnceLock<Arc<ChannelPyramid>>,
}

fn build(source: &Source<'_>, rival: Rival) -> Built {
    Ok(Arc::new(Harmonics {
        mip: Arc::clone(source.mip),
        last_band: usize::from(rival.parameter).min(MAX_BAND),
        rule: source.rules.convolution,
        coefficients: OnceLock::new(),
    }))
}

impl Harmonics {
    /// The coefficients of level 1 and up.
    fn coefficients(&self, monitor: &Monitor) -> Result<&Arc<ChannelPyramid>, Cancelled> {
        if let Some(done) = self.coefficients.get() {
            return Ok(done);
        }
        let encode = |normal: Vec3, channels: &mut [f64]| {
            let mut next = channels.iter_mut();
            each_harmonic(normal.as_dvec3(), self.last_band, |_, value| {
                if let Some(channel) = next.next() {
                    *channel = value;
                }
            });
        };
        let count = harmonics_to(self.last_band);
        let made = ChannelPyramid::average(&self.mip.map, true, count, &encode, monitor)?;
        Ok(self.coefficients.get_or_init(|| Arc::new(made)))
    }

    /// The series of both parts between the coarse levels around a lookup.
    fn coarse(&self, pyramid: &ChannelPyramid, lookup: &Lookup, parts: &Parts) -> DVec4 {
        let taps = pyramid.taps(lookup);
        let (mut layer, mut stored) = (0, [0.0; 4]);
        let (mut sum, mut index) = (DVec4::ZERO, 0);
        // The light's harmonics beside the half vector's, which drive the loop.
        let mut of_light = [0.0; harmonics_to(MAX_BAND)];
        let mut next = of_light.iter_mut();
        each_harmonic(parts.light, self.last_band, |_, value| {
            if let Some(slot) = next.next() {
                *slot = value;
            }
        });
        each_harmonic(parts.half, self.last_band, |l, value| {
            if index % 4 == 0 {
                stored = pyramid.blend(&taps, layer).to_array();
                layer += 1;
            }
            let gamma = f64::from(stored[index % 4]);
            sum += gamma * parts.multipliers[l] * DVec3::splat(value).extend(of_light[index]);
            index += 1;
        });
        sum
    }

    /// The series of both parts between the base texels around a lookup.
    fn base(&self, lookup: &Lookup, parts: &Parts) -> DVec4 {
        let map = &self.mip.map;
        let mut sum = DVec4::ZERO;
        for (index, weight) in self.mip.grid(0).bilinear(lookup.uv) {
            let Some(normal) = map.normal(index).map(Vec3::as_dvec3) else { continue };
            let cosines = [normal.dot(parts.half), normal.dot(parts.light)];
            sum += f64::from(weight) * parts.zonal_series(cosines);
        }
        sum
    }
}

/// Both parts of the material: where they are looked at, and by which multipliers.
struct Parts {
    half: DVec3,
    light: DVec3,
    /// Of the specular part per channel, then of the diffuse one.
    multipliers: Vec<DVec4>,
}

impl Parts {
    fn new(light: &LocalLight, material: &Material, bands: usize) -> Self {
        let diffuse = Brdf::Lambert.multipliers(ConvolutionRule::Exact, bands);
        let specular = material.multipliers(bands);
        Self {
            half: light.half_in_tangent.as_dvec3(),
            light: light.light_in_tangent.as_dvec3(),
            multipliers: specular.into_iter().zip(diffuse).map(|(rgb, rho)| rgb.extend(rho)).collect(),
        }
    }

    /// `sum_l (2l+1)/(4 pi) rho_l P_l(u)` of each part, for its own cosine.
    fn zonal_series(&self, [half, light]: [f64; 2]) -> DVec4 {
        let channel = |c: usize| {
            let cosine = if c == 3 { light } else { half };
            zonal_series(self.multipliers.iter().map(|rho| rho[c]), cosine)
        };
        DVec4::from_array(std::array::from_fn(channel))
    }
}

impl RivalFilter for Harmonics {
    fn channels(&self, monitor: &Monitor) -> Result<Option<&Arc<ChannelPyramid>>, Cancelled> {
        self.coefficients(monitor).map(Some)
    }
}

impl Filter for Harmonics {
    fn map(&self) -> &NormalMap {
        &self.mip.map
    }

    fn effective_brdf_of(&self, texel: Texel, brdf: Brdf) -> EffectiveBrdf<'_> {
        let last_band = self.last_band;
        let multipliers = brdf.multipliers(self.rule, last_band + 1);
        let mut blurred = vec![0.0; harmonics_to(last_band)];
        for (normal, weight) in Ndf::of_texel(&self.mip.map, texel).samples() {
            let mut sums = blurred.iter_mut();
            each_harmonic(normal, last_band, |l, value| {
                if let Some(sum) = sums.next() {
                    *sum += weight * multipliers[l] * value;
                }
            });
        }
        Box::new(move |omega| {
            let (mut terms, mut sum) = (blurred.iter(), 0.0);
            each_harmonic(omega, last_band, |_, value| sum += terms.next().map_or(0.0, |term| term * value));
            sum
        })
    }

    fn mean_normal(&self, lookup: &Lookup) -> Option<Vec3> {
        Some(self.mip.mean(lookup))
    }

    fn shade(&self, lookup: &Lookup, light: &LocalLight, material: &Material) -> Vec3 {
        let parts = Parts::new(light, material, self.last_band + 1);
        let base_share = if self.mip.levels.len() == 1 { 1.0 } else { 1.0 - f64::from(lookup.lod.clamp(0.0, 1.0)) };
        let mut sum = DVec4::ZERO;
        if base_share > 0.0 {
            sum += base_share * self.base(lookup, &parts);
        }
        if base_share < 1.0
            && let Ok(pyramid) = self.coefficients(&Monitor::new(Vec::new()))
        {
            sum += (1.0 - base_share) * self.coarse(pyramid, lookup, &parts);
        }
        let normal = self.mip.mean(lookup).normalize_or_zero();
        let specular = sum.truncate().as_vec3() * normal.dot(light.light_in_tangent).max(0.0);
        self.mip.color(lookup)
            * (material.specular * specular * material.specular_color
                + material.diffuse * (PI * sum.w) as f32 * material.diffuse_color)
    }

    /// The lobe of the same mean vector, which is the NDF's band 1: to turn all bands into the sky's frame is too much
    /// for a pixel (Han et al. 2007, note 9).
    fn shade_sky(&self, lookup: &Lookup, sky: &LocalSky<'_>) -> Vec3 {
        let mean = self.mip.mean(lookup);
        let concentration = vmf::concentration(1.0 - f64::from(mean.length()));
        let normal = NdfLobe::normal(mean.normalize_or_zero());
        self.mip.color(lookup) * sky.shade(&NdfLobe { concentration, ..normal })
    }
}
