//! Everything a panel can ask for. Panels only read the document; what they want done goes through here.

use std::path::PathBuf;

use super::figures_file::Target;
use super::figures_report::FiguresReport;
use crate::comparison::Comparison;
use crate::filter::vmf::FitSettings;
use crate::lit_surface::LitSurface;
use crate::measure::{Axis, Metric, Sweep};
use crate::normal_map::MapOptions;
use crate::normal_map::pyramid::Texel;
use crate::session::{MapRequest, Message, Session};

/// One request.
#[derive(Clone, Debug)]
pub enum Command {
    /// Open a map.
    Open(MapRequest),
    /// Ask for a file, then open it.
    OpenDialog,
    /// Open the file at a typed path, read as the open map is.
    OpenPath(PathBuf),
    /// Read the open map anew, another way.
    Reopen(MapOptions),
    /// Fit with other settings.
    SetFit(FitSettings),
    /// Start the fit anew.
    Refit,
    /// Stop the fit.
    CancelFit,
    /// Light, material, shape, camera.
    SetSurface(LitSurface),
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
    /// Tell the user something.
    Report(Message),
}

impl Command {
    /// Carries the request out.
    pub fn run(self, session: &mut Session, figures: &mut FiguresReport) {
        match self {
            Self::Open(request) => session.open(request),
            Self::OpenDialog => session.open_dialog(),
            Self::OpenPath(path) => {
                let options = session.options_for_another_map();
                session.open(MapRequest::File { path, options });
            }
            Self::Reopen(options) => session.reopen(options),
            Self::SetFit(settings) => session.set_fit_settings(settings),
            Self::Refit => session.refit(),
            Self::CancelFit => session.cancel_fit(),
            Self::SetSurface(surface) => session.surface = surface,
            Self::SetTruthSamples(samples) => session.truth_samples = samples,
            Self::SetComparison(comparison) => session.comparison = comparison,
            Self::Select(texel) => session.select(texel),
            Self::MeasureFigures(sweep) => tell(figures.start(session, sweep), session),
            Self::CancelFigures => figures.cancel(),
            Self::SaveFigures(axis, metric, target) => tell(figures.save(axis, metric, target), session),
            Self::Report(message) => session.report(message),
        }
    }
}

/// Tells the user why something was not done.
fn tell(done: Result<(), Message>, session: &mut Session) {
    if let Err(message) = done {
        session.report(message);
    }
}
