//! The row above the picture that chooses how methods are seen, and the dolly.

use egui::{Align, Button, DragValue, Layout, Rect, RichText, Sense, Shape, Slider, SliderClamping, Stroke, Ui, vec2};

use super::ROOMY;
use crate::app::dolly::{self, Dolly};
use crate::app::panels::{segmented, toggle};
use crate::app::{ViewState, parameter, theme};
use crate::comparison::View;
use crate::scene::Camera;

/// Width of the distance's number.
const NUMBER: f32 = 44.0;

const FIGURES: &str = "Each method's error against the truth, its time and its bytes. The truth is drawn for it even \
                       where it is not in sight.";

/// Shows the row.
pub fn show(ui: &mut Ui, view: &mut ViewState, chosen: &mut View, camera: &mut Camera) {
    let roomy = ui.available_width() > ROOMY;
    ui.horizontal(|ui| {
        if roomy {
            ui.scope(|ui| segmented(ui, "Seen as", chosen, View::default(), &View::ALL));
        } else {
            ui.scope(|ui| {
                ui.set_width(84.0);
                parameter::combo(ui, "Seen as", chosen, &View::ALL);
            });
        }
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            if roomy {
                let mut on = !view.hides_figures;
                toggle(ui, &mut on, true, "Figures", FIGURES);
                view.hides_figures = !on;
            }
            distance(ui, &mut view.dolly, camera, roomy);
        });
    });
}

/// The camera's distance as a number, a slider, and a button that runs it; laid out from the right.
fn distance(ui: &mut Ui, dolly: &mut Dolly, camera: &mut Camera, roomy: bool) {
    let speed = 0.01 * camera.distance;
    let typed = DragValue::new(&mut camera.distance)
        .range(Camera::MIN_DISTANCE..=Camera::MAX_DISTANCE)
        .speed(speed)
        .max_decimals(2)
        .update_while_editing(false);
    let typed = ui.add_sized([NUMBER, theme::ROW], typed).accessible_name("Distance value");
    let label = if roomy { 2.0 * theme::ROW + 24.0 } else { 32.0 };
    ui.spacing_mut().slider_width = (ui.available_width() - label).clamp(24.0, 180.0);
    let height = std::mem::replace(&mut ui.spacing_mut().interact_size.y, theme::HANDLE);
    let [near, far] = dolly::RANGE;
    let slider = Slider::new(&mut camera.distance, near..=far).logarithmic(true).show_value(false);
    let slider = slider.clamping(SliderClamping::Edits);
    let slider = ui.add(slider).interact(Sense::click()).accessible_name("Distance");
    ui.spacing_mut().interact_size.y = height;
    for response in [typed, slider] {
        if response.double_clicked() {
            camera.distance = Camera::default().distance;
        }
        response.on_hover_text("From the eye to the surface's centre. Double click resets.");
    }
    if play_button(ui, dolly.is_playing) {
        dolly.is_playing = !dolly.is_playing;
    }
    if roomy {
        ui.label(RichText::new("Dolly").color(theme::of(ui).weak));
    }
}

/// The button that runs and stops the dolly; true where it is pressed. Its sign is drawn: fonts lack it.
fn play_button(ui: &mut Ui, is_playing: bool) -> bool {
    let (name, tooltip) = match is_playing {
        true => ("Stop the dolly", "Stops the camera"),
        false => ("Run the dolly", "Runs the camera away and back, so that popping and shimmer show"),
    };
    let response = ui.add(Button::new("").min_size(vec2(24.0, theme::ROW))).on_hover_text(tooltip);
    let (at, color) = (response.rect.center(), ui.style().interact(&response).text_color());
    if is_playing {
        for x in [-3.0, 3.0] {
            ui.painter().rect_filled(Rect::from_center_size(at + vec2(x, 0.0), vec2(3.0, 10.0)), 0.0, color);
        }
    } else {
        let corners = [vec2(-4.0, -5.0), vec2(5.0, 0.0), vec2(-4.0, 5.0)].map(|corner| at + corner);
        ui.painter().add(Shape::convex_polygon(corners.into(), color, Stroke::NONE));
    }
    response.accessible_name(name).clicked()
}
