//! The panels, docked: each has a tab, by which it is dragged to another place, and edges that resize it.
//!
//! The view says which panels are in sight and where they stand; the tree of tiles follows it, and writes back what
//! the pointer does.

use egui::{Button, Color32, Id, Margin, Rect, Response, RichText, Stroke, Ui, UiBuilder, WidgetText};
use egui_tiles::{Behavior, EditAction, SimplificationOptions, Tabs, TileId, Tiles, Tree, UiResponse};
use serde::{Deserialize, Serialize};

use super::panels::{PanelContext, controls, figures_panel, map_panel, segmented, sphere_panel, surface_panel};
use super::theme;
use super::view_state::Layout;

pub mod place;
pub mod preset;
mod sizes;

pub use place::Place;
pub use preset::{Panel, Preset, Sides};

/// Height of a row of tabs.
const TAB_HEIGHT: f32 = 22.0;
/// No panel is made smaller, points.
const LEAST_SIZE: f32 = 120.0;
/// A panel that is narrower stays empty, points.
const LEAST_WIDTH: f32 = 100.0;
/// From this width on a row of tabs has room for the choice of main panels.
const LAYOUT_ROOM: f32 = 320.0;

/// What of it a session file keeps, beside the main panels' [`Layout`].
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct DockView {
    /// The preset that was chosen last.
    pub preset: Preset,
    /// What is shown beside the main panels.
    pub sides: Sides,
    /// Where panels were moved to; `None` where they stand by default.
    pub place: Option<Place>,
}

/// The tree of tiles, and where it was shown.
#[derive(Default)]
pub struct Dock {
    tree: Option<Tree<Panel>>,
    place: Option<Place>,
    shown: Vec<(Panel, Rect)>,
}

impl Dock {
    /// Shows the panels in sight.
    pub fn show(&mut self, ui: &mut Ui, context: &mut PanelContext<'_>) {
        if self.place != context.view.dock.place {
            self.tree = None;
        }
        let place = &mut self.place;
        let tree = self.tree.get_or_insert_with(|| {
            place.clone_from(&context.view.dock.place);
            place::tree(&place.clone().unwrap_or_else(place::default_place))
        });
        for panel in Panel::ALL {
            tree.set_visible(place::tile(panel), context.view.shows(panel));
        }
        if let Some(root) = tree.root() {
            sizes::spread(&mut tree.tiles, root, ui.available_size_before_wrap());
        }
        let mut docked = Docked { context, shown: Vec::new(), is_edited: false, offers_layouts: true };
        tree.ui(&mut docked, ui);
        self.shown = docked.shown;
        if docked.is_edited {
            tree.simplify(&SIMPLE);
            self.place = place::read(tree);
            context.view.dock.place.clone_from(&self.place);
            ui.ctx().request_repaint();
        }
    }

    /// Where a panel was shown last; `None` where it is out of sight.
    pub fn rect(&self, panel: Panel) -> Option<Rect> {
        self.shown.iter().find(|(other, _)| *other == panel).map(|(_, rect)| *rect)
    }
}

const SIMPLE: SimplificationOptions = SimplificationOptions {
    prune_empty_tabs: true,
    prune_empty_containers: true,
    prune_single_child_tabs: true,
    prune_single_child_containers: true,
    all_panes_must_have_tabs: true,
    join_nested_linear_containers: false,
    flatten_tabs_in_tabs: true,
};

/// The panels while they are shown.
struct Docked<'a, 'b> {
    context: &'a mut PanelContext<'b>,
    shown: Vec<(Panel, Rect)>,
    is_edited: bool,
    /// True until the choice of main panels was shown.
    offers_layouts: bool,
}

impl Docked<'_, '_> {
    fn contents(&mut self, ui: &mut Ui, panel: Panel) {
        let context = &mut *self.context;
        match panel {
            Panel::Controls => controls::show(ui, context),
            Panel::Surface => surface_panel::show(ui, context),
            Panel::Map => map_panel::show(ui, context),
            Panel::Figures => figures_panel::show(ui, context),
            Panel::Texel => sphere_panel::show(ui, context),
            Panel::Levels => map_panel::strip(ui, context),
        }
    }
}

fn margin(panel: Panel) -> Margin {
    match panel {
        Panel::Controls | Panel::Texel => Margin { left: 12, right: 6, top: 6, bottom: 4 },
        Panel::Levels => Margin { left: 12, right: 12, top: 5, bottom: 2 },
        Panel::Surface | Panel::Map | Panel::Figures => Margin::ZERO,
    }
}

