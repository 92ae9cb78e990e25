//! The one document: which map is open, how it is fitted and shown, and the lobes at hand. The window and the command
//! line drive the same one.
//!
//! Slow work runs in [`jobs`](crate::jobs); [`Session::poll`] takes their news. A newer request replaces an older
//! job, whose results then never appear. Whatever fails leaves the open map, a running fit and the settings as they
//! were.

pub mod file;
pub mod fitting;
pub mod kept;
pub mod measured;
pub mod mesh_opening;
mod open_files;
pub mod opening;
pub mod recent;
pub mod rivals;
pub mod saving;
pub mod sky;
mod unknown_keys;
mod watch;

use std::path::PathBuf;
use std::sync::{Arc, OnceLock};
use std::time::Duration;

use crate::comparison::{Comparison, ShownMethod};
use crate::filter::channels::ChannelPyramid;
use crate::filter::vmf::{FitSettings, LobePyramid};
use crate::filter::{Method, PlainMip};
use crate::jobs::Wake;
use crate::lit_surface::LitSurface;
use crate::normal_map::pyramid::Texel;
use crate::normal_map::{Diagnosis, NormalMap, procedural};
use fitting::Fitting;
use mesh_opening::MeshOpening;
use opening::Opening;
pub use opening::{MapRequest, OpenedMap};

/// A sentence for the user.
#[derive(Clone, Debug, PartialEq)]
pub struct Message {
    /// The sentence.
    pub text: String,
    /// True for an error, false for a remark.
    pub is_error: bool,
    /// What the user may want instead.
    pub offer: Option<Box<Offer>>,
}

/// Another way to open what could not be opened.
#[derive(Clone, Debug, PartialEq)]
pub struct Offer {
    /// What the button says.
    pub label: &'static str,
    /// What it opens.
    pub request: MapRequest,
}

impl Message {
    /// An error.
    pub fn error(text: impl Into<String>) -> Self {
        Self { text: text.into(), is_error: true, offer: None }
    }

    /// A remark.
    pub fn remark(text: impl Into<String>) -> Self {
        Self { is_error: false, ..Self::error(text) }
    }
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
    /// Made when it is first asked for: a fit alone needs none, and it is as large as the map.
    mip: OnceLock<Arc<PlainMip>>,
    /// Made when it is first asked for: only a window shows it.
    diagnosis: OnceLock<Diagnosis>,
    selected: Texel,
    fitting: Fitting,
    opening: Opening,
    sky_opening: sky::SkyOpening,
    mesh_opening: MeshOpening,
    measuring: measured::Measuring,
    rivals: rivals::Rivals,
    recent: recent::RecentFiles,
    saving: saving::Saving,
    /// Looks at the map's file, where changes are to be offered.
    watch: Option<watch::Watch>,
    watches: bool,
    /// The session file that is open.
    path: Option<PathBuf>,
    /// Its keys that this version does not know.
    unknown: serde_json::Map<String, serde_json::Value>,
    /// Its layout of the window, until the window takes it.
    view: Option<serde_json::Value>,
    messages: Vec<Message>,
    map_revision: u64,
    wake: Wake,
}

impl Session {
    /// Samples per pixel of the truth that nobody chose: the standard error is then a thousandth or so.
    pub const TRUTH_SAMPLES: u32 = 4096;

    /// A session with the default bundled map, not fitted yet; `wake` is called when news wait.
    pub fn new(wake: Wake) -> Self {
        Self::with_map(procedural::default_map(), wake)
    }

    /// A session with this map, not fitted yet.
    pub fn with_map(map: NormalMap, wake: Wake) -> Self {
        Self::with_opened(map.into(), wake)
    }

    /// A session with a map that was read, and with the fit that came along.
    pub fn with_opened(opened: OpenedMap, wake: Wake) -> Self {
        let map = opened.map;
        let mut fitting = Fitting::new(Arc::clone(&map), FitSettings::default());
        if let Some(fit) = opened.fit {
            fitting.adopt_fit(fit);
        }
        Self {
            surface: LitSurface::default(),
            comparison: Comparison::default(),
            truth_samples: Self::TRUTH_SAMPLES,
            selected: default_selection(&map),
            fitting,
            opening: Opening::default(),
            sky_opening: sky::SkyOpening::default(),
            mesh_opening: MeshOpening::default(),
            measuring: measured::Measuring::default(),
            rivals: rivals::Rivals::default(),
            recent: recent::RecentFiles::default(),
            saving: saving::Saving::default(),
            watch: None,
            watches: false,
            path: None,
            unknown: serde_json::Map::new(),
            view: None,
            messages: Vec::new(),
            map_revision: 1,
            map,
            mip: OnceLock::new(),
            diagnosis: OnceLock::new(),
            wake,
        }
    }

    /// The open map.
    pub fn map(&self) -> &Arc<NormalMap> {
        &self.map
    }

