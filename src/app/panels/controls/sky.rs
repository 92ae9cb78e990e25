//! The sky: which lights the surface, and how.

use egui::{Button, RichText, Ui};

use super::parameters as p;
use crate::app::panels::{PanelContext, heading, toggle};
use crate::app::parameter::{checkbox, choice, label};
use crate::app::{Command, theme};
use crate::lighting::{ProceduralSky, Sky, SkySource};

/// What the list offers.
#[derive(Clone, Copy, PartialEq)]
enum Choice {
    None,
    Bundled(ProceduralSky),
    File,
}

/// Shows the group; what changes at once goes into `sky`.
pub fn show(ui: &mut Ui, context: &mut PanelContext<'_>, sky: &mut Sky) {
    ui.horizontal(|ui| {
        heading(ui, "Sky");
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            let open = ui.add_sized([56.0, theme::ROW], Button::new("Open…")).accessible_name("Open sky…");
            if open.on_hover_text(p::SKY_FILE).clicked() {
                context.push(Command::OpenSkyDialog);
            }
            if sky.environment.is_some() {
                toggle(ui, &mut sky.is_seen, Sky::default().is_seen, "Seen", "Shows the sky behind the surface");
            }
        });
    });
    source(ui, context, sky);
    if context.session.is_opening_sky() {
        ui.label(RichText::new("Reading a sky").small().color(theme::of(ui).accent));
    }
    if let Some(environment) = &sky.environment {
        let has_sun = environment.sun.is_some();
        p::SKY_ROTATION.show_f32(ui, &mut sky.rotation_deg);
        p::SKY_INTENSITY.show_f32(ui, &mut sky.intensity);
        let mut band = sky.last_band();
        if p::SKY_BANDS.show_count(ui, &mut band) {
            sky.last_band = band as u8;
        }
        if has_sun {
            ui.horizontal(|ui| {
                label(ui, "Sun");
                checkbox(ui, &mut sky.is_sun_apart, Sky::default().is_sun_apart, "a light of its own", p::SKY_SUN);
            });
        }
    }
}

fn source(ui: &mut Ui, context: &mut PanelContext<'_>, sky: &mut Sky) {
    let name = sky.environment.as_ref().map(|environment| environment.source.clone());
    let current = match &name {
        None => Choice::None,
        Some(SkySource::Bundled(sky)) => Choice::Bundled(*sky),
        Some(SkySource::Path(_)) => Choice::File,
    };
    let file = name.map_or_else(String::new, |name| name.short_name());
    let mut choices = vec![(Choice::None, "none")];
    choices.extend(ProceduralSky::ALL.map(|sky| (Choice::Bundled(sky), sky.name())));
    if current == Choice::File {
        choices.push((Choice::File, &file));
    }
    match choice(ui, "Environment", p::SKY, current, &choices) {
        Some(Choice::None) => sky.environment = None,
        Some(Choice::Bundled(sky)) => context.push(Command::OpenSky(SkySource::Bundled(sky))),
        Some(Choice::File) | None => {}
    }
}
