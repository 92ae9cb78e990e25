//! The figures of cells as JSON and as comma-separated values; others script against both.

use serde::Serialize;

use super::figures::{Cell, MethodFigures, Reference, mean};

/// The names of a line's fields.
pub const CSV_HEADER: &str = "map,distance,exponent,method,normalised_color_error,rmse,flip,milliseconds,\
                              bytes_per_texel,samples_per_pixel,standard_error,temporal_change,\
                              reference_temporal_change,brdf";

/// The result of a comparison, schema 1. With several cells, `reference` and `methods` are means over all.
#[derive(Debug, Serialize)]
struct Report<'a> {
    schema: u32,
    reference: Reference,
    methods: Vec<MethodFigures>,
    cells: &'a [Cell],
}

/// The figures as JSON; `None` where there are none.
pub fn json(cells: &[Cell]) -> Option<Result<String, serde_json::Error>> {
    let (reference, methods) = mean(cells)?;
    Some(serde_json::to_string_pretty(&Report { schema: 1, reference, methods, cells }))
}

/// The figures as comma-separated values, a line for each method in each cell.
pub fn csv(cells: &[Cell]) -> String {
    let lines = cells.iter().flat_map(csv_lines).map(|line| line + "\n");
    format!("{CSV_HEADER}\n{}", lines.collect::<String>())
}

/// A line for each method of a cell.
pub fn csv_lines(cell: &Cell) -> Vec<String> {
    let number = |value: Option<f64>| value.map_or_else(String::new, |value| value.to_string());
    let line = |figures: &MethodFigures| {
        [
            quoted(&cell.map),
            cell.distance.to_string(),
            cell.exponent.to_string(),
            figures.method.clone(),
            number(figures.normalised_color_error),
            number(figures.rmse),
            number(figures.flip),
            number(figures.milliseconds),
            figures.bytes_per_texel.to_string(),
            cell.reference.samples_per_pixel.to_string(),
            number(cell.reference.standard_error),
            number(figures.temporal_change),
            number(cell.reference.temporal_change),
            quoted(&cell.brdf),
        ]
        .join(",")
    };
    cell.methods.iter().map(line).collect()
}

/// A field of comma-separated values (RFC 4180, section 2).
fn quoted(field: &str) -> String {
    if field.contains([',', '"', '\n', '\r']) {
        format!("\"{}\"", field.replace('"', "\"\""))
    } else {
        field.to_owned()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_with_a_comma_stays_one_field() {
        assert_eq!(quoted("a,\"b\".png"), "\"a,\"\"b\"\".png\"");
        assert_eq!(quoted("plain.png"), "plain.png");
    }
}
