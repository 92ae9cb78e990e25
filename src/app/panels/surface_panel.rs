//! The lit surface: two methods beside each other at a wipe, and what the pointer does there.

use egui::{CursorIcon, Id, PointerButton, Pos2, Rect, Response, Sense, Ui, Vec2, vec2};
use glam::Vec3;

use super::{PanelContext, light_dome, surface_overlay as overlay};
use crate::app::viewport::SurfacePaint;
use crate::app::{Command, theme};
use crate::comparison::Comparison;
use crate::filter::Method;
use crate::lit_surface::LitSurface;
use crate::reference::raster;

/// Height of the bar with the methods.
const BAR: f32 = 32.0;
/// From this width on the bar has room for the wipe, and the picture for the hint.
pub const WIDE: f32 = 480.0;

/// Shows the bar and the picture.
pub fn show(ui: &mut Ui, context: &mut PanelContext<'_>) {
    let whole = ui.available_rect_before_wrap();
    let (bar, picture) = whole.split_top_bottom_at_y(whole.top() + BAR);
    ui.painter().rect_filled(bar, 0.0, theme::PANEL);
    ui.scope_builder(egui::UiBuilder::new().max_rect(bar.shrink2(vec2(12.0, 6.0))), |ui| methods(ui, context));
    let response = ui.allocate_rect(picture, Sense::click_and_drag()).accessible_name("Surface view");
    let size = (picture.size() * ui.pixels_per_point()).round().max(Vec2::splat(1.0));
    let size = [size.x as u32, size.y as u32];
    let paint = SurfacePaint::new(
        context.session,
        context.session.comparison.arrangement(false),
        size,
        &context.surroundings.target,
        ui.ctx(),
    );
    ui.painter().add(paint.shape(picture));
    steer(ui, context, &response);
    pick(context, &response, picture, size);
    let painter = ui.painter_at(picture);
    overlay::outline(&painter, context, picture);
    overlay::badges(&painter, context, picture);
    light_dome::show(ui, context, picture);
    wipe(ui, context, picture);
}

fn methods(ui: &mut Ui, context: &mut PanelContext<'_>) {
    let mut comparison = context.session.comparison;
    let roomy = ui.available_width() > WIDE;
    ui.horizontal_centered(|ui| {
        combo(ui, "Left method", &mut comparison.left);
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            combo(ui, "Right method", &mut comparison.right);
            if roomy {
                between(ui, &mut comparison);
            }
        });
    });
    if comparison != context.session.comparison {
        context.push(Command::SetComparison(comparison));
    }
}

/// What stands between the methods: exchange them, and the wipe.
fn between(ui: &mut Ui, comparison: &mut Comparison) {
    if ui.button("Swap").on_hover_text("Exchange left and right").clicked() {
        std::mem::swap(&mut comparison.left, &mut comparison.right);
    }
    ui.with_layout(egui::Layout::left_to_right(egui::Align::Center), |ui| {
        ui.label(egui::RichText::new("Wipe").color(theme::WEAK));
        ui.spacing_mut().slider_width = (ui.available_width() - theme::GRID).max(40.0);
        ui.spacing_mut().interact_size.y = theme::HANDLE;
        let slider = egui::Slider::new(&mut comparison.wipe, 0.0..=1.0).show_value(false);
        let response = ui.add(slider).interact(Sense::click()).accessible_name("Wipe");
        let response = response.on_hover_text("How much of the picture the left method gets");
        if response.double_clicked() {
            comparison.wipe = Comparison::default().wipe;
        }
    });
}

fn combo(ui: &mut Ui, name: &str, method: &mut Method) {
    let mut methods: Vec<(Method, String)> = Method::offered().map(|method| (method, method.label())).collect();
    if methods.iter().all(|(offered, _)| offered != method) {
        // A session file may name a parameter that is not offered.
        methods.push((*method, method.label()));
    }
    let methods: Vec<(Method, &str)> = methods.iter().map(|(method, label)| (*method, label.as_str())).collect();
    ui.scope(|ui| {
        ui.set_width(104.0);
        crate::app::parameter::combo(ui, name, method, &methods);
    });
}

/// Drag orbits, L + drag or right drag moves the selected light, the wheel dollies.
fn steer(ui: &Ui, context: &mut PanelContext<'_>, response: &Response) {
    let mut surface = context.session.surface.clone();
    let delta = response.drag_delta();
    let light_key = ui.input(|input| input.key_down(egui::Key::L));
    let moves_light =
        response.dragged_by(PointerButton::Secondary) || light_key && response.dragged_by(PointerButton::Primary);
    if moves_light {
        light_dome::drag(&mut surface, &context.view.light, delta);
    } else if response.dragged() {
        surface.camera.orbit(-0.4 * delta.x, 0.4 * delta.y);
    }
    if response.hovered() {
        let scroll = ui.input(|input| input.smooth_scroll_delta().y);
        if scroll != 0.0 {
            surface.camera.dolly((-0.003 * scroll).exp());
        }
    }
    if surface != context.session.surface {
        context.push(Command::SetSurface(surface));
    }
}

/// A click selects the texel that is shaded there, at the level in use.
fn pick(context: &mut PanelContext<'_>, response: &Response, picture: Rect, size: [u32; 2]) {
    let Some(position) = response.interact_pointer_pos().filter(|_| response.clicked()) else { return };
    let inside = (position - picture.min) / picture.size();
    let pixel = [inside.x * size[0] as f32, inside.y * size[1] as f32].map(|v| v.max(0.0) as u32);
    let surface = &context.session.surface;
    let map = context.session.map();
    let coarsest = (map.level_sizes().len() - 1) as f32;
    let levels = context.surroundings.target.status.get().lobe_levels.unwrap_or([0.0, coarsest]);
    if let Some(point) = raster::pick(surface, size, pixel) {
        context.view.pinned_repeat = [point.uv.x, point.uv.y].map(|v| v.max(0.0) as u32);
        let texel = raster::texel_at(surface, map, &point, levels);
        context.push(Command::Select(texel));
    }
}

/// The handle on the picture that moves the wipe.
fn wipe(ui: &Ui, context: &mut PanelContext<'_>, picture: Rect) {
    let mut comparison = context.session.comparison;
    if comparison.left == comparison.right {
        return;
    }
    let x = picture.left() + comparison.wipe * picture.width();
    let handle = Rect::from_center_size(Pos2::new(x, picture.center().y), vec2(18.0, 44.0));
    let response = ui.interact(handle, Id::unique("wipe handle"), Sense::click_and_drag());
    let response = response.on_hover_and_drag_cursor(CursorIcon::ResizeHorizontal).accessible_name("Wipe handle");
    if let Some(position) = response.interact_pointer_pos().filter(|_| response.dragged()) {
        comparison.wipe = ((position.x - picture.left()) / picture.width()).clamp(0.0, 1.0);
    }
    if response.double_clicked() {
        comparison.wipe = Comparison::default().wipe;
    }
    overlay::wipe_handle(&ui.painter_at(picture), handle, response.hovered() || response.dragged());
    if comparison != context.session.comparison {
        context.push(Command::SetComparison(comparison));
    }
}

/// Where a point of the world is seen in the picture; `None` behind the eye.
pub fn project(surface: &LitSurface, picture: Rect, position: Vec3) -> Option<Pos2> {
    let clip = surface.camera.clip_from_world(picture.width() / picture.height()) * position.extend(1.0);
    let place = vec2(clip.x, -clip.y) / clip.w * 0.5 + Vec2::splat(0.5);
    (clip.w > 0.0).then(|| picture.min + place * picture.size())
}
