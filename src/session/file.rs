//! Session files, `*.ndfi.json`: what the window shows, as JSON that others script against.
//!
//! Missing keys take their defaults; unknown keys are kept and reported. Paths are relative to the file.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use path_clean::PathClean;
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

use super::{MapRequest, Message, Session, unknown_keys};
use crate::comparison::Comparison;
use crate::filter::vmf::FitSettings;
use crate::image_io::{WriteImageError, write_bytes_atomically};
use crate::lighting::SkySource;
use crate::lit_surface::LitSurface;
use crate::normal_map::pyramid::Texel;
use crate::normal_map::{MapOptions, MapSource};
use crate::scene::{ImportError, Model, ShapeKind};

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
    /// The sky that lights the surface; none where it is missing.
    pub sky: Option<SkySource>,
    /// The file of the mesh, where the shape is one; relative to the session file.
    pub mesh: Option<PathBuf>,
    /// The file of the measured reflectance, where one was read.
    pub measured: Option<PathBuf>,
    /// The methods compared, and how they stand beside each other.
    pub comparison: Comparison,
    /// The selected texel.
    pub selected: Option<Texel>,
    /// Samples per pixel of the truth.
    pub truth_samples: Option<u32>,
    /// The session file that the document is saved to, where this one is what the window keeps between runs.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub saved_as: Option<PathBuf>,
    /// The window's layout, as the window has it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub view: Option<Value>,
    /// Keys of other versions, at every depth, kept as they are.
    #[serde(skip)]
    pub unknown: Map<String, Value>,
    /// Where it was read from.
    #[serde(skip)]
    pub path: Option<PathBuf>,
}

