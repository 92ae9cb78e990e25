//! Figures against one quantity: distance, lobes J, alignment C or shininess s.

use serde::{Deserialize, Serialize};

use super::measurer::{MeasureSettings, Point};
use crate::brdf::Model;
use crate::filter::vmf::{Alignment, FitSettings, Selection};
use crate::filter::{Method, MethodChoice};

/// The quantity that is varied; all else stays as it is open.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Axis {
    /// From the eye to the surface's centre; the plane is two units wide.
    #[default]
    Distance,
    /// Lobes per texel J, the same in every texel.
    Lobes,
    /// The strength of the alignment that is chosen: C of `paper` and `map`, the neighbours' share b of `smooth`.
    Alignment,
    /// The exponent s of a Blinn-Phong material.
    Shininess,
}

impl Axis {
    /// Every axis, in the order they are offered.
    pub const ALL: [Self; 4] = [Self::Distance, Self::Lobes, Self::Alignment, Self::Shininess];

    /// The name to show.
    pub fn label(self) -> &'static str {
        match self {
            Self::Distance => "Distance",
            Self::Lobes => "Lobes J",
            Self::Alignment => "Alignment C",
            Self::Shininess => "Shininess s",
        }
    }

    /// The name in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Distance => "distance",
            Self::Lobes => "lobes",
            Self::Alignment => "alignment",
            Self::Shininess => "shininess",
        }
    }

    /// What the axis of a plot says.
    pub fn axis_label(self, fit: &FitSettings) -> &'static str {
        match (self, fit.align) {
            (Self::Distance, _) => "distance from the eye (the plane is 2 wide)",
            (Self::Lobes, _) => "lobes per texel J",
            (Self::Alignment, Alignment::Smooth { .. }) => "neighbours' share b of smooth alignment",
            (Self::Alignment, Alignment::Paper { .. }) => "strength C of alignment, as in eq. 23",
            (Self::Alignment, Alignment::Map { .. } | Alignment::None) => "strength C of alignment, exact prior",
            (Self::Shininess, _) => "shininess s",
        }
    }

    /// Values from one end to the other; none where there is nothing to vary.
    pub fn values(self, fit: &FitSettings) -> Vec<f32> {
        match (self, fit.align) {
            (Self::Distance, _) => vec![1.5, 2.0, 3.0, 4.0, 6.0, 8.0, 12.0, 16.0, 24.0],
            (Self::Lobes, _) => (1_u8..=8).map(f32::from).collect(),
            (Self::Alignment, Alignment::None) => Vec::new(),
            (Self::Alignment, Alignment::Smooth { .. }) => vec![0.0, 0.05, 0.1, 0.15, 0.2, 0.3, 0.45, 0.6, 0.9],
            (Self::Alignment, Alignment::Paper { .. } | Alignment::Map { .. }) => vec![0.03, 0.1, 0.3, 1.0, 3.0, 10.0],
            (Self::Shininess, _) => (2..=10).map(|power| 2.0_f32.powi(power)).collect(),
        }
    }

    /// True where ratios of the values matter rather than differences.
    pub fn is_logarithmic(self, fit: &FitSettings) -> bool {
        match self {
            Self::Distance | Self::Shininess => true,
            Self::Lobes => false,
            Self::Alignment => !matches!(fit.align, Alignment::Smooth { .. }),
        }
    }

    /// `base` with this value of the quantity.
    pub fn point(self, base: &Point, value: f32) -> Point {
        let mut point = base.clone();
        match self {
            Self::Distance => point.surface.camera.distance = value,
            Self::Shininess => {
                let material = &mut point.surface.material;
                (material.model, material.shininess) = (Model::BlinnPhong, value);
            }
            Self::Lobes => {
                let lobes = value.round().max(1.0) as usize;
                point.fit = FitSettings { lobes, selection: Selection::Fixed, ..point.fit };
            }
            Self::Alignment => match &mut point.fit.align {
                Alignment::None => {}
                Alignment::Smooth { blend } => *blend = value,
                Alignment::Paper { c } | Alignment::Map { c } => *c = value,
            },
        }
        point
    }
}

/// What is to be measured.
#[derive(Clone, Debug, PartialEq)]
pub struct Sweep {
    /// The quantity that is varied.
    pub axis: Axis,
    /// Its values.
    pub values: Vec<f32>,
    /// How every point is measured.
    pub settings: MeasureSettings,
}

impl Sweep {
    /// Pixels across and down: enough for steady means, few enough to be drawn between a window's frames.
    pub const SIZE: [u32; 2] = [320, 200];
    /// Samples per pixel of the truth.
    pub const SAMPLES: u32 = 256;
    /// Frames of the dolly of the temporal change.
    pub const DOLLY_FRAMES: usize = 4;

    /// The axis from end to end by these methods, the temporal change too where it is asked for.
    pub fn new(axis: Axis, fit: &FitSettings, methods: &[Method], temporal: bool) -> Self {
        let settings = MeasureSettings {
            methods: methods.iter().map(|&method| MethodChoice { method, lobes: None }).collect(),
            size: Self::SIZE,
            truth_samples: Self::SAMPLES,
            timed_frames: 0,
            dolly_frames: if temporal { Self::DOLLY_FRAMES } else { 0 },
            keeps_pictures: false,
        };
        Self { axis, values: axis.values(fit), settings }
    }

    /// The points of the sweep around `base`.
    pub fn points(&self, base: &Point) -> Vec<Point> {
        self.values.iter().map(|&value| self.axis.point(base, value)).collect()
    }

    /// How many figures there will be: one for each method at each point.
    pub fn steps(&self) -> usize {
        self.values.len() * self.settings.methods.len()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lit_surface::LitSurface;

    #[test]
    fn an_axis_varies_its_own_quantity_alone() {
        let fit = FitSettings { align: Alignment::Paper { c: 2.0 }, ..FitSettings::default() };
        let base = Point { surface: LitSurface::default(), fit };
        for axis in Axis::ALL {
            let values = axis.values(&fit);
            let sweep = Sweep::new(axis, &fit, &[Method::Vmf], false);
            let points = sweep.points(&base);
            assert!(points.len() == values.len() && values.is_sorted() && values.len() >= 6);
            assert!(points.iter().all(|point| axis.point(point, 1.0) == axis.point(&base, 1.0)), "{axis:?}");
            assert!(points.windows(2).all(|pair| pair[0] != pair[1]), "{axis:?}");
        }
        let none = FitSettings { align: Alignment::None, ..fit };
        assert!(Axis::Alignment.values(&none).is_empty());
    }
}
