//! The status bar: what draws and why, how far the fit is, what lies under the pointer.

use egui::{Align, Layout, RichText, Ui};

use super::PanelContext;
use crate::app::theme;
use crate::session::fitting::LevelState;

/// Shows the bar; `hover` is what lay under the pointer in the frame before.
pub fn show(ui: &mut Ui, context: &PanelContext<'_>, hover: Option<&str>) {
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = 16.0;
        let adapter = &context.surroundings.gpu.choice;
        let color = if adapter.software { theme::of(ui).warning } else { theme::of(ui).weak };
        ui.label(RichText::new(&adapter.reason).small().color(color)).on_hover_text(
            "A GPU is used if there is one, else software Vulkan, else GL. WGPU_ADAPTER_NAME picks another.",
        );
        ui.label(RichText::new(fit_sentence(context)).small().color(theme::of(ui).weak));
        if let Some(text) = context.surroundings.target.status.get().left_out_sentence() {
            ui.label(RichText::new(text).small().color(theme::of(ui).warning));
        }
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            if let Some(bytes) = memory(context) {
                ui.label(RichText::new(format!("{} MiB", bytes >> 20)).small().color(theme::of(ui).weak));
            }
            if let Some(hover) = hover {
                ui.add(egui::Label::new(RichText::new(hover).small().monospace().color(theme::of(ui).text)).truncate());
            }
        });
    });
}

/// Memory in use; left out where the picture must be the same run after run.
fn memory(context: &PanelContext<'_>) -> Option<usize> {
    let stats = context.surroundings.live.then(memory_stats::memory_stats).flatten()?;
    Some(stats.physical_mem)
}

fn fit_sentence(context: &PanelContext<'_>) -> String {
    let fitting = context.session.fitting();
    let done = fitting.levels().iter().filter(|level| level.state == LevelState::Done).count();
    let levels = fitting.levels().len();
    match fitting.progress() {
        Some(progress) => format!("fit {:.0} % · {done} of {levels} levels done", 100.0 * progress.fraction),
        None if fitting.is_complete() => format!("fit done · {levels} levels"),
        None => format!("fit stopped · {done} of {levels} levels done"),
    }
}
