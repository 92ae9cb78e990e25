//! The figures as text.

use std::collections::HashSet;

use crate::measure::figures::{Cell, MethodFigures, Reference, lowest_in, mean};

/// The figures as a table for each cell, then the means over all.
pub fn text(cells: &[Cell]) -> String {
    let tables = cells.iter().map(|cell| table(&cell.title(), &cell.reference, &cell.methods, None));
    let mut text: Vec<String> = tables.collect();
    text.extend(by_material(cells));
    if let (2.., Some((reference, methods))) = (cells.len(), mean(cells)) {
        let title = format!("mean over {} cells", cells.len());
        text.push(table(&title, &reference, &methods, Some(&lowest_in(cells))));
    }
    text.join("\n")
}

/// The mean colour error by material and method; `None` where there is one material.
fn by_material(cells: &[Cell]) -> Option<String> {
    let mut brdfs: Vec<&str> = cells.iter().map(|cell| cell.brdf.as_str()).collect();
    let mut seen = HashSet::new();
    brdfs.retain(|brdf| seen.insert(*brdf));
    let methods = cells.first().filter(|_| brdfs.len() > 1)?.methods.iter();
    let header: String = methods.map(|figures| format!(" {:>16}", figures.method)).collect();
    let line = |brdf: &&str| {
        let own: Vec<Cell> = cells.iter().filter(|cell| cell.brdf == **brdf).cloned().collect();
        let (_, methods) = mean(&own)?;
        let errors = methods.iter().map(|figures| format!(" {:>16}", figure(figures.normalised_color_error)));
        Some(format!("{brdf:<28}{}\n", errors.collect::<String>()))
    };
    let lines: String = brdfs.iter().filter_map(line).collect();
    Some(format!("mean colour error by material\n{:<28}{header}\n{lines}", "material"))
}

fn table(title: &str, reference: &Reference, methods: &[MethodFigures], lowest: Option<&[usize]>) -> String {
    let mut text = format!(
        "{title}\nreference: {} samples per pixel, standard error {}\n",
        reference.samples_per_pixel,
        figure(reference.standard_error)
    );
    if reference.temporal_change.is_some() {
        text += &format!("its mean change from frame to frame: {}\n", figure(reference.temporal_change));
    }
    text += "method             colour error      RMSE      FLIP        ms  bytes/texel";
    text += if reference.temporal_change.is_some() { "    change  over truth's" } else { "" };
    text += if lowest.is_some() { "  lowest in\n" } else { "\n" };
    for (index, figures) in methods.iter().enumerate() {
        let milliseconds = figures.milliseconds.map_or_else(|| "-".to_owned(), |time| format!("{time:.2}"));
        text += &format!(
            "{:<18} {:>12} {:>9} {:>9} {:>9} {:>12}",
            figures.method,
            figure(figures.normalised_color_error),
            figure(figures.rmse),
            figure(figures.flip),
            milliseconds,
            figures.bytes_per_texel
        );
        if let Some(truth) = reference.temporal_change {
            let ratio = figures.temporal_change.map(|change| change / truth).filter(|ratio| ratio.is_finite());
            let ratio = ratio.map_or_else(|| "-".to_owned(), |ratio| format!("{ratio:.3}"));
            text += &format!(" {:>9} {ratio:>13}", figure(figures.temporal_change));
        }
        text += &lowest.map_or_else(String::new, |lowest| format!("  {:>9}", lowest[index]));
        text += "\n";
    }
    text
}

/// A figure in five digits behind the point, or a dash where there is none.
pub fn figure(value: Option<f64>) -> String {
    value.map_or_else(|| "-".to_owned(), |value| format!("{value:.5}"))
}
