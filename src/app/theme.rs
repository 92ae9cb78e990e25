//! How the window looks: three themes on a grid of four points, one accent colour, two sizes of text.
//!
//! Panels take every colour from the [`Palette`] that their context is dressed in; pictures of data keep their own.

use std::str::FromStr;

use egui::{Context, CornerRadius, FontFamily, FontId, Margin, Painter, Shadow, Stroke, TextStyle, Ui, Visuals, vec2};
use serde::{Deserialize, Serialize};

mod palette;
pub use palette::Palette;

/// A way to look.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Theme {
    /// Bright on dark.
    #[default]
    Dark,
    /// Dark on bright.
    Light,
    /// White on black, with bright lines.
    HighContrast,
}

impl Theme {
    /// Every theme with its name, in the order they are offered.
    pub const ALL: [(Self, &'static str); 3] =
        [(Self::Dark, "Dark"), (Self::Light, "Light"), (Self::HighContrast, "High contrast")];

    /// Its colours.
    pub fn palette(self) -> &'static Palette {
        match self {
            Self::Dark => &palette::DARK,
            Self::Light => &palette::LIGHT,
            Self::HighContrast => &palette::HIGH_CONTRAST,
        }
    }
}

impl FromStr for Theme {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        match text {
            "dark" => Ok(Self::Dark),
            "light" => Ok(Self::Light),
            "high-contrast" => Ok(Self::HighContrast),
            _ => Err("write dark, light or high-contrast".to_owned()),
        }
    }
}

/// One step of the grid.
pub const GRID: f32 = 4.0;
/// Height of a row of controls.
pub const ROW: f32 = 20.0;
/// Height of a slider, which its handle follows.
pub const HANDLE: f32 = 14.0;

/// What is dressed in a theme.
pub trait Dressed {
    /// The context behind it.
    fn context(&self) -> &Context;
}

impl Dressed for Context {
    fn context(&self) -> &Context {
        self
    }
}

impl Dressed for Ui {
    fn context(&self) -> &Context {
        self.ctx()
    }
}

impl Dressed for Painter {
    fn context(&self) -> &Context {
        self.ctx()
    }
}

/// The colours of what is shown there.
pub fn of(dressed: &impl Dressed) -> &'static Palette {
    let panel = dressed.context().global_style().visuals.panel_fill;
    let palettes = Theme::ALL.map(|(theme, _)| theme.palette());
    palettes.into_iter().find(|palette| palette.panel == panel).unwrap_or(&palette::DARK)
}

/// Dresses a context. Idempotent.
pub fn apply(ctx: &Context, theme: Theme) {
    ctx.set_theme(if theme == Theme::Light { egui::Theme::Light } else { egui::Theme::Dark });
    ctx.all_styles_mut(|style| {
        let blinks = style.visuals.text_cursor.blink;
        style.text_styles = text_styles();
        style.visuals = visuals(theme);
        style.visuals.text_cursor.blink = blinks;
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

fn visuals(theme: Theme) -> Visuals {
    let palette = theme.palette();
    let mut visuals = if theme == Theme::Light { Visuals::light() } else { Visuals::dark() };
    visuals.panel_fill = palette.panel;
    visuals.window_fill = palette.window;
    visuals.window_stroke = Stroke::new(1.0, palette.line);
    visuals.window_corner_radius = CornerRadius::same(6);
    visuals.window_shadow = Shadow { offset: [0, 6], blur: 18, spread: 0, color: palette.shadow };
    visuals.popup_shadow = visuals.window_shadow;
    visuals.extreme_bg_color = palette.field;
    visuals.faint_bg_color = palette.faint;
    visuals.override_text_color = None;
    visuals.weak_text_color = Some(palette.weak);
    visuals.warn_fg_color = palette.warning;
    visuals.error_fg_color = palette.error;
    visuals.hyperlink_color = palette.accent;
    visuals.selection.bg_fill = palette.selection;
    visuals.selection.stroke = Stroke::new(1.0, palette.selected);
    visuals.slider_trailing_fill = true;
    visuals.handle_shape = egui::style::HandleShape::Circle;
    widget_visuals(&mut visuals, palette);
    visuals
}

fn widget_visuals(visuals: &mut Visuals, palette: &Palette) {
    let widgets = &mut visuals.widgets;
    let radius = CornerRadius::same(4);
    let [inactive, hovered, active, open] = palette.widgets;
    let states = [
        (&mut widgets.noninteractive, palette.panel, palette.line, palette.text),
        (&mut widgets.inactive, inactive, palette.edge, palette.text),
        (&mut widgets.hovered, hovered, palette.weak, palette.strong),
        (&mut widgets.active, active, palette.accent, palette.strong),
        (&mut widgets.open, open, palette.line, palette.strong),
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_context_tells_the_theme_that_it_is_dressed_in() {
        let ctx = Context::default();
        for (theme, name) in Theme::ALL {
            apply(&ctx, theme);
            assert_eq!(of(&ctx), theme.palette(), "{name}");
        }
    }
}
