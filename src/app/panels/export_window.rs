//! The question what is exported, how, and where it goes, with a look at roughness beforehand.

use std::path::PathBuf;

use egui::{Button, Context, Id, Key, Modal, RichText, TextEdit, Ui, vec2};

use super::{PanelContext, focus_whole, segmented};
use crate::app::export_view::{ExportKind, ExportView};
use crate::app::exports::ExportTarget;
use crate::app::parameter::{checkbox, choice, label};
use crate::app::view_state::Overlay;
use crate::app::{Command, theme};
use crate::export::lobe_shader::Language;
use crate::export::roughness::{Convention, Depth, Spread};

const SPREAD: &str = "How roughness follows from the length of the mean normal: that of the one von Mises-Fisher lobe, \
                      or Toksvig's factor (2004) of a mirror.";
const CONVENTION: &str = "What roughness means in the renderer that reads it.";
const CAPTION: &str = "Writes map, methods, fit and material below the picture.";
const DEPTH: &str = "The samples of PNG files; OpenEXR has floats.";

/// Side of the picture of roughness, in points.
const PREVIEW: f32 = 128.0;

/// Shows the question until it is answered.
pub fn show(ctx: &Context, context: &mut PanelContext<'_>) {
    let modal = Modal::new(Id::unique("export")).show(ctx, |ui| {
        ui.set_width(440.0);
        ui.label(RichText::new("Export").heading().color(theme::of(ui).strong));
        ui.horizontal(|ui| {
            let default = ExportView::default().kind;
            let kinds = ExportKind::ALL.map(|kind| (kind, kind.label()));
            segmented(ui, "Export", &mut context.view.export.kind, default, &kinds);
        });
        ui.label(RichText::new(context.view.export.kind.explanation()).small().color(theme::of(ui).weak));
        ui.add_space(theme::GRID);
        match context.view.export.kind {
            ExportKind::Roughness => roughness(ui, context),
            ExportKind::Shader => shader(ui, context),
            ExportKind::Picture => {
                let default = ExportView::default().caption;
                checkbox(ui, &mut context.view.export.caption, default, "settings below it", CAPTION);
            }
            ExportKind::Slopes | ExportKind::Lobes => {}
        }
        ui.add_space(theme::GRID);
        target(ui, context)
    });
    if modal.inner || modal.should_close() {
        context.view.overlay = Overlay::None;
    }
}

fn roughness(ui: &mut Ui, context: &mut PanelContext<'_>) {
    let settings = &mut context.view.export.roughness;
    if let Some(spread) = choice(ui, "Spread", SPREAD, settings.spread, &Spread::ALL.map(|s| (s, s.label()))) {
        settings.spread = spread;
    }
    let conventions = Convention::ALL.map(|convention| (convention, convention.label()));
    if let Some(convention) = choice(ui, "Convention", CONVENTION, settings.convention, &conventions) {
        settings.convention = convention;
    }
    let depths = [(Depth::Bits8, "8 bits"), (Depth::Bits16, "16 bits")];
    if let Some(depth) = choice(ui, "PNG samples", DEPTH, settings.depth, &depths) {
        settings.depth = depth;
    }
    let settings = *settings;
    let level = context.session.selected().level;
    ui.horizontal(|ui| {
        label(ui, "Preview");
        let texture = context.exports.preview(ui.ctx(), context.session, settings);
        ui.add(egui::Image::new((texture.id(), vec2(PREVIEW, PREVIEW))).alt_text("Roughness of a level"));
        let means = &context.session.mip().levels[level];
        let all = means.iter().map(|mean| settings.of_length(f64::from(mean.length())));
        let text = match all.size_hint().0 {
            // A large level would take long in every frame.
            0..=LARGEST_SUMMARY => {
                let (least, most) = all.fold((1.0, 0.0), |(l, m), r| (r.min(l), r.max(m)));
                format!("level {level}\n{least:.3} to {most:.3}")
            }
            _ => format!("level {level}"),
        };
        ui.label(RichText::new(text).small().color(theme::of(ui).weak));
    });
}

/// Texels of the largest level whose range is shown.
const LARGEST_SUMMARY: usize = 4096;

fn shader(ui: &mut Ui, context: &mut PanelContext<'_>) {
    ui.horizontal(|ui| {
        label(ui, "Language");
        let languages = Language::ALL.map(|language| (language, language.label()));
        let default = ExportView::default().language;
        segmented(ui, "Language", &mut context.view.export.language, default, &languages);
    });
}

/// A path to be typed, or the system's dialog; true once it is answered.
fn target(ui: &mut Ui, context: &mut PanelContext<'_>) -> bool {
    context.view.export.suggest(&context.session.map().source);
    let hint = format!("Path that ends in .{}", context.view.export.ending());
    let field = TextEdit::singleline(&mut context.view.export.typed_path).desired_width(f32::INFINITY);
    let response = ui.add(field.hint_text(hint)).accessible_name("Path to export to");
    let entered = response.lost_focus() && ui.input(|input| input.key_pressed(Key::Enter));
    if !entered && ui.memory(|memory| memory.focused().is_none()) {
        focus_whole(&response, &context.view.export.typed_path);
    }
    let path = PathBuf::from(context.view.export.typed_path.trim());
    let ready = !context.exports.is_writing();
    let typed = ready && path.file_name().is_some();
    if path.is_file() {
        ui.label(RichText::new("The file is there already and is replaced.").small().color(theme::of(ui).warning));
    }
    ui.horizontal(|ui| {
        let write = ui.add_enabled(typed, Button::new("Export")).accessible_name("Write the export").clicked();
        if (write || entered) && typed {
            context.push(Command::Export(context.view.export.clone(), ExportTarget::Path(path)));
            return true;
        }
        let browse = ui.add_enabled(ready, Button::new("Browse…")).accessible_name("Browse for the export").clicked();
        if browse {
            context.push(Command::Export(context.view.export.clone(), ExportTarget::Dialog));
            return true;
        }
        ui.button("Cancel").accessible_name("Cancel the export").clicked()
    })
    .inner
}
