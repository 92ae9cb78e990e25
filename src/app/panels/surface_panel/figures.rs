//! The figures of a method on its part of the picture, with what they mean as a tooltip.

use egui::{Align2, FontId, Id, Pos2, Sense, Ui, vec2};

use super::cells::Cells;
use crate::app::panels::PanelContext;
use crate::app::theme::{self, Palette};
use crate::app::viewport::Subject;
use crate::filter::Method;
use crate::measure::{Metric, bytes_per_texel};
use crate::reference::Figures;

/// Draws a method's figures with a corner at `at`; `cell` tells them from those of other cells.
pub fn show(
    ui: &Ui,
    context: &PanelContext<'_>,
    cells: &Cells,
    (cell, method): (usize, Method),
    (at, align): (Pos2, Align2),
) {
    let lines = lines(context, method).join("\n");
    let color = color(theme::of(ui), context, cells);
    let painter = ui.painter_at(cells.picture);
    let galley = painter.layout_no_wrap(lines.clone(), FontId::proportional(11.0), color);
    let rect = align.anchor_size(at, galley.size() + vec2(16.0, 8.0));
    painter.rect_filled(rect, 4.0, theme::of(ui).badge);
    painter.galley(rect.min + vec2(8.0, 4.0), galley, color);
    let response = ui.interact(rect, Id::unique(("figures", cell)), Sense::hover());
    let name = format!("Figures of {}: {}", method.label(), lines.replace('\n', " · "));
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Label, true, &name));
    response.on_hover_ui(|ui| explain(ui, context));
}

/// Stale figures are dim.
fn color(palette: &Palette, context: &PanelContext<'_>, cells: &Cells) -> egui::Color32 {
    if is_current(context, cells) { palette.text } else { palette.weak.gamma_multiply(0.6) }
}

/// True where the figures are those of what this frame shows.
pub fn is_current(context: &PanelContext<'_>, cells: &Cells) -> bool {
    let drawn = context.surroundings.target.status.get().subject;
    context.live_figures.is_current() && drawn == Some(Subject::new(context.session, cells.cell_size()))
}

fn lines(context: &PanelContext<'_>, method: Method) -> [String; 2] {
    let Figures { normalised_color_error, rmse, flip } = context.live_figures.of(method).unwrap_or_default();
    let number = |value: Option<f64>| value.map_or_else(|| "–".to_owned(), |value| format!("{value:.4}"));
    let bytes = bytes_per_texel(&context.surroundings.gpu.device, context.session, method);
    // It differs from run to run.
    let timed = context.surroundings.target.status.get().milliseconds(method).filter(|_| context.surroundings.live);
    let milliseconds = timed.map_or_else(String::new, |time| format!(" · {time:.2} ms"));
    [
        format!("colour error {} · RMSE {}", number(normalised_color_error), number(rmse)),
        format!("FLIP {} · {bytes} B/texel{milliseconds}", number(flip)),
    ]
}

fn explain(ui: &mut Ui, context: &PanelContext<'_>) {
    ui.set_max_width(380.0);
    let samples = context.surroundings.target.status.get().snapshots.samples().unwrap_or(0);
    let of = if context.view.region.chosen.is_some() { "the region" } else { "the whole picture" };
    ui.label(format!("Of {of}, exposed, against the truth at {samples} samples per pixel."));
    for metric in [Metric::ColorError, Metric::Rmse, Metric::Flip] {
        ui.label(format!("{}: {}", metric.label(), metric.explanation()));
    }
    ui.label(
        "B/texel: bytes of a texel above the base level in the textures that the method reads. ms: its pass alone, by \
         the adapter's clock. Shift + drag chooses a region; a double click or Esc clears it.",
    );
}
