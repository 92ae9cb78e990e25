//! Session files, `*.ndfi.json`: what the window shows, as JSON that others script against.
//!
//! Missing keys take their defaults; unknown keys are kept and reported. Paths are relative to the file.

use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

use super::{MapRequest, Session};
use crate::comparison::Comparison;
use crate::filter::vmf::FitSettings;
use crate::lit_surface::LitSurface;
use crate::normal_map::pyramid::Texel;
use crate::normal_map::{MapOptions, MapSource};

/// Which map a session shows.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum MapReference {
    /// A file, relative to the session file.
    Path(PathBuf),
    /// A bundled map.
    Bundled(String),
}

/// The contents of a session file.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct SessionFile {
    /// The map; the default bundled one where it is missing.
    pub map: Option<MapReference>,
    /// How the map is read.
    pub map_options: MapOptions,
    /// How it is fitted.
    pub fit: FitSettings,
    /// The lit surface: shape, camera, light, material, level, exposure.
    pub surface: LitSurface,
    /// The methods compared, and how they stand beside each other.
    pub comparison: Comparison,
    /// The selected texel.
    pub selected: Option<Texel>,
    /// Samples per pixel of the truth.
    pub truth_samples: Option<u32>,
    /// Keys of other versions and of the window's layout, kept as they are.
    #[serde(flatten)]
    pub other: Map<String, Value>,
}

/// Why a session file could not be read.
#[derive(Debug, thiserror::Error)]
pub enum SessionFileError {
    /// The file could not be read at all.
    #[error("'{path}' cannot be read: {cause}")]
    Read {
        /// The session file.
        path: String,
        /// What the system says.
        cause: std::io::Error,
    },
    /// The file is not a session.
    #[error("'{path}' is not a session file: {cause}")]
    Parse {
        /// The session file.
        path: String,
        /// What and where.
        cause: serde_json::Error,
    },
}

impl SessionFile {
    /// Reads a session file and makes the paths of the map and of its colour absolute.
    ///
    /// # Errors
    /// A sentence that names the file and the cause.
    pub fn read(path: &Path) -> Result<Self, SessionFileError> {
        let name = || path.display().to_string();
        let bytes = std::fs::read(path).map_err(|cause| SessionFileError::Read { path: name(), cause })?;
        let mut file: Self =
            serde_json::from_slice(&bytes).map_err(|cause| SessionFileError::Parse { path: name(), cause })?;
        if let (Some(MapReference::Path(map)), Some(folder)) = (&mut file.map, path.parent()) {
            *map = folder.join(&*map);
        }
        if let (Some(color), Some(folder)) = (&mut file.map_options.color, path.parent()) {
            *color = folder.join(&*color);
        }
        Ok(file)
    }

    /// The request that opens the session's map, if it names one.
    pub fn map_request(&self) -> Option<MapRequest> {
        let options = self.map_options.clone();
        Some(match self.map.clone()? {
            MapReference::Path(path) => MapRequest::File { path, options },
            MapReference::Bundled(name) => MapRequest::Bundled { name, options },
        })
    }
}

impl Session {
    /// What the session shows, as a file's contents; paths are left absolute.
    pub fn to_file(&self) -> SessionFile {
        SessionFile {
            map: Some(match &self.map.source {
                MapSource::File(path) => MapReference::Path(path.clone()),
                MapSource::Bundled(name) => MapReference::Bundled((*name).to_owned()),
            }),
            map_options: self.map.options.clone(),
            fit: *self.fit_settings(),
            surface: self.surface.clone(),
            comparison: self.comparison,
            selected: Some(self.selected),
            truth_samples: Some(self.truth_samples),
            other: Map::new(),
        }
    }

    /// Takes everything but the map from a file's contents, before the first fit starts.
    pub fn apply(&mut self, file: &SessionFile) {
        self.surface = file.surface.clone();
        self.comparison = file.comparison;
        self.truth_samples = file.truth_samples.unwrap_or(self.truth_samples);
        if let Some(texel) = file.selected {
            self.select(texel);
        }
        if file.fit != *self.fit_settings() {
            self.fitting.restart(file.fit);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lighting::Light;

    #[test]
    fn a_session_file_keeps_what_it_does_not_know_and_defaults_what_it_lacks() {
        let text = r#"{"fit": {"lobes": 3, "align": "paper:0.1"}, "future": {"x": 1}}"#;
        let file: SessionFile = serde_json::from_str(text).expect("valid JSON");
        assert_eq!(file.fit.lobes, 3);
        assert_eq!(file.fit.iterations, FitSettings::default().iterations);
        assert_eq!(file.surface, LitSurface::default());
        assert!(serde_json::to_string(&file).expect("serialises").contains(r#""future":{"x":1}"#));
    }

    #[test]
    fn a_session_of_one_light_is_read_as_before() {
        let text = r#"{"surface": {"light": {"azimuth_deg": 12.0, "elevation_deg": 30.0, "intensity": 2.0}}}"#;
        let file: SessionFile = serde_json::from_str(text).expect("valid JSON");
        let light = Light { azimuth_deg: 12.0, elevation_deg: 30.0, intensity: 2.0, ..Light::DEFAULT };
        assert_eq!(file.surface.lights, light.into());
        let written = serde_json::to_value(&file).expect("serialises");
        assert_eq!(written["surface"]["lights"][0]["azimuth_deg"], 12.0);
        assert!(written["surface"].get("light").is_none() && written["other"].is_null());
    }
}
