//! One frame of the window, independent of what shows it: the native window, a picture without one, and the tests
//! run the very same.

use std::sync::Arc;

use egui::{CentralPanel, Frame, Margin, Panel as Edge, Rect};

use super::actions::{self, Facts};
use super::autosave::Autosave;
use super::brdf_report::{Asked, BrdfReport};
use super::built_filters::BuiltFilters;
use super::command::{Command, Desk};
use super::disc_textures::DiscTextures;
use super::dock::{Dock, Panel};
use super::document;
use super::error_report::ErrorReport;
use super::exports::Exports;
use super::figures_report::FiguresReport;
use super::history::History;
use super::level_histogram::KeptHistogram;
use super::live_figures::{self, LiveFigures};
use super::map_picture::MapTextures;
use super::map_shading::MapShading;
use super::message_log::MessageLog;
use super::panels::{
    PanelContext, export_window, key_list, log_panel, palette, save_session, status_bar, toasts, top_bar, tour_card,
};
use super::settings::{KeptSettings, Settings};
use super::texel_report::TexelReport;
use super::theme;
use super::tour::{Target, Tour};
use super::trace_report::TraceReport;
use super::view_state::{Overlay, ViewState};
use super::viewport::PaintTarget;
use crate::gpu::Gpu;
use crate::jobs::Wake;
use crate::scene::import;
use crate::session::{MapRequest, Message, Session};

mod carried;
pub use carried::Carried;

/// What an inspector is told about where it is shown.
#[derive(Clone, Debug)]
pub struct Surroundings {
    /// The device that draws, for pictures beside the window's own.
    pub gpu: Gpu,
    /// Where callbacks paint.
    pub target: PaintTarget,
    /// True in a window that people watch: figures that differ from run to run are shown there only.
    pub live: bool,
}

/// The document, the view of it, and what is under way.
pub struct Inspector {
    /// The document.
    pub session: Session,
    /// The view of it.
    pub view: ViewState,
    settings: KeptSettings,
    tour: Tour,
    surroundings: Surroundings,
    report: TexelReport,
    brdf: BrdfReport,
    trace: TraceReport,
    errors: ErrorReport,
    figures: FiguresReport,
    exports: Exports,
    live_figures: LiveFigures,
    history: History,
    autosave: Autosave,
    dock: Dock,
    textures: MapTextures,
    discs: DiscTextures,
    histogram: KeptHistogram,
    messages: MessageLog,
    hover: Option<String>,
    wake: Wake,
}

/// A wake-up call for jobs: asks the context for a repaint, from any thread.
pub fn wake_of(ctx: &egui::Context) -> Wake {
    let ctx = ctx.clone();
    Arc::new(move || ctx.request_repaint())
}

impl Inspector {
    /// An inspector of a session whose jobs call `wake`. Dresses the context.
    pub fn new(ctx: &egui::Context, session: Session, surroundings: Surroundings) -> Self {
        ctx.options_mut(|options| options.zoom_with_keyboard = false);
        let mut settings = KeptSettings::default();
        settings.dress(ctx);
        let filters = BuiltFilters::default();
        Self {
            session,
            view: ViewState::default(),
            figures: FiguresReport::new(surroundings.gpu.clone(), wake_of(ctx)),
            exports: Exports::new(surroundings.gpu.clone(), wake_of(ctx)),
            history: History::default(),
            autosave: Autosave::default(),
            settings,
            tour: Tour::default(),
            surroundings,
            report: TexelReport::default(),
            brdf: BrdfReport::new(filters.clone()),
            trace: TraceReport::default(),
            errors: ErrorReport::new(filters),
            live_figures: LiveFigures::default(),
            dock: Dock::default(),
            textures: MapTextures::default(),
            discs: DiscTextures::default(),
            histogram: KeptHistogram::default(),
            messages: MessageLog::default(),
            hover: None,
            wake: wake_of(ctx),
        }
    }

