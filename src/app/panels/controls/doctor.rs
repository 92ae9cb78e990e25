//! What the import doctor found: doubts always, the rest on demand, each with a button that reads the map anew.

use egui::{Align, Layout, RichText, Ui};

use crate::app::panels::{PanelContext, heading};
use crate::app::parameter::label;
use crate::app::{Command, theme};
use crate::normal_map::diagnose::{Advice, Confidence, Finding};
use crate::normal_map::{MapSource, NormalMap};

const SHOW: &str = "What the file itself says of how it should be read.";

/// Width of the buttons, so that they stand in one column.
const BUTTON_WIDTH: f32 = 60.0;

/// The heading of the map's group, with a button that shows all findings.
pub fn title(ui: &mut Ui, context: &mut PanelContext<'_>) {
    let doubts = context.session.diagnosis().findings.iter().filter(|finding| finding.doubtful).count();
    let (text, color) = match doubts {
        0 => ("Nothing doubtful".to_owned(), theme::of(ui).weak),
        1 => ("1 doubt".to_owned(), theme::of(ui).warning),
        _ => (format!("{doubts} doubts"), theme::of(ui).warning),
    };
    ui.scope(|ui| {
        // A heading's own height, no row of controls.
        ui.spacing_mut().interact_size.y = theme::GRID;
        ui.horizontal(|ui| {
            heading(ui, "Map");
            ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
                let shown = context.view.show_findings;
                let button = egui::Button::selectable(shown, RichText::new(text).small().color(color)).small();
                if ui.add(button).on_hover_text(SHOW).accessible_name("Import doctor").clicked() {
                    context.view.show_findings = !shown;
                }
            });
        });
    });
}

/// The doubts, or everything.
pub fn findings(ui: &mut Ui, context: &mut PanelContext<'_>) {
    let session = context.session;
    for finding in &session.diagnosis().findings {
        if (finding.doubtful || context.view.show_findings)
            && let Some(advice) = row(ui, session.map(), finding)
        {
            context.push(Command::Reopen(advice.apply(&session.map().options)));
        }
    }
}

/// One finding; what to do, if its button was clicked.
fn row(ui: &mut Ui, map: &NormalMap, finding: &Finding) -> Option<Advice> {
    let color = match finding.confidence {
        _ if finding.doubtful => theme::of(ui).warning,
        Confidence::Unknown => theme::of(ui).weak,
        Confidence::Certain | Confidence::Likely => theme::of(ui).text,
    };
    let explanation = explanation(finding);
    let mut chosen = None;
    ui.horizontal(|ui| {
        label(ui, finding.subject.title()).on_hover_text(&explanation);
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            chosen = finding.advice.filter(|&advice| heeds(map, advice)).and_then(|advice| button(ui, finding, advice));
            ui.with_layout(Layout::left_to_right(Align::Center), |ui| {
                let text = RichText::new(&finding.answer).color(color);
                ui.add(egui::Label::new(text).truncate()).on_hover_text(&explanation);
            });
        });
    });
    chosen
}

/// Follows the advice, or does the opposite of what is followed already.
fn button(ui: &mut Ui, finding: &Finding, advice: Advice) -> Option<Advice> {
    let (text, advice) = if finding.doubtful { ("Apply", advice) } else { ("Override", advice.opposite()) };
    let button = egui::Button::new(RichText::new(text).small());
    let response = ui.add_sized([BUTTON_WIDTH, theme::ROW], button);
    let response = response.on_hover_text(format!("Reads the map anew with {}.", advice.option()));
    response.accessible_name(format!("{text}: {}", finding.subject.title())).clicked().then_some(advice)
}

/// True where reading the map anew heeds the advice: a bundled map is made and not read, and lobes stay as fitted.
fn heeds(map: &NormalMap, advice: Advice) -> bool {
    let is_read =
        matches!(map.source, MapSource::File(_)) && (map.decoder.is_some() || map.options.height_scale.is_some());
    is_read || matches!((&map.source, advice), (MapSource::Bundled(_), Advice::Edges(_)))
}

fn explanation(finding: &Finding) -> String {
    let mut reason = finding.reason.clone();
    if let Some(first) = reason.get_mut(..1) {
        first.make_ascii_uppercase();
    }
    let confidence = match finding.confidence {
        Confidence::Certain => "Certain",
        Confidence::Likely => "Likely",
        Confidence::Unknown => "Cannot tell",
    };
    format!("{confidence}. {reason}.")
}
