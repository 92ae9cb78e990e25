//! How a method's curve looks: each method has one colour, one marker and one kind of line, the same in every plot, so
//! that it reads without colour too.

use egui::Color32;
use egui_plot::{Line, LineStyle, MarkerShape, PlotPoints, Points};

use super::theme::Palette;
use crate::color::LOBE_COLORS;
use crate::filter::Method;

/// How a method's curve looks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MethodStyle {
    /// The colour of curve and marker.
    pub color: Color32,
    marker: MarkerShape,
    line: LineStyle,
}

impl MethodStyle {
    /// By the method's place among those that are offered; one that is not offered looks like the truth.
    pub fn of(method: Method, palette: &Palette) -> Self {
        const LINES: [LineStyle; 3] =
            [LineStyle::Solid, LineStyle::Dashed { length: 9.0 }, LineStyle::Dotted { spacing: 5.0 }];
        const MARKERS: [MarkerShape; 8] = [
            MarkerShape::Circle,
            MarkerShape::Square,
            MarkerShape::Up,
            MarkerShape::Cross,
            MarkerShape::Diamond,
            MarkerShape::Down,
            MarkerShape::Plus,
            MarkerShape::Asterisk,
        ];
        let place = Method::offered().position(|offered| offered == method).unwrap_or(0);
        if method == Method::Truth || place == 0 {
            return Self { color: palette.strong, marker: MarkerShape::Circle, line: LINES[1] };
        }
        let [r, g, b] = LOBE_COLORS[(place - 1) % LOBE_COLORS.len()];
        let color = Color32::from_rgb(r, g, b);
        Self { color, marker: MARKERS[(place - 1) % MARKERS.len()], line: LINES[(place - 1) % LINES.len()] }
    }

    /// A curve through points.
    pub fn line<'a>(self, name: &str, points: Vec<[f64; 2]>) -> Line<'a> {
        Line::new(name, PlotPoints::from(points)).color(self.color).style(self.line).width(1.6)
    }

    /// Markers at points.
    pub fn points<'a>(self, name: &str, points: Vec<[f64; 2]>) -> Points<'a> {
        Points::new(name, PlotPoints::from(points)).color(self.color).shape(self.marker).radius(4.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::theme::Theme;

    #[test]
    fn no_two_methods_look_alike() {
        let styles: Vec<MethodStyle> =
            Method::offered().map(|method| MethodStyle::of(method, Theme::Dark.palette())).collect();
        for (index, style) in styles.iter().enumerate() {
            let alike = |other: &MethodStyle| {
                other.color == style.color || (other.marker, other.line) == (style.marker, style.line)
            };
            assert!(!styles[..index].iter().any(alike), "{index}: {style:?}");
        }
    }
}