    /// Takes the jobs' news and dropped files. Runs before every [`Inspector::ui`].
    pub fn logic(&mut self, ctx: &egui::Context) {
        self.settings.dress(ctx);
        self.open_dropped(ctx);
        self.session.poll();
        let mut news = Vec::new();
        self.figures.poll(&mut news);
        self.exports.poll(&mut news);
        self.take_opened_view();
        news.extend(self.session.take_messages());
        self.messages.add(news);
        self.record(ctx);
        self.live_figures.update(self.live_task(), &self.wake);
        self.view.light.sweep(&mut self.session.surface.lights, ctx);
        self.view.dolly.run(&mut self.session.surface.camera, ctx);
        self.view.drying.play(&mut self.session.surface.material, ctx);
        self.follow_texels();
        if self.surroundings.live && (self.session.fitting().is_running() || self.errors.is_running()) {
            // Jobs wake the window for each level; the figures in between move ten times a second.
            ctx.request_repaint_after(std::time::Duration::from_millis(100));
        }
    }

    /// Lets the reports on texels follow the session and what is shown of it.
    fn follow_texels(&mut self) {
        let (session, view) = (&self.session, &self.view);
        let judged = ViewState::judged_of(&session.comparison, view.judged);
        self.report.update(session, &self.wake);
        self.brdf.update(session, Asked::new(view, &session.comparison), &self.wake);
        self.trace.update(session, view.show_trace, &self.wake);
        self.errors.update(session, judged, view.map.shading == MapShading::Error, &self.wake);
    }

    /// True when nothing is under way: no job, no upload, no unfinished picture.
    pub fn is_settled(&self) -> bool {
        let session = &self.session;
        let fitting = session.fitting();
        let computing = fitting.is_running() || fitting.is_measuring() || session.is_building();
        let computing = computing || session.is_saving() || self.figures.is_running() || self.figures.is_saving();
        let computing = computing || self.exports.is_writing();
        let gathering = self.report.is_gathering() || self.brdf.is_running() || self.trace.is_running();
        let opening = session.is_opening() || session.is_opening_sky() || session.is_measuring();
        let busy = computing || gathering || self.errors.is_running() || opening || self.view.is_playing();
        // A surface out of sight is not drawn, and keeps what its last frame said.
        let in_sight = self.dock.rect(Panel::Surface).is_some();
        let drawing = in_sight && self.surroundings.target.status.get().wants_more;
        !busy && !drawing && self.live_figures.is_done(self.live_task().as_ref())
    }

    /// The figures of the methods on show.
    pub fn live_figures(&self) -> &LiveFigures {
        &self.live_figures
    }

    fn live_task(&self) -> Option<live_figures::Task> {
        live_figures::Task::new(&self.surroundings.target.status.get(), self.view.region.chosen)
    }

    /// The panels. Runs what they asked for at the end; the next frame shows it.
    pub fn ui(&mut self, ui: &mut egui::Ui) {
        let mut commands = actions::pressed(ui.ctx(), &self.facts());
        let mut hover = None;
        let mut context = PanelContext {
            session: &self.session,
            view: &mut self.view,
            commands: &mut commands,
            report: &self.report,
            brdf: &self.brdf,
            trace: &self.trace,
            errors: &self.errors,
            figures: &self.figures,
            exports: &mut self.exports,
            live_figures: &self.live_figures,
            history: &self.history,
            said: self.messages.said(),
            textures: &mut self.textures,
            discs: &mut self.discs,
            histogram: &mut self.histogram,
            surroundings: &self.surroundings,
            hover: &mut hover,
        };
        let top_bar = lay_out(ui, &mut self.dock, &mut context, self.hover.as_deref());
        lay_over(ui.ctx(), &mut context);
        let rect = |target| match target {
            Target::Panel(panel) => self.dock.rect(panel),
            Target::TopBar => Some(top_bar),
        };
        if tour_card::show(ui.ctx(), &mut self.tour, rect) {
            commands.push(Command::ChangeSettings(|settings| settings.knows_tour = true));
        }
        commands.extend(toasts::show(ui.ctx(), &mut self.messages.shown).map(Command::Open));
        if hover != self.hover || !commands.is_empty() {
            ui.ctx().request_repaint();
        }
        self.hover = hover;
        for command in commands {
            self.run(command, ui.ctx());
        }
    }

    /// Sentences that are shown and not dismissed yet.
    pub fn messages(&self) -> &[Message] {
        &self.messages.shown
    }

