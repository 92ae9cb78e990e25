//! V-shaped grooves: two orientations and nothing else.

use glam::DVec3;

use super::{Place, Sample, Surface};

pub const SAMPLE: Sample = Sample {
    name: "v-groove",
    description: "Straight V-shaped grooves: two orientations that average to a flat one nobody sees",
    surface: Surface::Normal(normal),
};

/// Grooves to the tile: with a power of two, the texels of the coarse levels hold the same number of each side.
const GROOVES: f64 = 16.0;
/// How far the sides lean from +z.
const LEAN_RAD: f64 = 0.6;

fn normal(place: Place) -> DVec3 {
    let (s, _) = place.centre();
    let falling = (s * GROOVES).fract() < 0.5;
    let side = if falling { 1.0 } else { -1.0 };
    DVec3::new(side * LEAN_RAD.sin(), 0.0, LEAN_RAD.cos())
}
