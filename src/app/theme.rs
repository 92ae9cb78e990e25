//! How the window looks: a dark theme on a grid of four points, one accent colour, two sizes of text.

use egui::{Color32, CornerRadius, FontFamily, FontId, Margin, Shadow, Stroke, TextStyle, Theme, Visuals, vec2};

/// The one accent: selection, sliders, progress.
pub const ACCENT: Color32 = Color32::from_rgb(110, 168, 254);
/// Panels.
pub const PANEL: Color32 = Color32::from_rgb(25, 27, 32);
/// What lies behind pictures.
pub const CANVAS: Color32 = Color32::from_rgb(15, 16, 20);
/// Lines between panels.
pub const LINE: Color32 = Color32::from_rgb(44, 48, 56);
/// Text that is read.
pub const TEXT: Color32 = Color32::from_rgb(211, 216, 224);
/// Text that explains.
pub const WEAK: Color32 = Color32::from_rgb(139, 147, 161);
/// Headings.
pub const STRONG: Color32 = Color32::from_rgb(240, 243, 248);
/// Something to know.
pub const WARNING: Color32 = Color32::from_rgb(240, 190, 90);
/// Something that failed; not red alone, the sentence says it.
pub const ERROR: Color32 = Color32::from_rgb(255, 140, 105);
/// Behind labels that lie on pictures.
pub const BADGE: Color32 = Color32::from_rgba_premultiplied(10, 11, 14, 205);

/// One step of the grid.
pub const GRID: f32 = 4.0;
/// Height of a row of controls.
pub const ROW: f32 = 20.0;
/// Height of a slider, which its handle follows.
pub const HANDLE: f32 = 14.0;

/// Dresses a context. Idempotent.
pub fn apply(ctx: &egui::Context) {
    ctx.set_theme(Theme::Dark);
    ctx.all_styles_mut(|style| {
        style.text_styles = text_styles();
        style.visuals = visuals();
        style.animation_time = 0.0;
        style.spacing.item_spacing = vec2(2.0 * GRID, GRID);
        style.spacing.button_padding = vec2(2.0 * GRID, 2.0);
        style.spacing.interact_size = vec2(36.0, ROW);
        style.spacing.menu_margin = Margin::same(6);
        style.spacing.combo_width = 0.0;
        style.spacing.slider_rail_height = 4.0;
        style.spacing.icon_width = 14.0;
        style.spacing.scroll.bar_width = 8.0;
    });
}

fn text_styles() -> std::collections::BTreeMap<TextStyle, FontId> {
    [
        (TextStyle::Heading, FontId::new(15.0, FontFamily::Proportional)),
        (TextStyle::Body, FontId::new(12.5, FontFamily::Proportional)),
        (TextStyle::Button, FontId::new(12.5, FontFamily::Proportional)),
        (TextStyle::Small, FontId::new(11.0, FontFamily::Proportional)),
        (TextStyle::Monospace, FontId::new(11.5, FontFamily::Monospace)),
    ]
    .into()
}

fn visuals() -> Visuals {
    let mut visuals = Visuals::dark();
    visuals.panel_fill = PANEL;
    visuals.window_fill = Color32::from_rgb(31, 34, 40);
    visuals.window_stroke = Stroke::new(1.0, LINE);
    visuals.window_corner_radius = CornerRadius::same(6);
    visuals.window_shadow = Shadow { offset: [0, 6], blur: 18, spread: 0, color: Color32::from_black_alpha(110) };
    visuals.popup_shadow = visuals.window_shadow;
    visuals.extreme_bg_color = CANVAS;
    visuals.faint_bg_color = Color32::from_rgb(30, 33, 39);
    visuals.override_text_color = None;
    visuals.weak_text_color = Some(WEAK);
    visuals.warn_fg_color = WARNING;
    visuals.error_fg_color = ERROR;
    visuals.hyperlink_color = ACCENT;
    visuals.selection.bg_fill = Color32::from_rgb(42, 78, 130);
    visuals.selection.stroke = Stroke::new(1.0, Color32::from_rgb(214, 230, 255));
    visuals.slider_trailing_fill = true;
    visuals.handle_shape = egui::style::HandleShape::Circle;
    widget_visuals(&mut visuals);
    visuals
}

fn widget_visuals(visuals: &mut Visuals) {
    let widgets = &mut visuals.widgets;
    let radius = CornerRadius::same(4);
    let states = [
        (&mut widgets.noninteractive, PANEL, LINE, TEXT),
        (&mut widgets.inactive, Color32::from_rgb(43, 47, 56), Color32::TRANSPARENT, TEXT),
        (&mut widgets.hovered, Color32::from_rgb(55, 61, 73), Color32::from_rgb(82, 91, 108), STRONG),
        (&mut widgets.active, Color32::from_rgb(64, 72, 87), ACCENT, STRONG),
        (&mut widgets.open, Color32::from_rgb(50, 55, 66), LINE, STRONG),
    ];
    for (state, fill, line, text) in states {
        state.bg_fill = fill;
        state.weak_bg_fill = fill;
        state.bg_stroke = Stroke::new(1.0, line);
        state.fg_stroke = Stroke::new(1.2, text);
        state.corner_radius = radius;
        state.expansion = 0.0;
    }
}
