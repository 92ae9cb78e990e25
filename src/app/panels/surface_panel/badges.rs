//! What is said of each method on its part of the picture: its name, and what there is to say of it.

use egui::{Align2, Pos2, Rect, Ui, Vec2, pos2, vec2};

use super::cells::Cells;
use super::figures;
use super::methods::COMBO_WIDTH;
use crate::app::panels::PanelContext;
use crate::app::panels::map_panel::{badge, badge_size};
use crate::app::theme;
use crate::comparison::Arrangement;
use crate::filter::Method;
use crate::filter::vmf::{FitSettings, Fold, Selection};
use crate::session::fitting::LevelState;

/// From a corner of the picture to what is written there.
const INSET: Vec2 = vec2(12.0, 12.0);
/// From a corner of a grid's cell, which has less room.
pub const CELL_INSET: Vec2 = vec2(8.0, 6.0);

/// A method and where it is named.
struct Place {
    /// Which of the methods.
    index: usize,
    method: Method,
    /// Where what is said of it begins, at a left or a right edge.
    at: Pos2,
    align: Align2,
}

/// Draws them; in a grid, beside and below the list that names the method.
pub fn show(ui: &Ui, context: &PanelContext<'_>, cells: &Cells) {
    let comparison = context.session.comparison;
    if let Arrangement::Grid { .. } = cells.arrangement {
        for (index, (cell, method)) in cells.rects().zip(comparison.grid).enumerate() {
            let at = cell.min + CELL_INSET;
            beside_list(ui, context, cells, cell, Place { index, method, at, align: Align2::LEFT_TOP });
        }
        return;
    }
    let [on_left, on_right] = sides(cells.arrangement);
    let both = comparison.left != comparison.right;
    if on_left || !both {
        let at = cells.picture.left_top() + INSET;
        named(ui, context, cells, Place { index: 0, method: comparison.left, at, align: Align2::LEFT_TOP });
    }
    if on_right && both {
        let at = cells.picture.right_top() + vec2(-INSET.x, INSET.y);
        named(ui, context, cells, Place { index: 1, method: comparison.right, at, align: Align2::RIGHT_TOP });
    }
}

/// What is said of a method whose list is there; it takes a line of its own where the cell has no room beside.
fn beside_list(ui: &Ui, context: &PanelContext<'_>, cells: &Cells, cell: Rect, mut place: Place) {
    let beside = place.at + vec2(COMBO_WIDTH + theme::GRID, 0.0);
    place.at.y += theme::ROW + theme::GRID;
    if let Some(text) = details(context, cells, place.method) {
        let painter = ui.painter_at(cells.picture);
        let fits = beside.x + badge_size(&painter, &text).x <= cell.right();
        let rect = badge(&painter, if fits { beside } else { place.at }, place.align, &text, theme::of(ui).text);
        place.at.y = if fits { place.at.y } else { rect.bottom() + theme::GRID };
    }
    below(ui, context, cells, place);
}

/// The method's name, and what is said of it.
fn named(ui: &Ui, context: &PanelContext<'_>, cells: &Cells, mut place: Place) {
    let text = match details(context, cells, place.method) {
        Some(details) => format!("{} · {details}", place.method.label()),
        None => place.method.label(),
    };
    let rect = badge(&ui.painter_at(cells.picture), place.at, place.align, &text, theme::of(ui).strong);
    let x = if place.align == Align2::LEFT_TOP { rect.left() } else { rect.right() };
    place.at = pos2(x, rect.bottom() + theme::GRID);
    below(ui, context, cells, place);
}

/// What keeps the picture from being what was asked for, and the figures.
fn below(ui: &Ui, context: &PanelContext<'_>, cells: &Cells, mut place: Place) {
    let method = place.method;
    let note = if method.shows_lobes() { lobes_note(context) } else { channels_note(context, method) };
    if let Some(text) = &note {
        let rect = badge(&ui.painter_at(cells.picture), place.at, place.align, text, theme::of(ui).warning);
        place.at.y = rect.bottom() + theme::GRID;
    }
    // A rival of which something is said has no picture.
    let is_drawn = note.is_none() || method.shows_lobes();
    if method != Method::Truth && is_drawn && !context.view.hides_figures {
        figures::show(ui, context, cells, (place.index, method), (place.at, place.align));
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

/// What there is to say of a method beside its name.
fn details(context: &PanelContext<'_>, cells: &Cells, method: Method) -> Option<String> {
    match method {
        Method::Truth => Some(samples(context, cells)),
        Method::Rival(_) => None,
        Method::Vmf | Method::VmfUnaligned => Some(format!("J = {}", lobe_count(context.session.fit_settings()))),
    }
}

/// The truth's samples per pixel and, where it is known, its own standard error, in the normalisation of the colour
/// error.
fn samples(context: &PanelContext<'_>, cells: &Cells) -> String {
    let report = context.surroundings.target.status.get();
    let (samples, all) = (report.truth_samples, context.session.truth_samples);
    let text = if samples < all { format!("{samples} of {all} spp") } else { format!("{samples} spp") };
    // Without the finest levels it is the truth of a smoother map.
    let level = if report.left_out > 0 { format!(" of level {}", report.left_out) } else { String::new() };
    let error = context.live_figures.standard_error().filter(|_| figures::is_current(context, cells));
    let error = error.map_or_else(String::new, |error| format!(" ± {error:.4}"));
    format!("{text}{error}{level}")
}

/// What keeps a rival from being shown.
fn channels_note(context: &PanelContext<'_>, method: Method) -> Option<String> {
    let rival = method.rival()?;
    let text = if !rival.is_drawn() {
        "too many bands to draw"
    } else if context.session.is_building() && context.session.channels_of(method).is_none() && rival.kind.has_channels
    {
        "being built"
    } else {
        return None;
    };
    Some(text.to_owned())
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
fn lobes_note(context: &PanelContext<'_>) -> Option<String> {
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
    Some(text)
}
