//! A region of pictures: drawn with Shift + drag in any of them, seen in all, cleared by a double click or Esc.

use egui::{Align2, Color32, FontId, Key, Painter, PointerButton, Pos2, Rect, Response, Stroke, StrokeKind, Ui, vec2};

use crate::app::theme;
use crate::app::view_state::RegionView;
use crate::reference::Region;

/// Sides below so many points are a slip of the pointer.
const LEAST_SIDE: f32 = 4.0;

/// Follows the pointer over pictures, each of which `cell_at` knows by a position in it; true while it draws a region.
/// `listens` is false where something lies over the window, which is dismissed by the same key.
pub fn drag(
    ui: &Ui,
    view: &mut RegionView,
    listens: bool,
    response: &Response,
    cell_at: impl Fn(Pos2) -> Option<Rect>,
) -> bool {
    let escapes = listens && ui.input(|input| input.key_pressed(Key::Escape));
    if response.double_clicked() || escapes {
        *view = RegionView::default();
    }
    let begins = response.drag_started_by(PointerButton::Primary) && ui.input(|input| input.modifiers.shift);
    if begins && let Some(from) = ui.input(|input| input.pointer.press_origin()) {
        view.drawn_from = cell_at(from).map(|cell| (cell, part(cell, from)));
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

/// Draws the region's outline into a cell, with a name below it.
pub fn show(painter: &Painter, region: Region, cell: Rect, name: Option<&str>) {
    let rect = rect(region, cell);
    painter.rect_stroke(rect, 0.0, Stroke::new(3.0, Color32::from_black_alpha(140)), StrokeKind::Middle);
    painter.rect_stroke(rect, 0.0, Stroke::new(1.5, theme::of(painter).accent), StrokeKind::Middle);
    if let Some(name) = name {
        let at = rect.left_bottom() + vec2(0.0, 3.0);
        let galley = painter.layout_no_wrap(
            format!("{name} · Esc clears"),
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
