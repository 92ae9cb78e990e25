//! The region whose figures are shown: drawn with Shift + drag in any cell, seen in all of them, cleared by a double
//! click or Esc.

use egui::{Align2, Color32, FontId, Key, Painter, PointerButton, Pos2, Rect, Response, Stroke, StrokeKind, Ui, vec2};

use super::cells::Cells;
use crate::app::theme;
use crate::app::view_state::{Overlay, RegionView, ViewState};
use crate::reference::Region;

/// Sides below so many points are a slip of the pointer.
const LEAST_SIDE: f32 = 4.0;

/// Follows the pointer; true while it draws a region.
pub fn drag(ui: &Ui, view: &mut ViewState, response: &Response, cells: &Cells) -> bool {
    // What lies over the window is dismissed by the same key.
    let escapes = view.overlay == Overlay::None && ui.input(|input| input.key_pressed(Key::Escape));
    let view = &mut view.region;
    if response.double_clicked() || escapes {
        *view = RegionView::default();
    }
    let begins = response.drag_started_by(PointerButton::Primary) && ui.input(|input| input.modifiers.shift);
    if begins && let Some(from) = ui.input(|input| input.pointer.press_origin()) {
        view.drawn_from = cells.at(from).map(|cell| (cell, part(cell, from)));
    }
    let Some((cell, from)) = view.drawn_from else { return false };
    if let Some(to) = response.interact_pointer_pos() {
        let region = Region::between(from, part(cell, to));
        let sides = rect(region, cell).size();
        view.chosen = (sides.min_elem() >= LEAST_SIDE).then_some(region);
    }
    if response.drag_stopped() || !response.dragged() {
        view.drawn_from = None;
    }
    true
}

/// Draws the region's outline into a cell; `named` says what it is.
pub fn show(painter: &Painter, region: Region, cell: Rect, named: bool) {
    let rect = rect(region, cell);
    painter.rect_stroke(rect, 0.0, Stroke::new(3.0, Color32::from_black_alpha(140)), StrokeKind::Middle);
    painter.rect_stroke(rect, 0.0, Stroke::new(1.5, theme::of(painter).accent), StrokeKind::Middle);
    if named {
        let at = rect.left_bottom() + vec2(0.0, 3.0);
        let galley = painter.layout_no_wrap(
            "figures of this region · Esc clears".to_owned(),
            FontId::proportional(11.0),
            theme::of(painter).accent,
        );
        let place = Align2::LEFT_TOP.anchor_size(at, galley.size() + vec2(8.0, 4.0));
        painter.rect_filled(place, 3.0, theme::of(painter).badge);
        painter.galley(place.min + vec2(4.0, 2.0), galley, theme::of(painter).accent);
    }
}

/// A position as parts of the cell's width and height.
fn part(cell: Rect, position: Pos2) -> [f32; 2] {
    ((position - cell.min) / cell.size()).into()
}

fn rect(region: Region, cell: Rect) -> Rect {
    let place = |[x, y]: [f32; 2]| cell.min + vec2(x, y) * cell.size();
    Rect::from_min_max(place(region.min), place(region.max))
}
