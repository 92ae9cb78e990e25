//! The values of a level's texels, as a picture, the status line and the numbers in the texels all have them.

use egui::Color32;
use glam::Vec3;

use super::error_report::ErrorReport;
use super::map_shading::MapShading;
use super::texel_scale::{TexelScale, significant};
use crate::color::{LOBE_COLORS, linear_from_srgb, srgb8_from_linear};
use crate::filter::vmf::coherence::texel_coherence_deg;
use crate::filter::vmf::fold;
use crate::normal_map::pyramid::{Footprint, Texel};
use crate::session::Session;
use crate::sphere::Mixture;
use crate::sphere::mixture::used;

/// The colour of a texel without a valid normal, and of one whose truth lies below the horizon: on no scale.
pub const INVALID: [u8; 3] = [0, 128, 128];
/// The colour of a texel whose value is not known, or not yet: on no scale either.
pub const MISSING: [u8; 3] = [62, 66, 74];

/// The value of one texel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum TexelValue {
    /// A colour, sRGB.
    Color([u8; 3]),
    /// A number on the shading's scale.
    Number(f64),
    /// There is none: no normal under it is valid, or all reflect below the horizon.
    Invalid,
    /// Not known: not fitted, not worked out yet, or no such channel.
    Missing,
}

/// What is shown of the texels of any level.
#[derive(Clone, Copy)]
pub struct TexelValues<'a> {
    session: &'a Session,
    errors: &'a ErrorReport,
    shading: MapShading,
    scale: Option<TexelScale>,
}

impl<'a> TexelValues<'a> {
    /// What a shading shows of a session's texels.
    pub fn new(session: &'a Session, errors: &'a ErrorReport, shading: MapShading) -> Self {
        Self { session, errors, shading, scale: shading.scale(session) }
    }

