//! The one document: which map is open, how it is fitted and shown, and the lobes at hand. The window and the command
//! line drive the same one.
//!
//! Slow work runs in [`jobs`](crate::jobs); [`Session::poll`] takes their news. A newer request replaces an older
//! job, whose results then never appear. Whatever fails leaves the open map, a running fit and the settings as they
//! were.

pub mod file;
pub mod fitting;
pub mod opening;
pub mod recent;

use std::sync::Arc;
use std::time::Duration;

use crate::filter::vmf::{FitSettings, LobePyramid};
use crate::filter::{Method, PlainMip};
use crate::jobs::Wake;
use crate::lit_surface::LitSurface;
use crate::normal_map::pyramid::Texel;
use crate::normal_map::{MapOptions, MapSource, NormalMap, procedural};
use fitting::Fitting;
pub use opening::MapRequest;
use opening::Opening;

/// What is compared on the lit surface.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(default)]
pub struct Comparison {
    /// The method left of the wipe.
    pub left: Method,
    /// The method right of the wipe.
    pub right: Method,
    /// Where the wipe stands, `0..=1` from the left; 0 shows only the right method.
    pub wipe: f32,
}

impl Default for Comparison {
    fn default() -> Self {
        Self { left: Method::Truth, right: Method::Vmf, wipe: 0.5 }
    }
}

/// A sentence for the user.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Message {
    /// The sentence.
    pub text: String,
    /// True for an error, false for a remark.
    pub is_error: bool,
}

/// What is open, chosen and fitted.
pub struct Session {
    /// The lit surface.
    pub surface: LitSurface,
    /// What is compared on it.
    pub comparison: Comparison,
    /// Samples per pixel at which the truth is done.
    pub truth_samples: u32,
    map: Arc<NormalMap>,
    mip: Arc<PlainMip>,
    selected: Texel,
    fitting: Fitting,
    opening: Opening,
    recent: recent::RecentFiles,
    messages: Vec<Message>,
    map_revision: u64,
    wake: Wake,
}

impl Session {
    /// A session with the default bundled map, not fitted yet; `wake` is called when news wait.
    pub fn new(wake: Wake) -> Self {
        Self::with_map(procedural::default_map(), wake)
    }

    /// A session with this map, not fitted yet.
    pub fn with_map(map: NormalMap, wake: Wake) -> Self {
        let map = Arc::new(map);
        let mip = Arc::new(PlainMip::new(Arc::clone(&map)));
        Self {
            surface: LitSurface::default(),
            comparison: Comparison::default(),
            truth_samples: 1024,
            selected: default_selection(&map),
            fitting: Fitting::new(Arc::clone(&map), FitSettings::default()),
            opening: Opening::default(),
            recent: recent::RecentFiles::default(),
            messages: Vec::new(),
            map_revision: 1,
            map,
            mip,
            wake,
        }
    }

    /// The open map.
    pub fn map(&self) -> &Arc<NormalMap> {
        &self.map
    }

    /// Its mean normals.
    pub fn mip(&self) -> &Arc<PlainMip> {
        &self.mip
    }

    /// Grows whenever another map is open.
    pub fn map_revision(&self) -> u64 {
        self.map_revision
    }

    /// The lobes at hand and how far their fit is.
    pub fn fitting(&self) -> &Fitting {
        &self.fitting
    }

    /// The lobes at hand.
    pub fn lobes(&self) -> &Arc<LobePyramid> {
        self.fitting.lobes()
    }

    /// The selected texel; the map always has it.
    pub fn selected(&self) -> Texel {
        self.selected
    }

    /// Selects the texel nearest to `texel` that the map has.
    pub fn select(&mut self, texel: Texel) {
        self.selected = nearest(&self.map, texel);
    }

    /// Settings of the fit.
    pub fn fit_settings(&self) -> &FitSettings {
        self.fitting.settings()
    }

    /// Changes the fit's settings; a change restarts the fit, and the lobes at hand stand in as a preview.
    pub fn set_fit_settings(&mut self, settings: FitSettings) {
        if settings != *self.fitting.settings() {
            self.fitting.restart(settings);
            self.start_fit();
        }
    }

    /// Starts the fit anew with the settings there are, for example after it was cancelled.
    pub fn refit(&mut self) {
        self.fitting.restart(*self.fitting.settings());
        self.start_fit();
    }

    /// Calls `wake` from now on when a job has news.
    pub fn set_wake(&mut self, wake: Wake) {
        self.wake = wake;
    }

