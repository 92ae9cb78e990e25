//! What of exports is worth saving: what was exported last, and how.

use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use crate::export::lobe_shader::Language;
use crate::export::roughness::RoughnessSettings;
use crate::normal_map::MapSource;

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
    /// What was suggested for it last.
    #[serde(skip)]
    suggested: PathBuf,
}

impl ExportView {
    /// Where it goes unless another path is chosen: beside the map, named after it and after what is written.
    pub fn suggested_path(&self, map: &MapSource) -> PathBuf {
        let named = |stem: &str| format!("{stem}-{}.{}", self.kind.label().to_lowercase(), self.ending());
        match map {
            MapSource::File(path) => {
                path.with_file_name(named(&path.file_stem().unwrap_or_default().to_string_lossy()))
            }
            MapSource::Bundled(name) => named(name).into(),
        }
    }

    /// Takes the suggested path where none is typed, and its name into the folder that is typed where another thing is to
    /// be written than before.
    pub fn suggest(&mut self, map: &MapSource) {
        let suggestion = self.suggested_path(map);
        if self.suggested == suggestion {
            return;
        }
        let is_first = self.suggested.as_os_str().is_empty();
        let (typed, name) = (Path::new(self.typed_path.trim()), suggestion.file_name().unwrap_or_default());
        if typed.as_os_str().is_empty() {
            self.typed_path = suggestion.display().to_string();
        } else if !is_first {
            self.typed_path = typed.with_file_name(name).display().to_string();
        }
        self.suggested = suggestion;
    }

    /// The ending of the files that are written.
    pub fn ending(&self) -> &'static str {
        match self.kind {
            ExportKind::Roughness | ExportKind::Picture => "png",
            ExportKind::Slopes | ExportKind::Lobes => "exr",
            ExportKind::Shader => self.language.ending(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_path_is_suggested_and_follows_what_is_written_in_the_folder_that_is_typed() {
        let map = MapSource::File("maps/bark.png".into());
        let mut view = ExportView::default();
        view.suggest(&map);
        assert_eq!(view.typed_path, "maps/bark-roughness.png");
        view.typed_path = "out/mine.png".to_owned();
        view.suggest(&map);
        assert_eq!(view.typed_path, "out/mine.png", "what is typed stays");
        view.kind = ExportKind::Lobes;
        view.suggest(&map);
        assert_eq!(view.typed_path, "out/bark-lobes.exr");
        view.typed_path.clear();
        view.suggest(&map);
        assert_eq!(view.typed_path, "", "a field that was emptied stays empty");
        (view.kind, view.language) = (ExportKind::Shader, Language::Glsl);
        view.suggest(&MapSource::Bundled("plate"));
        assert_eq!(view.typed_path, "plate-shader.glsl");
        let mut typed = ExportView { typed_path: "mine.png".to_owned(), ..ExportView::default() };
        typed.suggest(&map);
        assert_eq!(typed.typed_path, "mine.png");
    }
}
