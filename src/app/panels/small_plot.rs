//! Plots for the width of a panel: nothing to drag or to zoom, small numbers along the axes.

use egui::{FontId, Rangef, RichText};
use egui_plot::{AxisHints, Plot};

/// Room that numbers along an axis need, points: with less they are left out, with more they are bright.
const NUMBER_ROOM: Rangef = Rangef { min: 14.0, max: 30.0 };

/// A plot of this height between two axes made by [`x_axis`] and [`y_axis`].
pub fn new<'a>(name: &str, height: f32, x_axis: AxisHints<'a>, y_axis: AxisHints<'a>) -> Plot<'a> {
    still(name, height).custom_x_axes(vec![x_axis]).custom_y_axes(vec![y_axis])
}

/// A plot of this height that stays as it is: the pointer neither drags nor zooms it.
pub fn still<'a>(name: &str, height: f32) -> Plot<'a> {
    Plot::new(name)
        .height(height)
        .allow_scroll(false)
        .allow_zoom(false)
        .allow_drag(false)
        .allow_boxed_zoom(false)
        .allow_double_click_reset(false)
}

/// An axis below the plot.
pub fn x_axis<'a>(label: &str) -> AxisHints<'a> {
    small(AxisHints::new_x(), label)
}

/// An axis left of the plot.
pub fn y_axis<'a>(label: &str) -> AxisHints<'a> {
    small(AxisHints::new_y(), label)
}

fn small<'a>(axis: AxisHints<'a>, label: &str) -> AxisHints<'a> {
    let label = RichText::new(label).small();
    axis.label(label).label_spacing(NUMBER_ROOM).tick_label_font(FontId::proportional(10.0))
}
