//! Brushed metal: long fine scratches along one direction.

use super::{Sample, Surface, noise};

pub const SAMPLE: Sample = Sample {
    name: "brushed",
    description: "Brushed metal: fine scratches across, so the highlight spreads up and down only",
    surface: Surface::Height(height),
};

/// Lattice cells of the strokes along and across, with the height of a stroke in tile widths.
const STROKES: [((i64, i64), f64); 4] =
    [((4, 512), 0.000_28), ((7, 256), 0.000_5), ((3, 128), 0.000_6), ((2, 48), 0.000_8)];

fn height(s: f64, t: f64) -> f64 {
    let stroke = |(seed, ((along, across), strength)): (u64, ((i64, i64), f64))| {
        // A stroke lies within a few texels of its row from end to end.
        let wander = 0.0015 * noise::smooth(s, t, (3, 5), 40);
        strength * noise::smooth(s, t + wander, (along, across), 41 + seed)
    };
    (0_u64..).zip(STROKES).map(stroke).sum()
}
