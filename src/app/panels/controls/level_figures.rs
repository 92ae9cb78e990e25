//! What the fit came to, level by level: the figures that make a strength C worth tuning.

use egui::{Align, Grid, Layout, Response, RichText, Ui};

use crate::app::theme;
use crate::session::Session;
use crate::session::fitting::LevelState;

const LOBES: &str = "Mean number of lobes in use per texel.";
const LOST: &str = "Mean log-likelihood that alignment cost against each texel's own fit, per normal.";
const ANGLE: &str =
    "Mean angle between lobe j and its neighbours' lobe j, weighted by alpha. A low one alone is no success.";
const ERROR: &str = "Relative error of interpolated lobes half way between texel centres, s = 64: the same blend of \
                     the true BRDFs is the truth.";

const GROWN: &str = "The lobes started from those of the fit before and one more. A fit from the start may come to \
                     slightly other ones.";

/// The heads of the columns with their tooltips.
const HEADS: [(&str, &str); 5] =
    [("level", "MIP level"), ("lobes", LOBES), ("lost", LOST), ("angle", ANGLE), ("between", ERROR)];

/// Shows a row per finished level, and what is kept of earlier fits.
pub fn show(ui: &mut Ui, session: &Session) {
    let fitting = session.fitting();
    egui::CollapsingHeader::new(RichText::new("Figures by level").small()).default_open(false).show_unindented(
        ui,
        |ui| {
            ui.spacing_mut().interact_size.y = theme::GRID;
            Grid::new("level figures").num_columns(HEADS.len()).spacing([12.0, 2.0]).show(ui, |ui| {
                for (name, tooltip) in HEADS {
                    cell(ui, name).on_hover_text(tooltip);
                }
                ui.end_row();
                for (level, fit) in fitting.levels().iter().enumerate() {
                    let (Some(stats), LevelState::Done) = (fit.stats, fit.state) else { continue };
                    let figure = |value: Option<f64>, decimals: usize, unit: &str| {
                        value.map_or_else(|| "…".to_owned(), |value| format!("{value:.decimals$}{unit}"))
                    };
                    cell(ui, &level.to_string());
                    cell(ui, &format!("{:.1}", stats.mean_lobes));
                    cell(ui, &format!("{:.3}", stats.log_likelihood_lost));
                    cell(ui, &figure(stats.coherence.map(|c| c.coherence_deg), 1, "°"));
                    cell(ui, &figure(stats.coherence.map(|c| 100.0 * c.interpolation_error), 1, " %"));
                    ui.end_row();
                }
            });
        },
    );
    let (count, bytes) = fitting.kept();
    let budget = crate::session::kept::BUDGET >> 20;
    let fits = if count == 1 { "1 fit kept".to_owned() } else { format!("{count} fits kept") };
    if fitting.is_grown() {
        let text = format!("grown from J = {} · Refit starts afresh", fitting.settings().lobes - 1);
        ui.label(RichText::new(text).small().color(theme::of(ui).weak)).on_hover_text(GROWN);
    }
    let text = format!("{fits} · {} of {budget} MiB", bytes.div_ceil(1 << 20));
    ui.label(RichText::new(text).small().color(theme::of(ui).weak))
        .on_hover_text("Finished fits of recent settings: going back to them costs nothing.");
}

fn cell(ui: &mut Ui, text: &str) -> Response {
    let label = RichText::new(text).small().monospace();
    ui.with_layout(Layout::right_to_left(Align::Center), |ui| ui.label(label)).inner
}
