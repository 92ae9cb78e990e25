//! The choice of the method whose effective BRDF is held against the truth.

use egui::Ui;

use super::PanelContext;
use crate::app::ViewState;
use crate::app::parameter::combo;
use crate::filter::Method;

/// Shows the drop-down, as wide as what is left of the row, under a name of its own.
pub fn show(ui: &mut Ui, context: &mut PanelContext<'_>, name: &str) {
    let compared = ViewState::judged_of(&context.session.comparison, None);
    let mut choices = vec![(None, format!("{} (compared)", compared.label()))];
    let methods = Method::offered().filter(|method| *method != Method::Truth);
    choices.extend(methods.map(|method| (Some(method), method.label())));
    let choices: Vec<(Option<Method>, &str)> = choices.iter().map(|(method, text)| (*method, text.as_str())).collect();
    let tooltip = "The method that is held against the truth: the compared one follows the choice above the surface.";
    combo(ui, name, &mut context.view.judged, &choices).on_hover_text(tooltip);
}
