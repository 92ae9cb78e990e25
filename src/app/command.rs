//! Everything a panel can ask for. Panels only read the document; what they want done goes through here.

use std::path::PathBuf;

use super::dock::Preset;
use super::export_view::ExportView;
use super::exports::{ExportTarget, Exports};
use super::figures_file::Target;
use super::figures_report::FiguresReport;
use super::history::History;
use super::settings::{KeptSettings, Settings};
use super::tour::Tour;
use super::view_state::Overlay;
use super::{ViewState, document};
use crate::comparison::Comparison;
use crate::filter::vmf::FitSettings;
use crate::lighting::SkySource;
use crate::lit_surface::LitSurface;
use crate::measure::{Axis, Metric, Sweep};
use crate::normal_map::MapOptions;
use crate::normal_map::pyramid::Texel;
use crate::session::file::SessionFile;
use crate::session::{MapRequest, Message, Session};

/// What commands work on.
pub struct Desk<'a> {
    /// The document.
    pub session: &'a mut Session,
    /// The view of it.
    pub view: &'a mut ViewState,
    /// The tour of the window.
    pub tour: &'a mut Tour,
    /// What the user prefers.
    pub settings: &'a mut KeptSettings,
    /// What was measured of it.
    pub figures: &'a mut FiguresReport,
    /// What is being exported.
    pub exports: &'a mut Exports,
    /// What it was before.
    pub history: &'a mut History,
    /// The window.
    pub ctx: &'a egui::Context,
}

/// One request.
#[derive(Clone, Debug)]
pub enum Command {
    /// Open a map.
    Open(MapRequest),
    /// Ask for a file, then open it.
    OpenDialog,
    /// Open the file at a typed path, read as the open map is.
    OpenPath(PathBuf),
    /// Open a mesh as the surface.
    OpenMesh(PathBuf),
    /// Ask for a mesh, then open it.
    OpenMeshDialog,
    /// Read the open map anew, another way.
    Reopen(MapOptions),
    /// Ask for a file of measured reflectance, then take it up as the material.
    OpenMeasuredDialog,
    /// Take up the measured reflectance at a path.
    OpenMeasured(PathBuf),
    /// Fit with other settings.
    SetFit(FitSettings),
    /// Start the fit anew.
    Refit,
    /// Stop the fit.
    CancelFit,
    /// Light, material, shape, camera.
    SetSurface(LitSurface),
    /// Open a sky.
    OpenSky(SkySource),
    /// Ask for a file, then open it as a sky.
    OpenSkyDialog,
    /// Samples per pixel at which the truth is done.
    SetTruthSamples(u32),
    /// Methods, and how they stand beside each other.
    SetComparison(Comparison),
    /// Select a texel.
    Select(Texel),
    /// Measure figures in the background.
    MeasureFigures(Sweep),
    /// Stop measuring; what was found stays.
    CancelFigures,
    /// Save the figures along an axis; a picture shows the metric.
    SaveFigures(Axis, Metric, Target),
    /// Write a file for other programs.
    Export(ExportView, ExportTarget),
    /// Change what is seen, and nothing else.
    ChangeView(fn(&mut ViewState)),
    /// Change what the user prefers.
    ChangeSettings(fn(&mut Settings)),
    /// Show the tour of the window.
    StartTour,
    /// Go one step back.
    Undo,
    /// Go one step forth again.
    Redo,
    /// Save the session to a file.
    SaveSession(PathBuf),
    /// Ask in the system's dialog where the session is saved to.
    SaveSessionDialog,
    /// Ask in the window where the session is saved to.
    AskSessionPath,
    /// Close the window.
    Quit,
    /// Tell the user something.
    Report(Message),
}

impl Command {
    /// Carries the request out.
    pub fn run(self, desk: Desk<'_>) {
        let Desk { session, view, tour, settings, figures, exports, history, ctx } = desk;
        match self {
            Self::Open(request) => session.open(request),
            Self::OpenDialog => session.open_dialog(),
            Self::OpenPath(path) => {
                let options = session.options_for_another_map();
                session.open(MapRequest::File { path, options });
            }
            Self::OpenMesh(path) => session.open_mesh(path),
            Self::OpenMeshDialog => session.open_mesh_dialog(),
            Self::Reopen(options) => session.reopen(options),
            Self::OpenMeasuredDialog => session.open_measured_dialog(),
            Self::OpenMeasured(path) => session.open_measured(path),
            Self::SetFit(settings) => session.set_fit_settings(settings),
            Self::Refit => session.refit(),
            Self::CancelFit => session.cancel_fit(),
            Self::SetSurface(surface) => session.surface = surface,
            Self::OpenSky(source) => session.open_sky(source),
            Self::OpenSkyDialog => session.open_sky_dialog(),
            Self::SetTruthSamples(samples) => session.truth_samples = samples,
            Self::SetComparison(comparison) => session.comparison = comparison,
            Self::Select(texel) => session.select(texel),
            Self::MeasureFigures(sweep) => tell(figures.start(session, sweep), session),
            Self::CancelFigures => figures.cancel(),
            Self::SaveFigures(axis, metric, target) => tell(figures.save(axis, metric, target), session),
            Self::Export(view, target) => tell(exports.start(session, &view, target), session),
            Self::ChangeView(change) => change(view),
            Self::ChangeSettings(change) => settings.change(change),
            Self::StartTour => {
                view.choose(Preset::Inspect);
                tour.start();
            }
            Self::Undo => step(History::undo, session, view, history),
            Self::Redo => step(History::redo, session, view, history),
            Self::SaveSession(path) => session.save(document::contents(session, view), path),
            Self::SaveSessionDialog => session.save_dialog(document::contents(session, view)),
            Self::AskSessionPath => {
                view.session_path = session.suggested_path().display().to_string();
                view.overlay = Overlay::SaveSession;
            }
            Self::Quit => ctx.send_viewport_cmd(egui::ViewportCommand::Close),
            Self::Report(message) => session.report(message),
        }
    }
}

/// Undoes or redoes, once what changed last is taken note of.
fn step(
    take: fn(&mut History) -> Option<SessionFile>,
    session: &mut Session,
    view: &mut ViewState,
    history: &mut History,
) {
    if !session.is_opening() {
        history.record(document::contents(session, view));
    }
    if let Some(file) = take(history) {
        document::restore(file, session, view);
    }
}

/// Tells the user why something was not done.
fn tell(done: Result<(), Message>, session: &mut Session) {
    if let Err(message) = done {
        session.report(message);
    }
}
