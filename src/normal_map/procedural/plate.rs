//! Tread plate: brushed steel with raised lozenges, worn smooth on top, dented and scratched.
//!
//! Every kind of footprint meets here: near-flat brushed floor, round flanks in four directions, sharp scratches.

use std::f64::consts::{FRAC_PI_4, PI};
use std::sync::LazyLock;

use super::noise::{self, mix_between, smooth_step};
use super::{Sample, Surface};

pub const SAMPLE: Sample = Sample {
    name: "plate",
    description: "Tread plate: raised lozenges on brushed, scratched and dented steel",
    surface: Surface::Height(height),
};

/// Lozenges along a side of the tile; even, for neighbours lie crosswise.
const LOZENGES: i64 = 4;
/// Half a lozenge's length and width, in lattice cells.
const HALF_LENGTH: f64 = 0.56;
const HALF_WIDTH: f64 = 0.17;
/// How far a lozenge stands out, in tile widths.
const RISE: f64 = 0.017;
/// Scratches to the tile, and half a scratch's width.
const SCRATCH_COUNT: i64 = 26;
const HALF_SCRATCH: f64 = 0.0022;

fn height(s: f64, t: f64) -> f64 {
    let lug = lozenges(s, t);
    // Feet polish what stands out and leave the floor as it was brushed.
    let finish = mix_between(brushing(s, t), 0.25 * brushing(s, t), smooth_step(0.5, 1.0, lug));
    RISE * lug + finish + dents(s, t) - scratches(s, t)
}

/// 0 on the floor, 1 on top of a lozenge.
fn lozenges(s: f64, t: f64) -> f64 {
    let (x, y) = (s * LOZENGES as f64, t * LOZENGES as f64);
    let (column, row) = (x.floor() as i64, y.floor() as i64);
    let around = (-1..=1).flat_map(|dy| (-1..=1).map(move |dx| (column + dx, row + dy)));
    around.map(|(column, row)| lozenge(x - column as f64 - 0.5, y - row as f64 - 0.5, column + row)).fold(0.0, f64::max)
}

/// One lozenge about the origin: two circular arcs that meet in points, with a rounded flank.
fn lozenge(x: f64, y: f64, parity: i64) -> f64 {
    let angle = if parity.rem_euclid(2) == 0 { FRAC_PI_4 } else { -FRAC_PI_4 };
    let (sine, cosine) = angle.sin_cos();
    let (along, across) = (cosine * x + sine * y, cosine * y - sine * x);
    // Both arcs have the radius that passes through the two points and the widest place.
    let radius = (HALF_LENGTH * HALF_LENGTH + HALF_WIDTH * HALF_WIDTH) / (2.0 * HALF_WIDTH);
    let inside = radius - along.hypot(across.abs() + radius - HALF_WIDTH);
    smooth_step(0.0, 0.75 * HALF_WIDTH, inside)
}

fn brushing(s: f64, t: f64) -> f64 {
    0.000_22 * noise::smooth(s, t, (6, 512), 61)
        + 0.000_35 * noise::smooth(s, t, (10, 256), 62)
        + 0.000_25 * noise::smooth(s, t, (64, 64), 63)
}

fn dents(s: f64, t: f64) -> f64 {
    let deep = smooth_step(0.3, 1.0, noise::smooth(s, t, (9, 9), 64));
    0.0025 * noise::smooth(s, t, (3, 3), 65) - 0.004 * deep
}

/// A straight V-shaped cut that fades towards its ends.
struct Scratch {
    /// Its middle, in the tile.
    s: f64,
    t: f64,
    /// Sine and cosine of its angle to the horizontal.
    sine: f64,
    cosine: f64,
    /// Half its length, in tile widths.
    half_length: f64,
}

static SCRATCHES: LazyLock<Vec<Scratch>> = LazyLock::new(|| (0..SCRATCH_COUNT).map(scratch).collect());

fn scratch(index: i64) -> Scratch {
    let random = |seed: u64| noise::uniform(index, 0, 660 + seed);
    let (sine, cosine) = (PI * random(0)).sin_cos();
    let half_length = mix_between(0.05, 0.2, random(1));
    Scratch { s: random(2), t: random(3), sine, cosine, half_length }
}

/// How deep the deepest scratch is at `(s, t)`, in tile widths.
fn scratches(s: f64, t: f64) -> f64 {
    SCRATCHES.iter().map(|scratch| scratch.depth(s, t)).fold(0.0, f64::max)
}

impl Scratch {
    fn depth(&self, s: f64, t: f64) -> f64 {
        // The nearest of its copies in the tiles around.
        let (x, y) = (centred(s - self.s), centred(t - self.t));
        let across = (self.cosine * y - self.sine * x).abs();
        let along = self.cosine * x + self.sine * y;
        if across > HALF_SCRATCH || along.abs() > self.half_length {
            return 0.0;
        }
        let fade = 1.0 - (along / self.half_length).powi(2);
        0.55 * fade * (HALF_SCRATCH - across)
    }
}

/// The same place of the tile, from -0.5 to 0.5.
fn centred(place: f64) -> f64 {
    place - place.round()
}
