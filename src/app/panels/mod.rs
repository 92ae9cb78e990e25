//! The panels, one file each. A panel reads the session, keeps its own view state, and pushes commands.

pub mod about_button;
pub mod brdf_section;
pub mod controls;
pub mod export_window;
pub mod figures_panel;
pub mod judged_method;
pub mod key_list;
pub mod light_dome;
pub mod lobe_table;
pub mod log_panel;
pub mod map_panel;
pub mod needles;
pub mod palette;
pub mod region;
pub mod save_session;
pub mod scale_bar;
pub mod small_plot;
pub mod sphere_panel;
pub mod status_bar;
pub mod surface_overlay;
pub mod surface_panel;
pub mod toasts;
pub mod top_bar;
pub mod tour_card;
pub mod trace_plot;

use egui::text::{CCursor, CCursorRange};
use egui::text_edit::TextEditState;
use egui::{Response, RichText, Ui};

use super::actions::Facts;
use super::brdf_report::BrdfReport;
use super::disc_textures::DiscTextures;
use super::error_report::ErrorReport;
use super::exports::Exports;
use super::figures_report::FiguresReport;
use super::history::History;
use super::inspector::Surroundings;
use super::level_histogram::KeptHistogram;
use super::live_figures::LiveFigures;
use super::map_picture::MapTextures;
use super::texel_report::TexelReport;
use super::trace_report::TraceReport;
use super::{Command, ViewState, theme};
use crate::session::{Message, Session};

/// What panels see and may touch.
pub struct PanelContext<'a> {
    /// The document, to be read.
    pub session: &'a Session,
    /// The view, the panels' own.
    pub view: &'a mut ViewState,
    /// What is to be done.
    pub commands: &'a mut Vec<Command>,
    /// The selected texel.
    pub report: &'a TexelReport,
    /// Its effective BRDF.
    pub brdf: &'a BrdfReport,
    /// How its fit went.
    pub trace: &'a TraceReport,
    /// How far a method is from the truth in every texel.
    pub errors: &'a ErrorReport,
    /// What was measured.
    pub figures: &'a FiguresReport,
    /// What is being exported.
    pub exports: &'a mut Exports,
    /// Figures of the methods on show.
    pub live_figures: &'a LiveFigures,
    /// What can be undone.
    pub history: &'a History,
    /// What the user was told so far.
    pub said: &'a [Message],
    /// Levels as textures.
    pub textures: &'a mut MapTextures,
    /// Effective BRDFs as textures.
    pub discs: &'a mut DiscTextures,
    /// How a level's numbers are spread.
    pub histogram: &'a mut KeptHistogram,
    /// Where all this is shown.
    pub surroundings: &'a Surroundings,
    /// What lies under the pointer, for the status bar.
    pub hover: &'a mut Option<String>,
}

impl PanelContext<'_> {
    /// Asks for something.
    pub fn push(&mut self, command: Command) {
        self.commands.push(command);
    }

    /// What actions look at.
    pub fn facts(&self) -> Facts<'_> {
        Facts { session: self.session, view: self.view, history: self.history }
    }
}

/// A line across the panel.
pub fn rule(ui: &mut Ui) {
    ui.add_space(theme::GRID);
    let (rect, _) = ui.allocate_exact_size(egui::vec2(ui.available_width(), 1.0), egui::Sense::hover());
    ui.painter().rect_filled(rect, 0.0, theme::of(ui).line);
    ui.add_space(2.0);
}

/// The heading of a group.
pub fn heading(ui: &mut Ui, title: &str) {
    ui.label(RichText::new(title).strong().size(13.0).color(theme::of(ui).strong));
}

/// A button that is on or off; a double click brings the default back.
pub fn toggle(ui: &mut Ui, on: &mut bool, default: bool, text: &str, tooltip: &str) -> Response {
    let state = if default { "on" } else { "off" };
    let tooltip = format!("{tooltip}\nDefault {state}. Double click resets.");
    let response = ui.add(egui::Button::selectable(*on, text)).on_hover_text(tooltip);
    if response.double_clicked() {
        *on = default;
    } else if response.clicked() {
        *on = !*on;
    }
    response
}

/// Focuses a text field with all of its text selected, so that typing takes the place of what is suggested.
pub fn focus_whole(field: &Response, text: &str) {
    field.request_focus();
    let mut state = TextEditState::load(&field.ctx, field.id).unwrap_or_default();
    let whole = CCursorRange::two(CCursor::new(0), CCursor::new(text.chars().count()));
    state.cursor.set_char_range(Some(whole));
    state.store(&field.ctx, field.id);
}

/// A row of buttons of which one is chosen; a double click on any of them brings the default back, which is true if it
/// happened.
pub fn segmented<T: Copy + PartialEq>(
    ui: &mut Ui,
    group: &str,
    chosen: &mut T,
    default: T,
    choices: &[(T, &str)],
) -> bool {
    ui.spacing_mut().item_spacing.x = 2.0;
    let mut is_reset = false;
    for &(value, text) in choices {
        let response = ui.add(egui::Button::selectable(*chosen == value, text));
        if response.double_clicked() {
            (*chosen, is_reset) = (default, true);
        } else if response.clicked() {
            *chosen = value;
        }
        response.accessible_name(format!("{group}: {text}"));
    }
    is_reset
}
