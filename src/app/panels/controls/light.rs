//! The lights: which there are, and what the selected one is like.

use egui::{Align, Button, Layout, Ui, vec2};

use super::{color, parameters as p};
use crate::app::light_view::LightView;
use crate::app::panels::{heading, segmented, toggle};
use crate::app::parameter::label;
use crate::app::theme;
use crate::lighting::{Light, Lights, MAX_LIGHTS};

/// Width of a button of the list.
const BUTTON: f32 = 20.0;

/// Shows the group.
pub fn show(ui: &mut Ui, lights: &mut Lights, view: &mut LightView) {
    ui.horizontal(|ui| {
        heading(ui, "Lights");
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            if let Some(index) = view.index(lights) {
                color(ui, "Light colour", &mut lights.as_mut_slice()[index].color, Light::DEFAULT.color);
                toggle(ui, &mut view.is_sweeping, false, "Sweep", "Turns the selected light around the surface");
            }
        });
    });
    ui.horizontal(|ui| list(ui, lights, view));
    if let Some(index) = view.index(lights) {
        selected(ui, &mut lights.as_mut_slice()[index]);
    }
    if view.is_sweeping {
        p::SWEEP_SPEED.show_f32(ui, &mut view.sweep_deg_per_s);
    }
}

/// A button for each light, and those that add one and remove the selected one.
fn list(ui: &mut Ui, lights: &mut Lights, view: &mut LightView) {
    ui.spacing_mut().item_spacing.x = 2.0;
    ui.spacing_mut().button_padding.x = 2.0;
    let small = |button: Button<'static>| button.min_size(vec2(BUTTON, theme::ROW));
    let count = lights.as_slice().len();
    let selected = view.index(lights);
    for index in 0..count {
        let number = index + 1;
        let button = small(Button::selectable(selected == Some(index), number.to_string()));
        if ui.add(button).accessible_name(format!("Light {number}")).clicked() {
            view.selected = index;
        }
    }
    let add = ui.add_enabled(count < MAX_LIGHTS, small(Button::new("+"))).accessible_name("Add light");
    if add.on_hover_text("Adds a light like the selected one, a quarter turn on; there may be eight").clicked() {
        lights.push(another(lights, selected));
        view.selected = count;
    }
    let remove = ui.add_enabled(count > 0, small(Button::new("−"))).accessible_name("Remove light");
    if remove.on_hover_text("Removes the selected light").clicked()
        && let Some(index) = selected
    {
        lights.remove(index);
        view.selected = index.min(lights.as_slice().len().saturating_sub(1));
    }
}

/// The light that is added beside the selected one.
fn another(lights: &Lights, selected: Option<usize>) -> Light {
    let Some(index) = selected else { return Light::DEFAULT };
    let light = lights.as_slice()[index];
    Light { azimuth_deg: (light.azimuth_deg + 270.0).rem_euclid(360.0) - 180.0, ..light }
}

fn selected(ui: &mut Ui, light: &mut Light) {
    ui.horizontal(|ui| {
        label(ui, "Kind");
        let mut is_point = light.distance.is_some();
        segmented(ui, "Kind of light", &mut is_point, false, &[(false, "Directional"), (true, "Point")]);
        if is_point != light.distance.is_some() {
            *light = light.moved_to(is_point.then_some(p::DEFAULT_LIGHT_DISTANCE));
        }
    });
    p::LIGHT_AZIMUTH.show_f32(ui, &mut light.azimuth_deg);
    p::LIGHT_ELEVATION.show_f32(ui, &mut light.elevation_deg);
    if let Some(distance) = &mut light.distance {
        p::LIGHT_DISTANCE.show_f32(ui, distance);
    }
    p::LIGHT_INTENSITY.show_f32(ui, &mut light.intensity);
}
