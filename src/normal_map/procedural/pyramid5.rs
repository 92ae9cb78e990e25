//! A truncated pyramid: five orientations, each with its own roughness.
//!
//! After figure 38 of M. S. Mikkelsen, *Simulation of Wrinkled Surfaces Revisited* (2008): a rough top, four
//! smoother sides, and seen from afar a highlight in the shape of a cross that no single lobe can hold.

use glam::DVec3;

use super::{Place, Sample, Surface, noise};

pub const SAMPLE: Sample = Sample {
    name: "pyramid5",
    description: "Truncated pyramid of five rough faces, whose highlight is a cross from afar",
    surface: Surface::Normal(normal),
};

/// Half the top's side, in tile widths: the top takes 0.43 of the area, the sides a seventh each.
const TOP_HALF: f64 = 0.3275;
/// How far the sides lean from +z.
const LEAN_RAD: f64 = 1.0;
/// Standard deviation of the slopes of the top and of the sides.
const TOP_ROUGHNESS: f64 = 0.26;
const SIDE_ROUGHNESS: f64 = 0.08;

fn normal(place: Place) -> DVec3 {
    let (s, t) = place.centre();
    let (right, up) = (s - 0.5, t - 0.5);
    let (facing, roughness) = if right.abs().max(up.abs()) < TOP_HALF {
        (DVec3::Z, TOP_ROUGHNESS)
    } else if right.abs() > up.abs() {
        (leaning(DVec3::X * right.signum()), SIDE_ROUGHNESS)
    } else {
        (leaning(DVec3::Y * up.signum()), SIDE_ROUGHNESS)
    };
    let (a, b) = noise::gaussian_pair(place.x as i64, place.y as i64, 38);
    let (tangent, bitangent) = facing.any_orthonormal_pair();
    let rough = facing + roughness * (a * tangent + b * bitangent);
    // No face looks below the horizon, however rough.
    DVec3::new(rough.x, rough.y, rough.z.max(0.02))
}

fn leaning(outwards: DVec3) -> DVec3 {
    outwards * LEAN_RAD.sin() + DVec3::Z * LEAN_RAD.cos()
}
