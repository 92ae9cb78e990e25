//! Which methods are compared, by number and by name.

use egui::{Key, Modifiers};

use super::{Action, Facts, Menu};
use crate::app::Command;
use crate::comparison::Comparison;
use crate::filter::Method;

/// The truth, the lobes and the first of their rivals have these.
const DIGITS: [Key; 9] =
    [Key::Num1, Key::Num2, Key::Num3, Key::Num4, Key::Num5, Key::Num6, Key::Num7, Key::Num8, Key::Num9];

pub fn actions() -> Vec<Action> {
    let right = side("right", "Right method", Modifiers::NONE, |comparison, method| comparison.right = method);
    let left = side("left", "Left method", Modifiers::COMMAND, |comparison, method| comparison.left = method);
    let swap = Action::new(Menu::View, "swap-methods", "Swap left and right", |facts| {
        change(facts, |comparison| std::mem::swap(&mut comparison.left, &mut comparison.right))
    });
    right.chain(left).chain([swap.key(Modifiers::NONE, Key::X)]).collect()
}

/// One action for every method of one side.
fn side(
    prefix: &'static str,
    submenu: &'static str,
    modifiers: Modifiers,
    set: fn(&mut Comparison, Method),
) -> impl Iterator<Item = Action> {
    let first = [Method::Truth, Method::Vmf, Method::VmfUnaligned];
    let rivals = Method::offered().filter(move |method| !first.contains(method));
    first.into_iter().chain(rivals).enumerate().map(move |(index, method)| {
        let make = move |facts: &Facts<'_>| change(facts, |comparison| set(comparison, method));
        let action = Action::new(Menu::View, format!("{prefix}-{method}"), method.label(), make).inside(submenu);
        match DIGITS.get(index) {
            Some(&digit) => action.key(modifiers, digit),
            None => action,
        }
    })
}

/// The command that changes the comparison.
pub fn change(facts: &Facts<'_>, change: impl FnOnce(&mut Comparison)) -> Option<Command> {
    let mut comparison = facts.session.comparison;
    change(&mut comparison);
    Some(Command::SetComparison(comparison))
}
