//! What is shown of texels, and which of them is selected.

use egui::{Key, Modifiers};

use super::{Action, Facts, Menu};
use crate::app::Command;
use crate::app::map_shading::MapShading;
use crate::app::view_state::ViewState;
use crate::normal_map::NormalMap;
use crate::normal_map::pyramid::Texel;

pub fn actions() -> Vec<Action> {
    shadings().into_iter().chain(moves()).collect()
}

fn shadings() -> Vec<Action> {
    let texels = |name: &str, shading: MapShading, change: fn(&mut ViewState)| {
        Action::of_view(Menu::View, name, shading.label(), change).inside("Texels as")
    };
    vec![
        texels("texels-normal", MapShading::Normal, |view| view.map.shading = MapShading::Normal),
        texels("texels-slope", MapShading::Slope, |view| view.map.shading = MapShading::Slope),
        texels("texels-length", MapShading::Length, |view| view.map.shading = MapShading::Length),
        texels("texels-red", MapShading::Red, |view| view.map.shading = MapShading::Red),
        texels("texels-green", MapShading::Green, |view| view.map.shading = MapShading::Green),
        texels("texels-blue", MapShading::Blue, |view| view.map.shading = MapShading::Blue),
        texels("texels-alpha", MapShading::Alpha, |view| view.map.shading = MapShading::Alpha),
        texels("texels-lobes", MapShading::Lobes, |view| view.map.shading = MapShading::Lobes),
        texels("texels-count", MapShading::Count, |view| view.map.shading = MapShading::Count),
        texels("texels-kappa", MapShading::Kappa, |view| view.map.shading = MapShading::Kappa),
        texels("texels-coherence", MapShading::Coherence, |view| view.map.shading = MapShading::Coherence),
        texels("texels-error", MapShading::Error, |view| view.map.shading = MapShading::Error),
    ]
}

/// Steps of the selection: columns, rows and levels.
fn moves() -> Vec<Action> {
    let step = |name: &str, label: &str, key: Key, by: [isize; 3]| {
        let make = move |facts: &Facts<'_>| {
            let selected = facts.session.selected();
            let moved = stepped(facts.session.map(), selected, by);
            (moved != selected).then_some(Command::Select(moved))
        };
        Action::new(Menu::View, name, label, make).key(Modifiers::NONE, key).repeating().inside("Select texel")
    };
    vec![
        step("texel-left", "Left", Key::ArrowLeft, [-1, 0, 0]),
        step("texel-right", "Right", Key::ArrowRight, [1, 0, 0]),
        step("texel-up", "Up", Key::ArrowUp, [0, -1, 0]),
        step("texel-down", "Down", Key::ArrowDown, [0, 1, 0]),
        step("texel-coarser", "Of the next coarser level", Key::PageUp, [0, 0, 1]),
        step("texel-finer", "Of the next finer level", Key::PageDown, [0, 0, -1]),
    ]
}

/// The texel so many columns, rows and levels away, under the middle of the texel there; the nearest that the map has.
fn stepped(map: &NormalMap, texel: Texel, [columns, rows, levels]: [isize; 3]) -> Texel {
    let level = texel.level.saturating_add_signed(levels).min(map.level_sizes().len() - 1);
    let (from, to) = (map.level_size(texel.level), map.level_size(level));
    let place = |index: usize, by: isize, from: usize, to: usize| {
        let index = index.saturating_add_signed(by).min(from - 1);
        (2 * index + 1) * to / (2 * from)
    };
    Texel { level, x: place(texel.x, columns, from.0, to.0), y: place(texel.y, rows, from.1, to.1) }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::app::history::History;
    use crate::normal_map::procedural;
    use crate::session::Session;

    #[test]
    fn a_level_up_covers_the_texel_and_a_level_down_lies_in_it() {
        let map = procedural::find("waves").expect("bundled").make(20);
        let texel = |level, x, y| Texel { level, x, y };
        let by = |texel, by| stepped(&map, texel, by);
        assert_eq!(by(texel(1, 9, 4), [0, 0, 1]), texel(2, 4, 2));
        assert_eq!(by(texel(2, 4, 2), [0, 0, -1]), texel(1, 9, 5));
        assert_eq!(by(texel(4, 0, 0), [0, 0, 1]), texel(4, 0, 0), "there is no level above the top");
        assert_eq!(by(texel(0, 7, 3), [0, 0, -1]), texel(0, 7, 3), "nor one below the base");
        assert_eq!(by(texel(1, 9, 0), [1, -1, 0]), texel(1, 9, 0), "nor a texel beyond the edge");
        assert_eq!(by(texel(1, 8, 1), [1, -1, 0]), texel(1, 9, 0));
    }

    #[test]
    fn every_shading_has_an_action_that_shows_it() {
        let (session, history) = (Session::new(Arc::new(|| {})), History::default());
        for ((shading, ..), action) in MapShading::ALL.into_iter().zip(shadings()) {
            let mut view = ViewState::default();
            match action.command(&Facts { session: &session, view: &view, history: &history }) {
                Some(Command::ChangeView(change)) => change(&mut view),
                other => panic!("{other:?}"),
            }
            assert_eq!(view.map.shading, shading, "{}", action.name);
        }
        assert_eq!(shadings().len(), MapShading::ALL.len());
    }
}
