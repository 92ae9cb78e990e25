//! Metal flakes in paint: small flat cells, each with an orientation of its own.

use glam::DVec3;

use super::{Place, Sample, Surface, noise};

pub const SAMPLE: Sample = Sample {
    name: "flakes",
    description: "Metal flakes of paint: flat cells of random lean that glint one by one",
    surface: Surface::Normal(normal),
};

/// Flakes along a side of the tile, before they are jittered.
const CELLS: i64 = 96;
/// Standard deviation of a flake's slope.
const SPREAD: f64 = 0.22;

fn normal(place: Place) -> DVec3 {
    let (s, t) = place.centre();
    let flake = noise::nearest_point(s, t, CELLS, 91);
    let (right, up) = noise::gaussian_pair(flake.column, flake.row, 92);
    DVec3::new(SPREAD * right, SPREAD * up, 1.0)
}
