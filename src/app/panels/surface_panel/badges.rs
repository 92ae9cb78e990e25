//! What is said of each method on its part of the picture: its name, and what there is to say of it.

use egui::{Align2, Color32, Painter, Pos2, Vec2, pos2, vec2};

use super::cells::Cells;
use crate::app::panels::PanelContext;
use crate::app::panels::map_panel::badge;
use crate::app::theme;
use crate::comparison::Arrangement;
use crate::filter::Method;
use crate::filter::vmf::{FitSettings, Fold, Selection};
use crate::session::fitting::LevelState;

/// From a corner of the picture, or of a cell, to what is written there.
pub const INSET: Vec2 = vec2(12.0, 12.0);

/// Draws them; in a grid, below the list that names the method.
pub fn show(painter: &Painter, context: &PanelContext<'_>, cells: &Cells) {
    let comparison = context.session.comparison;
    if let Arrangement::Grid { .. } = cells.arrangement {
        for (cell, method) in cells.rects().zip(comparison.grid) {
            let at = cell.min + INSET + vec2(0.0, theme::ROW + theme::GRID);
            let painter = painter.with_clip_rect(cell.intersect(cells.picture));
            notes(&painter, context, method, (at, Align2::LEFT_TOP), details(context, method));
        }
        return;
    }
    let [on_left, on_right] = sides(cells.arrangement);
    let both = comparison.left != comparison.right;
    if on_left || !both {
        method_badges(painter, context, comparison.left, (cells.picture.left_top() + INSET, Align2::LEFT_TOP));
    }
    if on_right && both {
        let corner = cells.picture.right_top() + vec2(-INSET.x, INSET.y);
        method_badges(painter, context, comparison.right, (corner, Align2::RIGHT_TOP));
    }
}

/// Whether the left and the right method are to be named.
fn sides(arrangement: Arrangement) -> [bool; 2] {
    match arrangement {
        // Where one side is no wider than its name's margin, nothing is seen of it.
        Arrangement::Wipe(at) => [at > 0.02, at < 0.98],
        _ => [0, 1].map(|index| arrangement.methods_in(0).contains(&index)),
    }
}

fn method_badges(painter: &Painter, context: &PanelContext<'_>, method: Method, (at, align): (Pos2, Align2)) {
    let text = match details(context, method) {
        Some(details) => format!("{} · {details}", method.label()),
        None => method.label(),
    };
    let rect = badge(painter, at, align, &text, theme::STRONG);
    let below = pos2(if align == Align2::LEFT_TOP { rect.left() } else { rect.right() }, rect.bottom() + 4.0);
    notes(painter, context, method, (below, align), None);
}

/// A line of details, and one that says what keeps the picture from being what was asked for.
fn notes(
    painter: &Painter,
    context: &PanelContext<'_>,
    method: Method,
    (mut at, align): (Pos2, Align2),
    details: Option<String>,
) {
    let note = if method.shows_lobes() { lobes_note(context) } else { channels_note(context, method) };
    for (text, color) in details.map(|text| (text, theme::TEXT)).into_iter().chain(note) {
        at.y = badge(painter, at, align, &text, color).bottom() + theme::GRID;
    }
}

/// What there is to say of a method beside its name.
fn details(context: &PanelContext<'_>, method: Method) -> Option<String> {
    match method {
        Method::Truth => {
            let report = context.surroundings.target.status.get();
            let (samples, all) = (report.truth_samples, context.session.truth_samples);
            let text = if samples < all { format!("{samples} of {all} spp") } else { format!("{samples} spp") };
            // Without the finest levels it is the truth of a smoother map.
            let level = if report.left_out > 0 { format!(" of level {}", report.left_out) } else { String::new() };
            Some(format!("{text}{level}"))
        }
        Method::Rival(_) => None,
        Method::Vmf | Method::VmfUnaligned => Some(format!("J = {}", lobe_count(context.session.fit_settings()))),
    }
}

/// What keeps a rival from being shown.
fn channels_note(context: &PanelContext<'_>, method: Method) -> Option<(String, Color32)> {
    let rival = method.rival()?;
    let text = if !rival.is_drawn() {
        "too many bands to draw"
    } else if context.session.is_building() && context.session.channels_of(method).is_none() && rival.kind.has_channels
    {
        "being built"
    } else {
        return None;
    };
    Some((text.to_owned(), theme::WARNING))
}

/// How many lobes a texel gets, as the badge says it.
fn lobe_count(settings: &FitSettings) -> String {
    match settings.selection {
        Selection::Fixed => settings.lobes.to_string(),
        Selection::BrdfError { percent } => format!("auto {percent} %"),
        Selection::Bic => "BIC".to_owned(),
    }
}

/// What keeps the lobes shown from being the fit that was asked for.
fn lobes_note(context: &PanelContext<'_>) -> Option<(String, Color32)> {
    let fitting = context.session.fitting();
    let count = |state| fitting.levels().iter().filter(|level| level.state == state).count();
    let done = count(LevelState::Done);
    let levels = fitting.levels().len();
    if fitting.is_complete() {
        return None;
    }
    let text = if fitting.fold() != Fold::default() || count(LevelState::Earlier) > 0 {
        format!("preview · {done} of {levels} levels fitted")
    } else if count(LevelState::Unaligned) > 0 {
        format!("preview, not aligned · {done} of {levels} levels fitted")
    } else {
        format!("{done} of {levels} levels fitted")
    };
    Some((text, theme::WARNING))
}
