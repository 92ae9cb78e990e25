//! The figures as text, JSON and CSV.

use serde::Serialize;

use super::figures::{Cell, MethodFigures, Reference, lowest_in, mean};

/// The result, schema 1; others script against it. With several cells, `reference` and `methods` are means over all.
#[derive(Debug, Serialize)]
struct Report<'a> {
    schema: u32,
    reference: Reference,
    methods: Vec<MethodFigures>,
    cells: &'a [Cell],
}

/// The figures as JSON.
///
/// # Errors
/// When there are none.
pub fn json(cells: &[Cell]) -> anyhow::Result<String> {
    let (reference, methods) = mean(cells).ok_or_else(|| anyhow::anyhow!("Nothing was compared."))?;
    Ok(serde_json::to_string_pretty(&Report { schema: 1, reference, methods, cells })?)
}

/// The figures as comma-separated values, a line for each method in each cell.
pub fn csv(cells: &[Cell]) -> String {
    let mut text = "map,distance,exponent,method,normalised_color_error,rmse,flip,milliseconds,bytes_per_texel,\
                    samples_per_pixel,standard_error\n"
        .to_owned();
    for cell in cells {
        for figures in &cell.methods {
            let number = |value: Option<f64>| value.map_or_else(String::new, |value| value.to_string());
            let fields = [
                quoted(&cell.map),
                cell.distance.to_string(),
                cell.exponent.to_string(),
                figures.method.clone(),
                number(figures.normalised_color_error),
                number(figures.rmse),
                number(figures.flip),
                figures.milliseconds.to_string(),
                figures.bytes_per_texel.to_string(),
                cell.reference.samples_per_pixel.to_string(),
                number(cell.reference.standard_error),
            ];
            text += &fields.join(",");
            text += "\n";
        }
    }
    text
}

/// A field of comma-separated values (RFC 4180, section 2).
fn quoted(field: &str) -> String {
    if field.contains([',', '"', '\n', '\r']) {
        format!("\"{}\"", field.replace('"', "\"\""))
    } else {
        field.to_owned()
    }
}

/// The figures as a table for each cell, then the means over all.
pub fn text(cells: &[Cell]) -> String {
    let tables = cells.iter().map(|cell| {
        let title = format!("{}, distance {}, exponent {}", cell.map, cell.distance, cell.exponent);
        table(&title, &cell.reference, &cell.methods, None)
    });
    let mut text: Vec<String> = tables.collect();
    if let (2.., Some((reference, methods))) = (cells.len(), mean(cells)) {
        let title = format!("mean over {} cells", cells.len());
        text.push(table(&title, &reference, &methods, Some(&lowest_in(cells))));
    }
    text.join("\n")
}

fn table(title: &str, reference: &Reference, methods: &[MethodFigures], lowest: Option<&[usize]>) -> String {
    let mut text = format!(
        "{title}\nreference: {} samples per pixel, standard error {}\n",
        reference.samples_per_pixel,
        figure(reference.standard_error)
    );
    text += "method             colour error      RMSE      FLIP        ms  bytes/texel";
    text += if lowest.is_some() { "  lowest in\n" } else { "\n" };
    for (index, figures) in methods.iter().enumerate() {
        text += &format!(
            "{:<18} {:>12} {:>9} {:>9} {:>9.2} {:>12}",
            figures.method,
            figure(figures.normalised_color_error),
            figure(figures.rmse),
            figure(figures.flip),
            figures.milliseconds,
            figures.bytes_per_texel
        );
        text += &lowest.map_or_else(String::new, |lowest| format!("  {:>9}", lowest[index]));
        text += "\n";
    }
    text
}

/// A figure in five digits behind the point, or a dash where there is none.
pub fn figure(value: Option<f64>) -> String {
    value.map_or_else(|| "-".to_owned(), |value| format!("{value:.5}"))
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