    /// What actions look at.
    pub fn facts(&self) -> Facts<'_> {
        Facts { session: &self.session, view: &self.view, history: &self.history }
    }

    /// Carries a command out.
    pub fn run(&mut self, command: Command, ctx: &egui::Context) {
        let Self { session, view, tour, settings, figures, exports, history, .. } = self;
        command.run(Desk { session, view, tour, settings, figures, exports, history, ctx });
    }

    /// Takes the layout of a session that was opened, before the next pass does.
    pub fn take_opened_view(&mut self) {
        if let Some(value) = self.session.take_view() {
            document::take_view(value, &mut self.session, &mut self.view);
        }
    }

    /// Takes note of the document, unless something is held or still moves: a drag is one step, and so is a dolly.
    fn record(&mut self, ctx: &egui::Context) {
        let held = ctx.input(|input| {
            input.pointer.any_down() || !input.keys_down.is_empty() || input.smooth_scroll_delta() != egui::Vec2::ZERO
        });
        let opening = self.session.is_opening() || self.session.is_opening_sky();
        if !held && !opening && !self.view.is_playing() {
            let now = document::contents(&self.session, &self.view);
            self.autosave.update(&now, self.session.path(), ctx, &self.wake);
            self.history.record(now);
        }
    }

    /// Where the last pass showed a panel, in points; `None` where it is out of sight.
    pub fn rect_of(&self, panel: Panel) -> Option<Rect> {
        self.dock.rect(panel)
    }

    /// What the user prefers.
    pub fn settings(&self) -> &Settings {
        self.settings.get()
    }

    /// Changes what the user prefers.
    pub fn change_settings(&mut self, change: impl FnOnce(&mut Settings)) {
        self.settings.change(change);
    }

    /// Keeps the document for the next start from now on, and takes the user's own settings.
    pub fn keep_document(&mut self, settings: KeptSettings) {
        self.autosave = Autosave::of_user();
        self.settings = settings;
        if !self.settings.get().knows_tour {
            self.tour.start();
        }
    }

    /// Keeps the document as it is: the window closes. One that is still being opened is kept already.
    pub fn finish(&mut self) {
        if !self.session.is_opening() {
            self.autosave.finish(&document::contents(&self.session, &self.view), self.session.path());
        }
    }

    fn open_dropped(&mut self, ctx: &egui::Context) {
        let Some(file) = ctx.input(|input| input.raw.dropped_files.last().cloned()) else { return };
        let options = self.session.options_for_another_map();
        let path = file.path().to_owned();
        if path.extension().is_some_and(|extension| extension == "binary") {
            self.session.open_measured(path);
            return;
        }
        if import::is_mesh_path(&path) {
            self.session.open_mesh(path);
            return;
        }
        if path.is_absolute() {
            self.session.open(MapRequest::File { path, options });
            return;
        }
        match file.bytes() {
            Ok(bytes) => {
                let name = path.display().to_string();
                self.session.open(MapRequest::Bytes { name, bytes: bytes.into(), options });
            }
            Err(error) => {
                let text = format!("The dropped file {} cannot be read: {error}.", path.display());
                self.session.report(Message::error(text));
            }
        }
    }
}

fn lay_over(ctx: &egui::Context, context: &mut PanelContext<'_>) {
    match context.view.overlay {
        Overlay::None => {}
        Overlay::Palette => palette::show(ctx, context),
        Overlay::Keys => key_list::show(ctx, context),
        Overlay::Log => log_panel::show(ctx, context),
        Overlay::SaveSession => save_session::show(ctx, context),
        Overlay::Export => export_window::show(ctx, context),
    }
}

/// Shows the bars and the panels; where the upper bar is.
fn lay_out(ui: &mut egui::Ui, dock: &mut Dock, context: &mut PanelContext<'_>, hover: Option<&str>) -> Rect {
    let bar = Frame::new().fill(theme::of(ui).panel).inner_margin(Margin::symmetric(12, 5));
    let top_bar = Edge::top("top bar").frame(bar).show(ui, |ui| top_bar::show(ui, context));
    Edge::bottom("status bar").frame(bar).show(ui, |ui| status_bar::show(ui, context, hover));
    CentralPanel::no_frame().show(ui, |ui| dock.show(ui, context));
    top_bar.response.rect
}
