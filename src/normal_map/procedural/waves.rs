//! Water: a few dozen waves that cross each other.

use std::f64::consts::TAU;
use std::sync::LazyLock;

use super::{Sample, Surface, noise};

pub const SAMPLE: Sample = Sample {
    name: "waves",
    description: "Crossing water waves: a smooth spread of normals without edges",
    surface: Surface::Height(height),
};

/// How many waves are summed.
const COUNT: usize = 24;
/// Waves to the tile of the longest and of the shortest.
const LONGEST: f64 = 2.0;
const SHORTEST: f64 = 26.0;
/// Largest slope of a single wave.
const STEEPNESS: f64 = 0.075;

/// One wave, `height * sin(2 pi (right s + up t + phase))` with sharpened crests.
struct Wave {
    /// Waves to the tile along each axis: whole numbers, so that it tiles.
    right: f64,
    up: f64,
    /// Where it begins, in wavelengths.
    phase: f64,
    /// Half its height, in tile widths.
    height: f64,
}

static WAVES: LazyLock<Vec<Wave>> = LazyLock::new(|| (0..COUNT).map(wave).collect());

fn height(s: f64, t: f64) -> f64 {
    let swell = |wave: &Wave| {
        let (sine, cosine) = (TAU * (wave.right * s + wave.up * t + wave.phase)).sin_cos();
        // The second harmonic, -cos(2 angle), sharpens the crests.
        wave.height * (sine + 0.25 * (sine * sine - cosine * cosine))
    };
    WAVES.iter().map(swell).sum()
}

/// The wave at `index`, the longest first; all are equally steep.
fn wave(index: usize) -> Wave {
    let random = |seed: u64| noise::uniform(index as i64, 0, seed);
    let count = LONGEST * (SHORTEST / LONGEST).powf(index as f64 / (COUNT - 1) as f64);
    // The wind blows towards about (0.9, 0.4), give or take 70 degrees.
    let direction = 0.4 + 2.4 * (random(71) - 0.5);
    let (right, up) = ((count * direction.cos()).round(), (count * direction.sin()).round());
    let height = STEEPNESS / (TAU * right.hypot(up).max(1.0));
    Wave { right, up, phase: random(72), height }
}
