//! What there is to know of a model before it has a value: names, its parameter, what the window says of it.

use super::{Brdf, Material};

/// A model's description; each model's file has one.
#[derive(Debug)]
pub struct ModelKind {
    /// The name on the command line, without the parameter.
    pub name: &'static str,
    /// The name in the window.
    pub label: &'static str,
    /// What it is, with its equation.
    pub tooltip: &'static str,
    /// The number that the model depends on, if it is one number.
    pub parameter: Option<ModelParameter>,
}

/// The number that a model depends on.
#[derive(Debug)]
pub struct ModelParameter {
    /// What the command line's help calls it.
    pub symbol: &'static str,
    /// Its name in the window, symbol after the word.
    pub label: &'static str,
    /// Smallest and largest value of the slider.
    pub range: [f32; 2],
    /// The largest value that the command line takes.
    pub most: f64,
    /// The value of a new session.
    pub default: f32,
    /// Digits behind the decimal point.
    pub decimals: usize,
    /// What it does, with its equation.
    pub tooltip: &'static str,
    /// Where a material keeps it.
    pub field: fn(&mut Material) -> &mut f32,
    /// The model of that value.
    pub model: fn(f64) -> Brdf,
}

impl ModelKind {
    /// `NAME:SYMBOL`, as the command line's help writes it.
    pub fn usage(&self) -> String {
        match &self.parameter {
            Some(parameter) => format!("{}:{}", self.name, parameter.symbol),
            None => self.name.to_owned(),
        }
    }
}
