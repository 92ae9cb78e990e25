//! What of exports is worth saving: what was exported last, and how.

use serde::{Deserialize, Serialize};

use crate::export::lobe_shader::Language;
use crate::export::roughness::RoughnessSettings;

/// What can be exported.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ExportKind {
    /// Roughness of every level.
    #[default]
    Roughness,
    /// Moments of slope of every level.
    Slopes,
    /// The lobes of every level.
    Lobes,
    /// The shader that lights the lobes.
    Shader,
    /// The lit surface as it is compared.
    Picture,
}

impl ExportKind {
    /// Every kind, in the order they are offered.
    pub const ALL: [Self; 5] = [Self::Roughness, Self::Slopes, Self::Lobes, Self::Shader, Self::Picture];

    /// The name to show.
    pub fn label(self) -> &'static str {
        match self {
            Self::Roughness => "Roughness",
            Self::Slopes => "Slopes",
            Self::Lobes => "Lobes",
            Self::Shader => "Shader",
            Self::Picture => "Picture",
        }
    }

    /// What is written.
    pub fn explanation(self) -> &'static str {
        match self {
            Self::Roughness => "A grey PNG per level, NAME.level.NN.png, or one OpenEXR file of all.",
            Self::Slopes => "Mean slopes and their second moments, six channels of OpenEXR.",
            Self::Lobes => "Every lobe of every level as OpenEXR, which opens again as a fit.",
            Self::Shader => "The shader that lights the lobes, with their layout.",
            Self::Picture => "The lit surface as it is compared, 1600 × 1000, as PNG.",
        }
    }
}

/// What is exported, and how.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct ExportView {
    /// What is written.
    pub kind: ExportKind,
    /// How roughness is.
    pub roughness: RoughnessSettings,
    /// The shader's language.
    pub language: Language,
    /// Whether the settings are written below a picture.
    pub caption: bool,
    /// The path that is being typed.
    #[serde(skip)]
    pub typed_path: String,
}

impl ExportView {
    /// The ending of the files that are written.
    pub fn ending(&self) -> &'static str {
        match self.kind {
            ExportKind::Roughness | ExportKind::Picture => "png",
            ExportKind::Slopes | ExportKind::Lobes => "exr",
            ExportKind::Shader => self.language.ending(),
        }
    }
}