/// Why a session file could not be read or written.
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
    /// The file could not be written.
    #[error(transparent)]
    Write(#[from] WriteImageError),
    /// The mesh that the session names cannot be read.
    #[error(transparent)]
    Mesh(#[from] ImportError),
}

impl SessionFile {
    /// The ending of session files that the window writes.
    pub const ENDING: &str = ".ndfi.json";

    /// True for a file that can only be a session: no map ends in `.json`.
    pub fn is_named_by(path: &Path) -> bool {
        path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("json"))
    }

    /// Reads a session file and the mesh that it names, and makes the paths in it absolute.
    ///
    /// # Errors
    /// A sentence that names the file and the cause.
    pub fn read(path: &Path) -> Result<Self, SessionFileError> {
        let name = || path.display().to_string();
        let bytes = std::fs::read(path).map_err(|cause| SessionFileError::Read { path: name(), cause })?;
        let mut file = Self::parse(&name(), &bytes)?;
        let folder = path.parent().unwrap_or(Path::new(""));
        file.for_each_path(|path| *path = folder.join(&*path).clean());
        file.read_mesh()?;
        Ok(Self { path: Some(path.to_owned()), ..file })
    }

    /// Reads the contents of a session file of this name; paths are left as they are.
    ///
    /// # Errors
    /// A sentence that names the file and the cause.
    pub fn parse(name: &str, bytes: &[u8]) -> Result<Self, SessionFileError> {
        let error = |cause| SessionFileError::Parse { path: name.to_owned(), cause };
        let mut all: Value = serde_json::from_slice(bytes).map_err(error)?;
        rename_old_keys(&mut all);
        let file: Self = serde_json::from_slice(bytes).map_err(error)?;
        let known = serde_json::to_value(&file).map_err(error)?;
        Ok(Self { unknown: unknown_keys::beyond(&all, &known), ..file })
    }

    /// The keys that this version does not know, in a sentence; `None` where it knows all.
    pub fn unknown_sentence(&self) -> Option<String> {
        let names = unknown_keys::names(&self.unknown);
        let path = self.path.as_deref().unwrap_or(Path::new("the session")).display();
        (!names.is_empty()).then(|| format!("'{path}' has keys that are unknown here and kept: {}.", names.join(", ")))
    }

    /// The contents as JSON, with every key that was kept.
    ///
    /// # Errors
    /// Never for what can be read back.
    pub fn to_json(&self) -> Result<String, serde_json::Error> {
        let mut all = serde_json::to_value(self)?;
        unknown_keys::merge(&self.unknown, &mut all);
        serde_json::to_string_pretty(&all)
    }

    /// Writes the contents, whole or not at all; paths become relative to the file where there is a way.
    ///
    /// # Errors
    /// A sentence that names the file and the cause.
    pub fn write(&self, path: &Path) -> Result<(), SessionFileError> {
        let absolute = |path: &Path| std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
        let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
        let folder = absolute(folder);
        let mut file = self.clone();
        file.for_each_path(|path| {
            let whole = absolute(path);
            *path = pathdiff::diff_paths(&whole, &folder).unwrap_or(whole);
        });
        let name = path.display().to_string();
        let json = file.to_json().map_err(|cause| SessionFileError::Parse { path: name, cause })?;
        Ok(write_bytes_atomically(path, format!("{json}\n").as_bytes())?)
    }

    fn for_each_path(&mut self, mut change: impl FnMut(&mut PathBuf)) {
        if let Some(MapReference::Path(map)) = &mut self.map {
            change(map);
        }
        [&mut self.map_options.color, &mut self.measured, &mut self.saved_as]
            .into_iter()
            .flatten()
            .for_each(&mut change);
        if let Some(SkySource::Path(sky)) = &mut self.sky {
            change(sky);
        }
        if let Some(mesh) = &mut self.mesh {
            change(mesh);
        }
    }

    /// Reads the mesh that the session names and has not read; one that names none shows the plane instead.
    ///
    /// # Errors
    /// One sentence that names the mesh and the cause.
    pub fn read_mesh(&mut self) -> Result<(), ImportError> {
        let shape = &mut self.surface.shape;
        if shape.kind == ShapeKind::Mesh && shape.model.is_none() {
            match &self.mesh {
                Some(mesh) => shape.model = Some(Arc::new(Model::read(mesh)?)),
                None => shape.kind = ShapeKind::Plane,
            }
        }
        Ok(())
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

/// Gives keys that sessions once had their names of today, so that they count as known.
fn rename_old_keys(all: &mut Value) {
    let surface = all.get_mut("surface").and_then(Value::as_object_mut);
    if let Some((surface, light)) = surface.and_then(|surface| surface.remove("light").map(|light| (surface, light))) {
        surface.insert("lights".to_owned(), light);
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
            sky: self.surface.sky.environment.as_ref().map(|sky| sky.source.clone()),
            mesh: self.surface.shape.model.as_ref().map(|model| model.path.clone()),
            measured: self.surface.material.measured.map(|measured| measured.measurement().name.clone().into()),
            comparison: self.comparison,
            selected: Some(self.selected),
            truth_samples: Some(self.truth_samples),
            saved_as: None,
            view: None,
            unknown: self.unknown.clone(),
            path: None,
        }
    }

    /// Takes everything but the map from a file's contents, before the first fit starts.
    pub fn apply(&mut self, file: &SessionFile) {
        self.take_settings(file);
        self.view.clone_from(&file.view);
        if file.fit != *self.fit_settings() {
            self.fitting.restart(file.fit);
        }
    }

    /// Takes everything from a file's contents. Another map is read in the background first, and the rest comes with
    /// it.
    pub fn restore(&mut self, file: SessionFile) {
        let here = self.to_file();
        if (&file.map, &file.map_options) == (&here.map, &here.map_options) {
            self.take_settings(&file);
            self.set_fit_settings(file.fit);
        } else {
            self.open(MapRequest::Session(Box::new(file)));
        }
    }

    /// A sky that is not read yet is read in the background.
    fn take_settings(&mut self, file: &SessionFile) {
        self.surface = file.surface.clone();
        if let (Some(path), None) = (&file.measured, self.surface.material.measured) {
            self.restore_measured(path.clone());
        }
        if let Some(sky) = file.sky.clone().filter(|_| self.surface.sky.environment.is_none()) {
            self.open_sky(sky);
        }
        self.comparison = file.comparison;
        self.truth_samples = file.truth_samples.unwrap_or(self.truth_samples);
        self.unknown.clone_from(&file.unknown);
        if let Some(texel) = file.selected {
            self.select(texel);
        }
    }

    /// Takes a session file whose map was adopted just now.
    pub(super) fn adopt_file(&mut self, file: SessionFile) {
        self.take_settings(&file);
        if let Some(sentence) = file.unknown_sentence() {
            self.report(Message::remark(sentence));
        }
        (self.view, self.path) = (file.view, file.path);
    }

    /// The window's layout of a session file that was opened since this was last asked.
    pub fn take_view(&mut self) -> Option<Value> {
        self.view.take()
    }

    /// Keeps, and names, what a layout of the window holds beyond the one that is `known`.
    pub fn keep_unknown_view(&mut self, read: &Value, known: &Value) {
        let view = unknown_keys::beyond(read, known);
        if !view.is_empty() {
            let unknown = Map::from_iter([("view".to_owned(), Value::Object(view))]);
            let file = SessionFile { unknown, path: self.path.clone(), ..SessionFile::default() };
            self.messages.extend(file.unknown_sentence().map(Message::remark));
            self.unknown.extend(file.unknown);
        }
    }

    /// The session file that is open, if one is.
    pub fn path(&self) -> Option<&Path> {
        self.path.as_deref()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lighting::{Light, ProceduralSky};

    fn parse(text: &str) -> SessionFile {
        SessionFile::parse("a.ndfi.json", text.as_bytes()).expect("a session")
    }

    #[test]
    fn a_fit_of_no_lobes_or_of_too_many_is_refused_with_the_reason() {
        for lobes in ["0", "17", "99999"] {
            let text = format!(r#"{{"fit": {{"lobes": {lobes}}}}}"#);
            let error = SessionFile::parse("a.ndfi.json", text.as_bytes()).expect_err("refused").to_string();
            assert!(error.contains(&format!("{lobes} lobes, not 1 to 16")), "{error}");
        }
    }

    #[test]
    fn a_session_file_defaults_what_it_lacks_and_keeps_and_names_what_it_does_not_know() {
        let file = parse(r#"{"fit": {"lobes": 3, "pace": 2}, "future": {"x": 1}}"#);
        assert_eq!(file.fit.lobes, 3);
        assert_eq!(file.fit.iterations, FitSettings::default().iterations);
        assert_eq!(file.surface, LitSurface::default());
        let sentence = file.unknown_sentence().expect("two keys are unknown");
        assert!(sentence.ends_with("kept: fit.pace, future.x."), "{sentence}");
        let again = parse(&file.to_json().expect("serialises"));
        assert_eq!(again, file);
        assert!(parse(r#"{"fit": {"lobes": 3}}"#).unknown_sentence().is_none());
    }

    #[test]
    fn a_material_of_the_first_versions_is_blinn_phong() {
        let material = parse(r#"{"surface": {"material": {"shininess": 10.0}}}"#).surface.material;
        assert_eq!((material.model, material.shininess), (crate::brdf::Model::BlinnPhong, 10.0));
    }

    #[test]
    fn paths_are_relative_to_the_file_and_found_again_from_anywhere() {
        let folder = tempfile::tempdir().expect("a folder");
        let (maps, sessions) = (folder.path().join("maps"), folder.path().join("sessions"));
        for path in [&maps, &sessions] {
            std::fs::create_dir(path).expect("a folder");
        }
        let map = Some(MapReference::Path(maps.join("bark.png")));
        let path = sessions.join("bark.ndfi.json");
        SessionFile { map: map.clone(), ..SessionFile::default() }.write(&path).expect("written");
        let text = std::fs::read_to_string(&path).expect("there");
        assert!(text.contains(r#""../maps/bark.png""#), "{text}");
        let MapReference::Path(read) = SessionFile::read(&path).expect("read").map.expect("a map") else {
            panic!("no path")
        };
        assert_eq!(read, maps.join("bark.png"));
    }

    #[test]
    fn what_is_no_session_is_said_with_its_name_and_place() {
        let error = SessionFile::parse("a.ndfi.json", br#"{"fit": 7}"#).expect_err("no settings").to_string();
        assert!(error.starts_with("'a.ndfi.json' is not a session file: ") && error.contains("line 1"), "{error}");
    }

    #[test]
    fn a_session_of_one_light_is_read_as_before() {
        let text = r#"{"surface": {"light": {"azimuth_deg": 12.0, "elevation_deg": 30.0, "intensity": 2.0}}}"#;
        let file = SessionFile::parse("old.json", text.as_bytes()).expect("a session");
        let light = Light { azimuth_deg: 12.0, elevation_deg: 30.0, intensity: 2.0, ..Light::DEFAULT };
        assert_eq!(file.surface.lights, light.into());
        assert_eq!(file.unknown_sentence(), None);
        let written = file.to_json().expect("serialises");
        assert_eq!(SessionFile::parse("new.json", written.as_bytes()).expect("a session").surface, file.surface);
    }

    #[test]
    fn a_session_names_its_sky_and_keeps_how_it_lights() {
        let parse = |text: &str| SessionFile::parse("sky.json", text.as_bytes()).expect("a session");
        let file = parse(r#"{"sky": {"path": "sky.exr"}, "surface": {"sky": {"rotation_deg": 40.0}}}"#);
        assert_eq!(file.sky, Some(SkySource::Path("sky.exr".into())));
        assert!((file.surface.sky.rotation_deg - 40.0).abs() < 1e-6 && file.surface.sky.environment.is_none());
        assert_eq!(parse(&file.to_json().expect("serialises")), file);
        let bundled = parse(r#"{"sky": {"bundled": "overcast"}}"#);
        assert_eq!(bundled.sky, Some(SkySource::Bundled(ProceduralSky::Overcast)));
    }
}
