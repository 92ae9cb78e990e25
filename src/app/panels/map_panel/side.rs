//! Beside the map: how the level's numbers are spread, and the worst texels.

use egui::{Color32, RichText, ScrollArea, Ui};
use egui_plot::{Bar, BarChart, GridMark};

use super::worst;
use crate::app::level_histogram::{BINS, LevelHistogram};
use crate::app::map_shading::MapShading;
use crate::app::panels::{PanelContext, heading, small_plot};
use crate::app::texel_scale::{TexelScale, significant};
use crate::app::texel_values::TexelValues;
use crate::app::theme;

/// Width of the panel, points.
pub const WIDTH: f32 = 208.0;
/// Height of the histogram, points.
const HEIGHT: f32 = 160.0;

/// Shows what there is of numbers on this scale.
pub fn show(ui: &mut Ui, context: &mut PanelContext<'_>, scale: &TexelScale) {
    ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
        let level = context.session.selected().level;
        let shading = context.view.map.shading;
        let region = context.view.map_region.chosen;
        let of = if region.is_some() { "a region of level" } else { "level" };
        heading(ui, &format!("{} of {of} {level}", shading.label()));
        let values = TexelValues::new(context.session, context.errors, shading);
        let of_level = context.histogram.get(&values, scale, level, region);
        histogram(ui, of_level, scale, shading.label());
        words(ui, of_level, scale);
        if region.is_none() {
            ui.label(RichText::new("Shift + drag: a region").small().color(theme::of(ui).weak));
        }
        if shading == MapShading::Error {
            ui.add_space(2.0 * theme::GRID);
            heading(ui, "Worst texels");
            worst::list(ui, context);
        }
    });
}

fn histogram(ui: &mut Ui, LevelHistogram { bins, asked, .. }: &LevelHistogram, scale: &TexelScale, name: &str) {
    let bar = |(index, &count): (usize, &usize)| {
        let middle = (index as f32 + 0.5) / BINS as f32;
        let [r, g, b] = scale.color_at(middle);
        let share = 100.0 * count as f64 / asked[0].max(1) as f64;
        Bar::new(f64::from(middle), share).width(1.0 / BINS as f64).fill(Color32::from_rgb(r, g, b))
    };
    let bars: Vec<Bar> = bins.iter().enumerate().map(bar).collect();
    let ticks = scale.ticks();
    let step_size = ticks.get(1).copied().unwrap_or(1.0);
    let marks: Vec<GridMark> = ticks.into_iter().map(|value| GridMark { value, step_size }).collect();
    let on_axis = *scale;
    let written = move |mark: GridMark, _: &_| significant(on_axis.value(mark.value));
    let x_axis = small_plot::x_axis(&scale.axis_label(name)).formatter(written);
    small_plot::new("level histogram", HEIGHT, x_axis, small_plot::y_axis("texels, %"))
        .include_x(0.0)
        .include_x(1.0)
        .x_grid_spacer(move |_| marks.clone())
        .show(ui, |plot| plot.bar_chart(BarChart::new("texels", bars).allow_hover(false)));
}

/// What a picture of bars does not say.
fn words(ui: &mut Ui, LevelHistogram { asked: [texels, numbers], quantiles, .. }: &LevelHistogram, scale: &TexelScale) {
    let mut text = match quantiles.map(|quantiles| quantiles.map(|value| scale.written(value))) {
        Some([lowest, median, highest]) => format!("lowest {lowest} · median {median} · highest {highest}"),
        None => "no texel has a number".to_owned(),
    };
    if numbers < texels {
        text += &format!(" · {} of {texels} texels have none", texels - numbers);
    }
    ui.label(RichText::new(text).small().color(theme::of(ui).weak));
}
