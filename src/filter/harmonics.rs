//! Spherical harmonics of the NDF: `gamma_lm = E[Y_lm(n)]` averages linearly, and the effective BRDF is
//! `sum_l rho_l sum_m gamma_lm Y_lm(w)` (Han et al. 2007, section 5, eq. 11 and 12).
//!
//! The multipliers `rho_l` are Blinn-Phong's exact ones, or the paper's `exp(-l^2/(2s))` where the material's
//! convolution rule is [`ConvolutionRule::Paper`]; the diffuse part is the Lambertian's, which is s = 1. The specular
//! part takes the cosine of the normalised mean normal. Nothing is fitted; what the bands left out held is lost, so
//! sharp materials ring: about `sqrt(4 s)` bands are needed.
//!
//! A base texel is one normal, whose series is zonal, `sum_l (2l+1)/(4 pi) rho_l P_l(n . w)`: it needs no store, and
//! level 1 is the first that is kept. Coefficients stand in the order of [`each_harmonic`].

use std::f64::consts::PI;
use std::sync::{Arc, OnceLock};

use glam::{DVec3, Vec3};

use super::channels::ChannelPyramid;
use super::rival::{Built, Parameter, Rival, RivalFilter, RivalKind, Source};
use super::vmf::{Cancelled, Monitor};
use super::{EffectiveBrdf, Filter, LocalLight, LocalSky, Lookup, NdfLobe, PlainMip};
use crate::brdf::{Brdf, ConvolutionRule, Material};
use crate::ndf::Ndf;
use crate::normal_map::pyramid::Texel;
use crate::sphere::harmonics::{
    cosine_power_zonal, cosine_power_zonal_of_paper, each_harmonic, harmonics_to, zonal_series,
};
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
    /// How Blinn-Phong's multipliers are found for effective BRDFs; pictures go by their material's rule.
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

/// `rho_l` of Blinn-Phong with exponent s for `l <= last_band`.
fn multipliers(rule: ConvolutionRule, exponent: f64, last_band: usize) -> Vec<f64> {
    match rule {
        ConvolutionRule::Paper => cosine_power_zonal_of_paper(exponent, last_band + 1),
        _ => cosine_power_zonal(exponent, last_band + 1),
    }
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
    fn coarse(&self, pyramid: &ChannelPyramid, lookup: &Lookup, [half, light]: [&Series; 2]) -> [f64; 2] {
        let taps = pyramid.taps(lookup);
        let (mut layer, mut stored) = (0, [0.0; 4]);
        let (mut sums, mut index) = ([0.0; 2], 0);
        // The light's harmonics beside the half vector's, which drive the loop.
        let mut of_light = [0.0; harmonics_to(MAX_BAND)];
        let mut next = of_light.iter_mut();
        each_harmonic(light.direction, self.last_band, |_, value| {
            if let Some(slot) = next.next() {
                *slot = value;
            }
        });
        each_harmonic(half.direction, self.last_band, |l, value| {
            if index % 4 == 0 {
                stored = pyramid.blend(&taps, layer).to_array();
                layer += 1;
            }
            let gamma = f64::from(stored[index % 4]);
            sums[0] += half.multipliers[l] * gamma * value;
            sums[1] += light.multipliers[l] * gamma * of_light[index];
            index += 1;
        });
        sums
    }

    /// The series of both parts between the base texels around a lookup.
    fn base(&self, lookup: &Lookup, series: [&Series; 2]) -> [f64; 2] {
        let map = &self.mip.map;
        let mut sums = [0.0; 2];
        for (index, weight) in self.mip.grid(0).bilinear(lookup.uv) {
            let Some(normal) = map.normal(index) else { continue };
            for (sum, series) in sums.iter_mut().zip(series) {
                let cosine = normal.as_dvec3().dot(series.direction);
                *sum += f64::from(weight) * zonal_series(series.multipliers.iter().copied(), cosine);
            }
        }
        sums
    }
}

/// One part of the material: where it is looked at and by which multipliers.
struct Series {
    direction: DVec3,
    multipliers: Vec<f64>,
}

impl RivalFilter for Harmonics {
    fn channels(&self, monitor: &Monitor) -> Result<Option<&Arc<ChannelPyramid>>, Cancelled> {
        self.coefficients(monitor).map(Some)
    }
}

impl Filter for Harmonics {
    fn effective_brdf_of(&self, texel: Texel, brdf: Brdf) -> EffectiveBrdf<'_> {
        let multipliers = match brdf {
            Brdf::Lambert => multipliers(ConvolutionRule::Exact, 1.0, self.last_band),
            Brdf::BlinnPhong(model) => multipliers(self.rule, model.shininess, self.last_band),
        };
        let last_band = self.last_band;
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

    fn shade(&self, lookup: &Lookup, light: &LocalLight, material: &Material) -> Vec3 {
        let half = Series {
            direction: light.half_in_tangent.as_dvec3(),
            multipliers: multipliers(material.convolution, material.shininess.into(), self.last_band),
        };
        let cosine = Series {
            direction: light.light_in_tangent.as_dvec3(),
            multipliers: multipliers(ConvolutionRule::Exact, 1.0, self.last_band),
        };
        let base_share = if self.mip.levels.len() == 1 { 1.0 } else { 1.0 - f64::from(lookup.lod.clamp(0.0, 1.0)) };
        let mut sums = [0.0; 2];
        let mut add = |share: f64, [specular, diffuse]: [f64; 2]| {
            sums[0] += share * specular;
            sums[1] += share * diffuse;
        };
        if base_share > 0.0 {
            add(base_share, self.base(lookup, [&half, &cosine]));
        }
        if base_share < 1.0
            && let Ok(pyramid) = self.coefficients(&Monitor::new(Vec::new()))
        {
            add(1.0 - base_share, self.coarse(pyramid, lookup, [&half, &cosine]));
        }
        let normal = self.mip.mean(lookup).normalize_or_zero();
        let specular = sums[0] as f32 * normal.dot(light.light_in_tangent).max(0.0);
        self.mip.color(lookup)
            * (material.specular * specular * material.specular_color
                + material.diffuse * (PI * sums[1]) as f32 * material.diffuse_color)
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
