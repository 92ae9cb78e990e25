//! A brick wall in running bond: rough bricks, each set a little askew, in deep rough mortar.

use super::noise::{self, mix_between, smooth_step};
use super::{Sample, Surface};

pub const SAMPLE: Sample = Sample {
    name: "bricks",
    description: "Rough bricks set a little askew, with rounded edges and deep joints",
    surface: Surface::Height(height),
};

/// Bricks along a course and courses to the tile (even, for every other course is shifted by half a brick).
const COLUMNS: i64 = 4;
const COURSES: i64 = 8;
/// Half a joint's width and the width of a brick's rounded edge, in tile widths.
const HALF_JOINT: f64 = 0.006;
const EDGE: f64 = 0.012;
/// How far the bricks stand out of the joints.
const DEPTH: f64 = 0.013;
/// Largest slope that a brick is set askew by.
const ASKEW: f64 = 0.09;

fn height(s: f64, t: f64) -> f64 {
    // A brick's outline wavers.
    let (s, t) = (s + 0.002 * noise::smooth(s, t, (24, 24), 81), t + 0.002 * noise::smooth(s, t, (24, 24), 82));
    let (brick_width, brick_height) = (1.0 / COLUMNS as f64, 1.0 / COURSES as f64);
    let course = (t / brick_height).floor();
    let shift = if (course as i64).rem_euclid(2) == 0 { 0.0 } else { 0.5 };
    let column = (s / brick_width - shift).floor();
    let across = s - (column + shift + 0.5) * brick_width;
    let along = t - (course + 0.5) * brick_height;
    let inside = inset(brick_width / 2.0 - across.abs(), brick_height / 2.0 - along.abs());
    let (column, course) = ((column as i64).rem_euclid(COLUMNS), (course as i64).rem_euclid(COURSES));
    let share = smooth_step(HALF_JOINT, HALF_JOINT + EDGE, inside);
    mix_between(mortar(s, t), brick(s, t, across, along, (column, course)), share)
}

/// Distance from a rectangle's edge, inwards, its corners rounded by `EDGE`.
fn inset(from_side: f64, from_course: f64) -> f64 {
    let corner = (EDGE - (from_side - HALF_JOINT)).max(0.0).hypot((EDGE - (from_course - HALF_JOINT)).max(0.0));
    (HALF_JOINT + EDGE - corner).min(from_side).min(from_course)
}

fn mortar(s: f64, t: f64) -> f64 {
    0.0012 * noise::rough(s, t, (48, 48), 3, 83)
}

fn brick(s: f64, t: f64, across: f64, along: f64, (column, course): (i64, i64)) -> f64 {
    let signed = |seed: u64| 2.0 * noise::uniform(column, course, seed) - 1.0;
    let lean = ASKEW * (signed(84) * across + signed(85) * along);
    DEPTH + 0.002 * signed(87) + lean + 0.0011 * noise::rough(s, t, (20, 20), 5, 88) - pores(s, t)
}

/// Round pits of many sizes, most of them small.
fn pores(s: f64, t: f64) -> f64 {
    let pore = noise::nearest_point(s, t, 44, 86);
    let radius = 0.55 * noise::uniform(pore.column, pore.row, 89).powi(3);
    0.0035 * radius * (1.0 - smooth_step(0.0, radius.max(1e-6), pore.distance))
}