    /// Its mean normals.
    pub fn mip(&self) -> &Arc<PlainMip> {
        self.mip.get_or_init(|| Arc::new(PlainMip::new(Arc::clone(&self.map))))
    }

    /// What its samples say of how they should be read.
    pub fn diagnosis(&self) -> &Diagnosis {
        self.diagnosis.get_or_init(|| self.map.diagnose())
    }

    /// The methods of the view with what is built of them, in the order of its cells.
    pub fn shown_methods(&self) -> Vec<ShownMethod> {
        self.comparison.methods().into_iter().map(|method| self.shown_method(method)).collect()
    }

    /// A method with what is built of it.
    pub fn shown_method(&self, method: Method) -> ShownMethod {
        ShownMethod { method, channels: self.channels_of(method).cloned() }
    }

    /// The channels of one method, where it is a rival on show that has some and they are built.
    pub fn channels_of(&self, method: Method) -> Option<&Arc<ChannelPyramid>> {
        self.rivals.channels(method)
    }

    /// True while channels of a method on show are being built.
    pub fn is_building(&self) -> bool {
        self.rivals.is_building()
    }

    /// Builds the channels of the methods on show; waits.
    pub fn wait_for_channels(&mut self) {
        self.poll();
        while self.is_building() {
            self.wait(Duration::from_millis(50));
        }
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
        if settings != *self.fitting.settings() && !self.fitting.recall(&settings) {
            self.fitting.restart(settings);
            self.start_fit();
        }
    }

    /// Starts the fit anew with the settings there are, for example after it was cancelled.
    pub fn refit(&mut self) {
        self.fitting.forget();
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

    /// Keeps no level before it is finished: nobody looks at a fit under way, and the memory is worth having.
    pub fn skip_previews(&mut self) {
        self.fitting.skip_previews();
    }

    /// Starts the first fit with these settings; nothing where the lobes of a file are that fit already.
    pub fn begin(&mut self, settings: FitSettings) {
        if !self.fitting.is_complete() || settings != *self.fitting.settings() {
            self.fitting.restart(settings);
            self.start_fit();
        }
    }

    fn start_fit(&mut self) {
        self.fitting.want(self.selected);
        if let Err(message) = self.fitting.start(&self.wake) {
            self.report(Message::error(message));
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

    /// Waits up to `timeout` for news of the fit or, where none runs, of channels, then takes all there are.
    pub fn wait(&mut self, timeout: Duration) {
        let mut messages = Vec::new();
        if !self.fitting.is_running() {
            self.rivals.wait(timeout, &mut self.messages);
        }
        self.fitting.wait(timeout, &mut messages);
        for text in messages {
            self.report(Message::error(text));
        }
        self.poll();
    }

    /// Waits until the fit is complete; `watch` looks on twenty times a second and may cancel it.
    ///
    /// # Errors
    /// The sentence of a fit that failed, or was stopped.
    pub fn wait_for_fit(&mut self, watch: &mut dyn FnMut(&mut Self)) -> Result<(), Message> {
        while !self.fitting.is_complete() {
            watch(self);
            self.wait(Duration::from_millis(50));
            if let Some(error) = self.take_messages().into_iter().find(|message| message.is_error) {
                return Err(error);
            }
            if !self.fitting.is_running() && !self.fitting.is_complete() {
                return Err(Message::error("The fit was stopped."));
            }
        }
        Ok(())
    }

    /// Another session of the same map, surface and settings, with the fit of this one where it is finished. Nothing
    /// that is done to it shows here. It keeps no fit but the latest; where it `aligns` anew, it remembers the
    /// unaligned levels that every alignment starts from.
    pub fn fork(&self, aligns: bool, wake: Wake) -> Self {
        let mut fork = Self::with_opened(OpenedMap::from(Arc::clone(&self.map)), wake);
        (fork.surface, fork.truth_samples) = (self.surface.clone(), self.truth_samples);
        fork.mip = Arc::clone(self.mip()).into();
        fork.fitting = self.fitting.fork(aligns);
        fork
    }

    /// Takes the jobs' news; true if anything changed.
    pub fn poll(&mut self) -> bool {
        let (news, refused) = self.opening.poll();
        let mut messages = Vec::new();
        let mut changed = news.is_some() || refused.is_some();
        changed |= self.poll_saving();
        self.poll_watch();
        self.messages.extend(refused);
        if let Some(prepared) = news {
            self.adopt(prepared);
        }
        changed |= self.poll_sky();
        changed |= self.poll_mesh();
        changed |= self.poll_measured();
        changed |= self.fitting.poll(&mut messages);
        self.fitting.measure(&self.wake);
        let mip = || Arc::clone(self.mip.get_or_init(|| Arc::new(PlainMip::new(Arc::clone(&self.map)))));
        changed |= self.rivals.update(&self.comparison.methods(), mip, &self.wake, &mut self.messages);
        for text in messages {
            self.report(Message::error(text));
        }
        changed
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
