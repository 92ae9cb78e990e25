//! What is seen: layout, views of two methods, zoom, exposure, the sphere.

use egui::{Key, Modifiers};

use super::looks;
use super::methods::change;
use super::texels;
use super::{Action, Facts, Menu};
use crate::app::Command;
use crate::app::dock::Preset;
use crate::app::view_state::{Layout, ViewState};
use crate::comparison::View;
use crate::lit_surface::LitSurface;
use crate::scene::{Camera, SphereOrbit};

const EXPOSURES: [f32; 2] = [-8.0, 8.0];
const EXPOSURE_STEP: f32 = 0.5;
const ZOOM_STEP: f32 = 1.25;
const ZOOMS: [f32; 2] = [0.25, 256.0];

pub fn actions() -> Vec<Action> {
    [presets(), sides(), layouts(), views(), zoom(), exposure(), texels::actions(), sphere(), resets()]
        .into_iter()
        .flatten()
        .chain(looks::actions())
        .collect()
}

fn of_view(name: &str, label: &str, change: fn(&mut ViewState)) -> Action {
    Action::of_view(Menu::View, name, label, change)
}

fn presets() -> Vec<Action> {
    let preset = |name, label, change, key| of_view(name, label, change).inside("Presets").key(Modifiers::SHIFT, key);
    vec![
        preset("preset-inspect", "Inspect", |view| view.choose(Preset::Inspect), Key::F2),
        preset("preset-compare", "Compare", |view| view.choose(Preset::Compare), Key::F3),
        preset("preset-tune", "Tune", |view| view.choose(Preset::Tune), Key::F4),
        preset("preset-map-only", "Map only", |view| view.choose(Preset::MapOnly), Key::F5),
    ]
}

/// Switches of the panels beside the main ones.
fn sides() -> Vec<Action> {
    let switch = |name, label, change| of_view(name, label, change).inside("Panels");
    vec![
        switch("panel-controls", "Show or hide controls", |view| view.dock.sides.controls ^= true),
        switch("panel-texel", "Show or hide texel", |view| view.dock.sides.texel ^= true),
        switch("panel-levels", "Show or hide levels", |view| view.dock.sides.levels ^= true),
    ]
}

fn layouts() -> Vec<Action> {
    let main = |name, label, change, key| of_view(name, label, change).inside("Main panels").key(Modifiers::NONE, key);
    vec![
        main("layout-surface", "Surface", |view| view.layout = Layout::Surface, Key::F2),
        main("layout-split", "Split", |view| view.layout = Layout::Split, Key::F3),
        main("layout-map", "Map", |view| view.layout = Layout::Map, Key::F4),
        main("layout-figures", "Figures", |view| view.layout = Layout::Figures, Key::F5),
        main("layout-surface-figures", "Surface and figures", |view| view.layout = Layout::SurfaceFigures, Key::F6),
    ]
}

fn views() -> Vec<Action> {
    let key = |view| match view {
        View::Wipe => (Modifiers::NONE, Key::W),
        View::Flip => (Modifiers::SHIFT, Key::W),
        View::Difference => (Modifiers::NONE, Key::D),
        View::Grid2x2 => (Modifiers::NONE, Key::G),
        View::Grid3x3 => (Modifiers::SHIFT, Key::G),
    };
    let action = |(view, label): (View, &str)| {
        let make = move |facts: &Facts<'_>| change(facts, |comparison| comparison.view = view);
        let action = Action::new(Menu::View, format!("view-{view}"), label, make);
        let (modifiers, key) = key(view);
        let action = action.key(modifiers, key);
        if view == View::Wipe { action.after_rule() } else { action }
    };
    View::ALL.into_iter().map(action).collect()
}

fn zoom() -> Vec<Action> {
    vec![
        Action::new(Menu::View, "fit-view", "Fit in view", |facts| {
            if facts.view.layout == Layout::Map {
                return Some(Command::ChangeView(|view| {
                    view.map = view.map.whole();
                }));
            }
            surface(facts, |surface| surface.camera.distance = Camera::default().distance)
        })
        .key(Modifiers::NONE, Key::F)
        .after_rule(),
        Action::new(Menu::View, "zoom-in", "Zoom in", |facts| {
            zoomed(facts, 1.0 / ZOOM_STEP, |view| scale(view, ZOOM_STEP))
        })
        .key(Modifiers::NONE, Key::Plus)
        .key(Modifiers::NONE, Key::Equals)
        .repeating(),
        Action::new(Menu::View, "zoom-out", "Zoom out", |facts| {
            zoomed(facts, ZOOM_STEP, |view| scale(view, 1.0 / ZOOM_STEP))
        })
        .key(Modifiers::NONE, Key::Minus)
        .repeating(),
        of_view("live-figures", "Figures on the picture", |view| view.hides_figures = !view.hides_figures).after_rule(),
        of_view("dolly", "Run or stop the dolly", |view| view.dolly.is_playing = !view.dolly.is_playing)
            .key(Modifiers::NONE, Key::P),
    ]
}

/// Zooms the map where it stands alone, else moves the camera.
fn zoomed(facts: &Facts<'_>, dolly: f32, map: fn(&mut ViewState)) -> Option<Command> {
    if facts.view.layout == Layout::Map {
        return Some(Command::ChangeView(map));
    }
    surface(facts, |surface| surface.camera.dolly(dolly))
}

fn scale(view: &mut ViewState, factor: f32) {
    view.map.zoom = (view.map.zoom * factor).clamp(ZOOMS[0], ZOOMS[1]);
}

fn exposure() -> Vec<Action> {
    let by = |stops: f32| {
        move |facts: &Facts<'_>| {
            surface(facts, |surface| {
                surface.exposure_stops = (surface.exposure_stops + stops).clamp(EXPOSURES[0], EXPOSURES[1]);
            })
        }
    };
    vec![
        Action::new(Menu::View, "exposure-up", "Half a stop brighter", by(EXPOSURE_STEP))
            .key(Modifiers::NONE, Key::E)
            .repeating()
            .after_rule(),
        Action::new(Menu::View, "exposure-down", "Half a stop darker", by(-EXPOSURE_STEP))
            .key(Modifiers::SHIFT, Key::E)
            .repeating(),
        Action::new(Menu::View, "exposure-reset", "Exposure 0", |facts| {
            surface(facts, |surface| surface.exposure_stops = 0.0)
        })
        .key(Modifiers::NONE, Key::Num0),
    ]
}

fn sphere() -> Vec<Action> {
    let from = |name, label, change| of_view(name, label, change).inside("Sphere from");
    vec![
        from("sphere-top", "Top", |view| view.sphere_orbit = SphereOrbit::TOP),
        from("sphere-side", "Side", |view| view.sphere_orbit = SphereOrbit::SIDE),
        from("sphere-free", "Free", |view| view.sphere_orbit = SphereOrbit::default()),
    ]
}

fn resets() -> Vec<Action> {
    vec![
        of_view("reset-layout", "Reset layout", |view| view.choose(view.dock.preset)).after_rule(),
        of_view("reset-view", "Reset view", |view| *view = ViewState::default()),
        Action::new(Menu::View, "reset-camera", "Reset camera", |facts| {
            surface(facts, |surface| surface.camera = Camera::default())
        }),
    ]
}

/// The command that changes the surface.
fn surface(facts: &Facts<'_>, change: impl FnOnce(&mut LitSurface)) -> Option<Command> {
    let mut surface = facts.session.surface.clone();
    change(&mut surface);
    Some(Command::SetSurface(surface))
}
