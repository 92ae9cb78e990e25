//! The figures that are plotted.

use serde::{Deserialize, Serialize};

use super::figures::{MethodFigures, Reference};

/// One kind of figure.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Metric {
    /// The normalised colour error.
    #[default]
    ColorError,
    /// The root of the mean squared difference.
    Rmse,
    /// The mean FLIP error.
    Flip,
    /// The mean change from frame to frame.
    TemporalChange,
}

impl Metric {
    /// Every metric, in the order they are offered.
    pub const ALL: [Self; 4] = [Self::ColorError, Self::Rmse, Self::Flip, Self::TemporalChange];

    /// The name to show.
    pub fn label(self) -> &'static str {
        match self {
            Self::ColorError => "Colour error",
            Self::Rmse => "RMSE",
            Self::Flip => "FLIP",
            Self::TemporalChange => "Temporal change",
        }
    }

    /// What an axis of it says: the name, and the unit where there is one.
    pub fn axis_label(self) -> &'static str {
        match self {
            Self::ColorError => "colour error, of the truth's length",
            Self::Rmse => "RMSE, linear RGB",
            Self::Flip => "mean FLIP, 0 to 1",
            Self::TemporalChange => "change per frame, of the truth's length",
        }
    }

    /// What it is, in a sentence with its source.
    pub fn explanation(self) -> &'static str {
        match self {
            Self::ColorError => {
                "Euclidean colour distance over the length of the truth's colour, averaged over the covered pixels \
                 (Tan et al. 2005)."
            }
            Self::Rmse => "Root of the mean squared difference over the covered pixels, linear RGB.",
            Self::Flip => "Mean FLIP error of the pictures as they are displayed (Andersson et al. 2020).",
            Self::TemporalChange => {
                "Mean colour distance from one frame of a dolly to the next, each frame 1/16 farther, over the length \
                 of the truth's colour (after Tan et al. 2005, figure 4). Best is what the truth itself changes."
            }
        }
    }

    /// The figure among those of a method.
    pub fn of(self, figures: &MethodFigures) -> Option<f64> {
        match self {
            Self::ColorError => figures.normalised_color_error,
            Self::Rmse => figures.rmse,
            Self::Flip => figures.flip,
            Self::TemporalChange => figures.temporal_change,
        }
    }

    /// What the truth shows beside the methods' figures: how sure it is of itself, or how much it changes.
    pub fn of_truth(self, reference: &Reference) -> Option<f64> {
        match self {
            Self::ColorError => reference.standard_error,
            Self::TemporalChange => reference.temporal_change,
            Self::Rmse | Self::Flip => None,
        }
    }
}
