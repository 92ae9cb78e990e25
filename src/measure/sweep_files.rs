//! A sweep's figures as JSON and as comma-separated values: cells as `compare` writes them, each with its value of the
//! quantity that is varied.

use serde::Serialize;

use super::figures::Cell;
use super::files::{CSV_HEADER, csv_lines};
use super::sweep_run::SweepRun;
use crate::filter::vmf::FitSettings;
use crate::lit_surface::LitSurface;

/// The result of a sweep, schema 1.
#[derive(Debug, Serialize)]
struct Report<'a> {
    schema: u32,
    axis: &'static str,
    map: &'a str,
    /// What was open; the axis varies one quantity of it.
    fit: FitSettings,
    surface: LitSurface,
    size: [u32; 2],
    cells: Vec<ValuedCell>,
}

#[derive(Debug, Serialize)]
struct ValuedCell {
    value: f32,
    #[serde(flatten)]
    cell: Cell,
}

/// The cells that have figures, with the axis's value of each.
fn cells(run: &SweepRun) -> impl Iterator<Item = ValuedCell> {
    let points = run.sweep().points(run.base()).into_iter().enumerate();
    points.filter_map(|(index, point)| {
        let cell = run.findings().cell(run.map(), index, &point)?;
        Some(ValuedCell { value: run.sweep().values[index], cell })
    })
}

/// The figures as JSON.
///
/// # Errors
/// None that a figure can cause.
pub fn json(run: &SweepRun) -> Result<String, serde_json::Error> {
    serde_json::to_string_pretty(&Report {
        schema: 1,
        axis: run.sweep().axis.name(),
        map: run.map(),
        fit: run.base().fit,
        surface: run.base().surface.clone(),
        size: run.sweep().settings.size,
        cells: cells(run).collect(),
    })
}

/// The figures as comma-separated values, a line for each method at each value.
pub fn csv(run: &SweepRun) -> String {
    let axis = run.sweep().axis.name();
    let mut text = format!("axis,value,{CSV_HEADER}\n");
    for ValuedCell { value, cell } in cells(run) {
        for line in csv_lines(&cell) {
            text += &format!("{axis},{value},{line}\n");
        }
    }
    text
}