impl Behavior<Panel> for Docked<'_, '_> {
    fn pane_ui(&mut self, ui: &mut Ui, _tile: TileId, panel: &mut Panel) -> UiResponse {
        let (panel, rect, palette) = (*panel, ui.max_rect(), theme::of(ui));
        self.shown.push((panel, rect));
        let fill = if panel.is_main() { palette.canvas } else { palette.panel };
        ui.painter().rect_filled(rect, 0.0, fill);
        // Its controls keep their names inside the toolkit wherever it stands.
        let builder = UiBuilder::new().scope_id(Id::unique(("panel", panel))).max_rect(rect - margin(panel));
        // Controls cannot be laid out in less.
        if rect.width() >= LEAST_WIDTH && rect.height() >= TAB_HEIGHT {
            ui.scope_builder(builder, |ui| {
                ui.shrink_clip_rect(rect);
                self.contents(ui, panel);
            });
        }
        UiResponse::None
    }

    fn tab_title_for_pane(&mut self, panel: &Panel) -> WidgetText {
        RichText::new(panel.title()).size(11.5).into()
    }

    fn on_tab_button(&mut self, tiles: &mut Tiles<Panel>, tile: TileId, response: Response) -> Response {
        let title = tiles.get_pane(&tile).map_or("several", |panel| panel.title());
        let response = response.on_hover_text("Drag to dock it elsewhere. View, Reset layout brings it back.");
        response.accessible_name(format!("Panel: {title}"))
    }

    fn top_bar_right_ui(&mut self, tiles: &Tiles<Panel>, ui: &mut Ui, _tile: TileId, tabs: &Tabs, _scroll: &mut f32) {
        let Some(panel) = tabs.active.and_then(|active| tiles.get_pane(&active)).copied() else { return };
        ui.spacing_mut().button_padding = egui::vec2(5.0, 0.0);
        ui.spacing_mut().interact_size.y = TAB_HEIGHT - theme::GRID;
        if panel.is_main() {
            if std::mem::take(&mut self.offers_layouts) && ui.available_width() > LAYOUT_ROOM {
                ui.add_space(theme::GRID);
                let default = self.context.view.dock.preset.layout();
                let reversed: Vec<_> = Layout::OFFERED.into_iter().rev().collect();
                ui.scope(|ui| segmented(ui, "Layout", &mut self.context.view.layout, default, &reversed));
            }
        } else {
            ui.add_space(theme::GRID);
            let cross = RichText::new("×").color(theme::of(ui).weak);
            let button = ui.add(Button::new(cross).frame(false)).accessible_name(format!("Hide {}", panel.title()));
            if button.on_hover_text("Hides the panel; View, Panels brings it back").clicked()
                && let Some(shown) = self.context.view.dock.sides.switch(panel)
            {
                *shown = false;
            }
        }
    }

    fn on_edit(&mut self, edit: EditAction) {
        self.is_edited |= edit != EditAction::TileDragged;
    }

    fn is_tile_draggable(&self, tiles: &Tiles<Panel>, tile: TileId) -> bool {
        tiles.get_pane(&tile).is_some()
    }

    fn simplification_options(&self) -> SimplificationOptions {
        SIMPLE
    }

    fn tab_bar_height(&self, _style: &egui::Style) -> f32 {
        TAB_HEIGHT
    }

    fn gap_width(&self, _style: &egui::Style) -> f32 {
        sizes::GAP
    }

    fn min_size(&self) -> f32 {
        LEAST_SIZE
    }

    fn tab_title_spacing(&self, _visuals: &egui::Visuals) -> f32 {
        12.0
    }

    fn tab_bar_color(&self, visuals: &egui::Visuals) -> Color32 {
        visuals.faint_bg_color
    }

    fn tab_outline_stroke(
        &self,
        _visuals: &egui::Visuals,
        _tiles: &Tiles<Panel>,
        _tile: TileId,
        _state: &egui_tiles::TabState,
    ) -> Stroke {
        Stroke::NONE
    }

    fn resize_stroke(&self, style: &egui::Style, state: egui_tiles::ResizeState) -> Stroke {
        match state {
            egui_tiles::ResizeState::Idle => style.visuals.widgets.noninteractive.bg_stroke,
            _ => Stroke::new(1.5, style.visuals.hyperlink_color),
        }
    }
}
