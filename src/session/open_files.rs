//! The files of a session: maps, meshes and sessions that are read in the background, taken in, remembered and watched.

use std::path::PathBuf;
use std::sync::Arc;

use super::opening::{MapRequest, OpenedMap, Prepared};
use super::{Message, Offer, Session, default_selection, file, recent, watch};
use crate::normal_map::{MapOptions, MapSource, NormalMap};

impl Session {
    /// Opens a map in the background; the open one stays until the new one is read.
    pub fn open(&mut self, request: MapRequest) {
        if let Err(message) = self.opening.start(request, &self.wake) {
            self.report(Message::error(message));
        }
    }

    /// Asks for a file in the system's dialog, off the window's thread, then opens it.
    pub fn open_dialog(&mut self) {
        if let Err(message) = self.opening.start_dialog(self.options_for_another_map(), &self.wake) {
            self.report(Message::error(message));
        }
    }

    /// Opens a mesh in the background; the surface stays as it is until the mesh is read.
    pub fn open_mesh(&mut self, path: PathBuf) {
        if let Err(message) = self.mesh_opening.start(path, &self.wake) {
            self.report(Message::error(message));
        }
    }

    /// Asks for a mesh in the system's dialog, off the window's thread, then opens it.
    pub fn open_mesh_dialog(&mut self) {
        if let Err(message) = self.mesh_opening.start_dialog(&self.wake) {
            self.report(Message::error(message));
        }
    }

    /// How another map is read: by the conventions of the open one, which tend to come together, but as normals.
    pub fn options_for_another_map(&self) -> MapOptions {
        let MapOptions { green, addressing, color, .. } = self.map.options.clone();
        MapOptions { green, addressing, color, ..MapOptions::default() }
    }

    /// Reads the open map anew with other options.
    pub fn reopen(&mut self, options: MapOptions) {
        match &self.map.source {
            MapSource::File(path) => self.open(MapRequest::File { path: path.clone(), options }),
            MapSource::Bundled(name) => self.open(MapRequest::Bundled { name: (*name).to_owned(), options }),
        }
    }

    /// True while a map or a mesh is being read or asked for.
    pub fn is_opening(&self) -> bool {
        self.opening.is_running() || self.mesh_opening.is_running()
    }

    /// Maps opened lately, the latest first.
    pub fn recent(&self) -> &recent::RecentFiles {
        &self.recent
    }

    /// Lets the session remember opened maps across runs.
    pub fn remember_recent(&mut self) {
        self.recent = recent::RecentFiles::load();
    }

    /// Offers to read a map anew when its file has changed, from the next map on.
    pub fn watch_files(&mut self) {
        self.watches = true;
    }

    /// Offers to read the map anew where its file has changed.
    pub(super) fn poll_watch(&mut self) {
        if !self.watch.as_ref().is_some_and(watch::Watch::has_changed) {
            return;
        }
        let MapSource::File(path) = &self.map.source else { return };
        let request = MapRequest::File { path: path.clone(), options: self.map.options.clone() };
        let text = format!("'{}' has changed on disk.", path.display());
        let offer = Some(Box::new(Offer { label: "Reload", request }));
        self.report(Message { offer, ..Message::remark(text) });
    }

    /// Takes a mesh that was read, and opens the map that it brings; true if there was news.
    pub(super) fn poll_mesh(&mut self) -> bool {
        match self.mesh_opening.poll() {
            None => return false,
            Some(Err(message)) => self.report(message),
            Some(Ok(model)) => {
                for warning in &model.warnings {
                    self.report(Message::remark(format!("'{}': {warning}.", model.name())));
                }
                if model.has_normal_map {
                    self.open(MapRequest::File { path: model.path.clone(), options: MapOptions::default() });
                }
                self.surface.wear_on(Arc::new(model));
            }
        }
        true
    }

    /// Takes a map that was read, its fit or a new one, and the settings of its session file.
    pub(super) fn adopt(&mut self, prepared: Prepared) {
        let Prepared { opened: OpenedMap { map, fit, session }, mip, diagnosis } = prepared;
        self.remember(&map, session.as_deref());
        if map.level_sizes() != self.map.level_sizes() {
            self.selected = default_selection(&map);
        }
        (self.map, self.mip, self.diagnosis) = (map, mip.into(), diagnosis.into());
        self.map_revision += 1;
        self.watch = match &self.map.source {
            MapSource::File(path) if self.watches => watch::Watch::start(path, &self.wake),
            _ => None,
        };
        let settings = session.as_ref().map(|file| file.fit);
        if let Some(file) = session {
            self.adopt_file(*file);
        }
        match (fit, settings) {
            (Some(fit), settings) if settings.is_none_or(|settings| settings == fit.settings) => {
                self.fitting.adopt_fit(fit);
            }
            (_, settings) => {
                self.fitting.adopt(Arc::clone(&self.map));
                self.fitting.restart(settings.unwrap_or(*self.fitting.settings()));
                self.start_fit();
            }
        }
    }

    /// Remembers what was opened; another map belongs to no session file yet.
    fn remember(&mut self, map: &NormalMap, session: Option<&file::SessionFile>) {
        if session.is_none() && map.source != self.map.source {
            self.path = None;
        }
        let map_path = match &map.source {
            MapSource::File(path) => Some(path),
            MapSource::Bundled(_) => None,
        };
        let path = session.and_then(|file| file.path.as_ref()).or(map_path).cloned();
        if let Some(Err(error)) = path.map(|path| self.recent.push(&path)) {
            log::warn!("{error}");
        }
    }
}
