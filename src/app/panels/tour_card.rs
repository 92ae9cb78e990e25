//! The card of the tour: what a step has to say, beside the panel that it points at.

use egui::{Align, Align2, Area, Button, Context, Frame, Id, Label, LayerId, Layout, Order, Pos2, Rect, RichText, Ui};
use egui::{Shape, Stroke, StrokeKind, Vec2, vec2};

use crate::app::dock::Panel;
use crate::app::theme;
use crate::app::tour::{STEPS, Step, Target, Tour};

const WIDTH: f32 = 300.0;
/// From the card to what it points at.
const GAP: f32 = 16.0;

/// Shows the step there is; `target` is where it points. True once the tour was left or has come to its end.
pub fn show(ctx: &Context, tour: &mut Tour, target: impl Fn(Target) -> Option<Rect>) -> bool {
    let Some((index, step)) = tour.step() else { return false };
    let mut area = Area::new(Id::unique("tour")).order(Order::Foreground).constrain(true);
    match target(step.target) {
        Some(rect) => {
            let (pivot, at, towards) = beside(step.target, rect);
            point(ctx, rect, at, towards);
            area = area.pivot(pivot).fixed_pos(at);
        }
        None => area = area.anchor(Align2::CENTER_CENTER, Vec2::ZERO),
    }
    area.show(ctx, |ui| {
        let palette = theme::of(ui);
        let frame = Frame::popup(ui.style()).inner_margin(14).stroke(Stroke::new(1.0, palette.accent));
        frame.show(ui, |ui| card(ui, tour, index, step));
    });
    tour.step().is_none()
}

/// Where the card stands: the corner that is held, the place of it, and the way from there to the target.
fn beside(target: Target, rect: Rect) -> (Align2, Pos2, Vec2) {
    match target {
        Target::Panel(Panel::Controls) => (Align2::LEFT_BOTTOM, rect.right_bottom() + vec2(GAP, -60.0), Vec2::LEFT),
        Target::Panel(Panel::Texel) => (Align2::RIGHT_BOTTOM, rect.left_bottom() + vec2(-GAP, -60.0), Vec2::RIGHT),
        Target::Panel(Panel::Levels) => (Align2::CENTER_BOTTOM, rect.center_top() - vec2(0.0, GAP), Vec2::DOWN),
        Target::Panel(_) => (Align2::CENTER_BOTTOM, rect.center_bottom() - vec2(0.0, 2.0 * GAP), Vec2::ZERO),
        Target::TopBar => (Align2::RIGHT_TOP, rect.right_bottom() + vec2(-100.0, GAP), Vec2::UP),
    }
}

/// Outlines the target, and points from the card to it.
fn point(ctx: &Context, rect: Rect, at: Pos2, towards: Vec2) {
    let painter = ctx.layer_painter(LayerId::new(Order::Foreground, Id::unique("tour's target")));
    let accent = theme::of(ctx).accent;
    painter.rect_stroke(rect.shrink(1.0), 3.0, Stroke::new(2.0, accent), StrokeKind::Inside);
    let along = vec2(towards.y.abs(), towards.x.abs());
    let back = vec2(-towards.y.abs(), -towards.x.abs()) * 34.0;
    // The tip touches the target, the foot the card.
    let foot = at + if towards.x == 0.0 && towards.y > 0.0 { Vec2::ZERO } else { back };
    if towards != Vec2::ZERO {
        let corners = vec![foot + towards * (GAP - 3.0), foot - along * 8.0, foot + along * 8.0];
        painter.add(Shape::convex_polygon(corners, accent, Stroke::NONE));
    }
}

fn card(ui: &mut Ui, tour: &mut Tour, index: usize, step: Step) {
    let palette = theme::of(ui);
    ui.set_width(WIDTH);
    ui.spacing_mut().item_spacing.y = 2.0 * theme::GRID;
    ui.label(RichText::new(step.title).heading().color(palette.strong));
    ui.add(Label::new(RichText::new(step.text).color(palette.text)).wrap());
    ui.horizontal(|ui| {
        ui.label(RichText::new(format!("{} of {}", index + 1, STEPS.len())).small().color(palette.weak));
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            let is_last = index + 1 == STEPS.len();
            let next = Button::new(if is_last { "Done" } else { "Next" }).selected(true);
            if ui.add(next).accessible_name("Next step of the tour").clicked() {
                tour.next();
            }
            let back = ui.add_enabled(index > 0, Button::new("Back")).accessible_name("Previous step of the tour");
            if back.clicked() {
                tour.back();
            }
            let end = ui.button("Skip").on_hover_text("Help, Tour of the window shows it again");
            if end.accessible_name("End the tour").clicked() {
                tour.end();
            }
        });
    });
}
