//! Rows of hemispherical scales, each half over the row below it.

use super::{Sample, Surface, noise};

pub const SAMPLE: Sample = Sample {
    name: "scales",
    description: "Overlapping hemispherical scales: round normals cut off at sharp edges",
    surface: Surface::Height(height),
};

/// Scales along a row and rows to the tile (even, since every other row is shifted by half a scale).
const COLUMNS: i64 = 8;
const ROWS: i64 = 16;
/// Radius of a scale in column widths, so that two neighbours in a row overlap a little.
const RADIUS: f64 = 0.62;
/// How much the lower, free edge of a scale stands up, in radii.
const LIFT: f64 = 0.55;
/// Height of a scale against that of a true hemisphere: at 1 the edges would look below what 8 bits resolve.
const FLATTENING: f64 = 0.5;

fn height(s: f64, t: f64) -> f64 {
    let row = (t * ROWS as f64).floor() as i64;
    let highest = (row - 1..=row + 3).flat_map(|row| nearest_two(s, row).map(|column| scale(s, t, row, column)));
    highest.fold(0.0, f64::max) / COLUMNS as f64
}

/// The columns of the two scales of a row that are nearest to `s`.
fn nearest_two(s: f64, row: i64) -> [i64; 2] {
    let left = (s * COLUMNS as f64 - shift(row)).floor() as i64;
    [left, left + 1]
}

fn shift(row: i64) -> f64 {
    if row.rem_euclid(2) == 0 { 0.0 } else { 0.5 }
}

/// The height of one scale at `(s, t)`, in column widths; 0 outside it.
fn scale(s: f64, t: f64, row: i64, column: i64) -> f64 {
    let across = s * COLUMNS as f64 - shift(row) - column as f64;
    let along = (t * ROWS as f64 - row as f64) * COLUMNS as f64 / ROWS as f64;
    let inside = RADIUS * RADIUS - across * across - along * along;
    if inside <= 0.0 {
        return 0.0;
    }
    let size = noise::mix_between(0.9, 1.0, noise::uniform(column.rem_euclid(COLUMNS), row.rem_euclid(ROWS), 5));
    size * (FLATTENING * inside.sqrt() + LIFT * (RADIUS - along))
}