    /// Fits on this many threads from the next start on, or on one per core.
    pub fn set_threads(&mut self, threads: Option<usize>) {
        self.fitting.set_threads(threads);
    }

    /// Starts the first fit with these settings.
    pub fn begin(&mut self, settings: FitSettings) {
        self.fitting.restart(settings);
        self.start_fit();
    }

    fn start_fit(&mut self) {
        if let Err(message) = self.fitting.start(&self.wake) {
            self.report(Message { text: message, is_error: true });
        }
    }

    /// Stops the running fit; the levels that are done stay.
    pub fn cancel_fit(&mut self) {
        self.fitting.cancel();
    }

    /// Measures what the alignment of every finished level is worth; waits.
    pub fn measure_coherence(&mut self) {
        self.fitting.measure_coherence();
    }

    /// Opens a map in the background; the open one stays until the new one is read.
    pub fn open(&mut self, request: MapRequest) {
        if let Err(message) = self.opening.start(request, &self.wake) {
            self.report(Message { text: message, is_error: true });
        }
    }

    /// Asks for a file in the system's dialog, off the window's thread, then opens it.
    pub fn open_dialog(&mut self) {
        if let Err(message) = self.opening.start_dialog(self.map.options.clone(), &self.wake) {
            self.report(Message { text: message, is_error: true });
        }
    }

    /// Reads the open map anew with other options.
    pub fn reopen(&mut self, options: MapOptions) {
        match &self.map.source {
            MapSource::File(path) => self.open(MapRequest::File { path: path.clone(), options }),
            MapSource::Bundled(name) => self.open(MapRequest::Bundled { name: (*name).to_owned(), options }),
        }
    }

    /// True while a map is being read or asked for.
    pub fn is_opening(&self) -> bool {
        self.opening.is_running()
    }

    /// Maps opened lately, the latest first.
    pub fn recent(&self) -> &recent::RecentFiles {
        &self.recent
    }

    /// Lets the session remember opened maps across runs.
    pub fn remember_recent(&mut self) {
        self.recent = recent::RecentFiles::load();
    }

    /// Sentences that the user has not seen yet.
    pub fn take_messages(&mut self) -> Vec<Message> {
        std::mem::take(&mut self.messages)
    }

    /// Adds a sentence for the user.
    pub fn report(&mut self, message: Message) {
        if message.is_error {
            log::warn!("{}", message.text);
        }
        self.messages.push(message);
    }

    /// Waits up to `timeout` for news of the fit, then takes all there are.
    pub fn wait(&mut self, timeout: Duration) {
        let mut messages = Vec::new();
        self.fitting.wait(timeout, &mut messages);
        messages.into_iter().for_each(|text| self.report(Message { text, is_error: true }));
        self.poll();
    }

    /// Takes the jobs' news; true if anything changed.
    pub fn poll(&mut self) -> bool {
        let (news, mut messages) = self.opening.poll();
        let mut changed = news.is_some() || !messages.is_empty();
        if let Some((map, mip)) = news {
            self.adopt(map, mip);
        }
        changed |= self.fitting.poll(&mut messages);
        messages.into_iter().for_each(|text| self.report(Message { text, is_error: true }));
        changed
    }

    /// Takes a map that was read.
    fn adopt(&mut self, map: Arc<NormalMap>, mip: Arc<PlainMip>) {
        if let MapSource::File(path) = &map.source
            && let Err(error) = self.recent.push(path)
        {
            log::warn!("{error}");
        }
        self.fitting.adopt(Arc::clone(&map));
        self.selected =
            if map.level_sizes() == self.map.level_sizes() { self.selected } else { default_selection(&map) };
        (self.map, self.mip) = (map, mip);
        self.map_revision += 1;
        self.start_fit();
    }
}

/// A texel in the middle of a level that covers enough normals to be worth a look.
fn default_selection(map: &NormalMap) -> Texel {
    let sizes = map.level_sizes();
    let level = sizes.len().saturating_sub(4);
    Texel { level, x: sizes[level].0 / 2, y: sizes[level].1 / 2 }
}

fn nearest(map: &NormalMap, texel: Texel) -> Texel {
    let sizes = map.level_sizes();
    let level = texel.level.min(sizes.len() - 1);
    Texel { level, x: texel.x.min(sizes[level].0 - 1), y: texel.y.min(sizes[level].1 - 1) }
}