    /// The session.
    pub fn session(&self) -> &'a Session {
        self.session
    }

    /// What is shown.
    pub fn shading(&self) -> MapShading {
        self.shading
    }

    /// What it depends on beside the shading: a picture made of others is stale.
    pub fn revisions(&self) -> [u64; 3] {
        let lobes = if self.shading.shows_lobes() { self.session.fitting().revision() } else { 0 };
        let errors = if self.shading == MapShading::Error { self.errors.revision() } else { 0 };
        [self.session.map_revision(), lobes, errors]
    }

    /// The mean normal of a texel, zero where none is valid.
    fn mean(&self, texel: Texel) -> Vec3 {
        let width = self.session.map().level_size(texel.level).0;
        self.session.mip().levels[texel.level][texel.y * width + texel.x]
    }

    fn mixture(&self, texel: Texel) -> Option<Mixture> {
        fold::mixture(self.session.lobes(), self.session.fitting().fold(), texel)
    }

    /// The value of a texel that the map has.
    pub fn value(&self, texel: Texel) -> TexelValue {
        let mean = self.mean(texel);
        let number = |number: Option<f64>| number.map_or(TexelValue::Missing, TexelValue::Number);
        match self.shading {
            MapShading::Red | MapShading::Green | MapShading::Blue | MapShading::Alpha => {
                number(self.stored_mean(texel))
            }
            _ if mean == Vec3::ZERO => TexelValue::Invalid,
            MapShading::Normal => TexelValue::Color(normal_color(mean)),
            MapShading::Slope => TexelValue::Number(f64::from(mean.truncate().length().atan2(mean.z).to_degrees())),
            MapShading::Length => TexelValue::Number(f64::from(mean.length())),
            MapShading::Lobes => self.mixture(texel).map_or(TexelValue::Missing, |mixture| mixed_color(&mixture)),
            MapShading::Count => number(self.count(texel)),
            MapShading::Kappa => number(self.mixture(texel).and_then(|mixture| mixture.mean_concentration())),
            MapShading::Coherence => number(texel_coherence_deg(self.session.lobes(), texel)),
            MapShading::Error => match self.errors.error(self.session, texel) {
                Some(error) if error.is_nan() => TexelValue::Invalid,
                error => number(error.map(|error| 100.0 * f64::from(error))),
            },
        }
    }

    fn count(&self, texel: Texel) -> Option<f64> {
        let lobes = self.session.lobes();
        if texel.level == 0 {
            return Some(1.0);
        }
        Some(used(lobes.level(texel.level)?.texel(texel.x, texel.y)) as f64)
    }

    /// The mean over the footprint, by area, of the channel as stored.
    fn stored_mean(&self, texel: Texel) -> Option<f64> {
        let map = self.session.map();
        let channel = self.shading.channel(&map.stored)?;
        let footprint = Footprint::new((map.width, map.height), map.level_size(texel.level), (texel.x, texel.y));
        let (mut sum, mut area) = (0.0, 0.0);
        for y in footprint.rows.start..footprint.rows.end {
            for x in footprint.columns.start..footprint.columns.end {
                let weight = f64::from(footprint.rows.weight(y) * footprint.columns.weight(x));
                sum += weight * map.stored.sample(x, y, channel);
                area += weight;
            }
        }
        Some(sum / area)
    }

    /// The colour of a texel.
    pub fn color(&self, texel: Texel) -> Color32 {
        let [r, g, b] = match (self.value(texel), &self.scale) {
            (TexelValue::Color(color), _) => color,
            (TexelValue::Number(number), Some(scale)) => scale.color(number),
            (TexelValue::Invalid, _) => INVALID,
            (TexelValue::Missing | TexelValue::Number(_), _) => MISSING,
        };
        Color32::from_rgb(r, g, b)
    }

    /// A texel's value in words; nothing for one that the shading has no number of.
    pub fn words(&self, texel: Texel) -> Option<String> {
        let name = self.shading.label();
        match (self.value(texel), &self.scale) {
            (TexelValue::Number(number), Some(scale)) => Some(format!("{name} {}", scale.written(number))),
            (TexelValue::Missing, Some(_)) => Some(format!("{name} not known")),
            (TexelValue::Invalid, Some(_)) => Some(format!("{name} none")),
            _ => None,
        }
    }

    /// What is written into a texel that is large enough, line by line.
    pub fn lines(&self, texel: Texel) -> Vec<String> {
        match (self.value(texel), &self.scale) {
            (TexelValue::Number(number), Some(scale)) => vec![scale.written(number)],
            (TexelValue::Color(_), _) if self.shading == MapShading::Normal => {
                // Adding 0 makes -0 plain.
                let written = |component: f32| format!("{:.2}", (100.0 * component).round() / 100.0 + 0.0);
                self.mean(texel).normalize_or_zero().to_array().map(written).into()
            }
            (TexelValue::Color(_), _) => self.lobe_lines(texel),
            (TexelValue::Invalid, _) => vec!["none".to_owned()],
            (TexelValue::Missing | TexelValue::Number(_), _) => vec!["–".to_owned()],
        }
    }

    /// The slots of a texel's lobes and their weights, the heaviest three.
    fn lobe_lines(&self, texel: Texel) -> Vec<String> {
        let mut lobes = self.mixture(texel).unwrap_or_default().lobes;
        lobes.sort_by(|a, b| b.1.weight.total_cmp(&a.1.weight));
        lobes.iter().take(3).map(|(slot, lobe)| format!("{}: {}", slot + 1, significant(lobe.weight))).collect()
    }
}

/// A normal as maps store it.
fn normal_color(mean: Vec3) -> [u8; 3] {
    (127.5 * (mean.normalize_or_zero() + Vec3::ONE)).round().to_array().map(|code| code as u8)
}

/// The lobes' colours mixed by weight, in linear light.
fn mixed_color(mixture: &Mixture) -> TexelValue {
    let linear = |slot: usize| {
        Vec3::from(LOBE_COLORS[slot % LOBE_COLORS.len()].map(|code| linear_from_srgb(f32::from(code) / 255.0)))
    };
    let mixed = mixture.lobes.iter().map(|(slot, lobe)| lobe.weight as f32 * linear(*slot)).sum();
    TexelValue::Color(srgb8_from_linear(mixed))
}
