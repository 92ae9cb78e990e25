//! The parametric surfaces, to second order: plane, sphere, torus, monkey saddle.
//!
//! u runs rightwards and t up the image, both from 0 to 1. The torus is Mikkelsen's (2008, section 2.6.2) turned by a
//! quarter so that `u = 1/2` faces the front, `-y`; the monkey saddle is his (section 2.6.1).

use std::f64::consts::{PI, TAU};

use glam::{DVec2, DVec3};

use super::jet::Jet;

/// The square -1..1 in `z = 0`, facing `+z`.
pub fn plane(u: f64, t: f64) -> Jet {
    Jet {
        position: DVec3::new(2.0 * u - 1.0, 2.0 * t - 1.0, 0.0),
        u: 2.0 * DVec3::X,
        t: 2.0 * DVec3::Y,
        ..Jet::default()
    }
}

/// The unit sphere: longitude along u, eastwards; latitude along t, from the south pole to the north pole.
pub fn sphere(u: f64, t: f64) -> Jet {
    let (sin, cos) = ((t - 0.5) * PI).sin_cos();
    let point = DVec2::new(cos, sin);
    revolution(u, [point, PI * DVec2::new(-sin, cos), -PI * PI * point])
}

/// A torus around `z`: `radii` are those of the ring and of its tube. Around the axis along u, eastwards; around the
/// tube along t, from the inside under the bottom to the outside at `t = 1/2`.
pub fn torus([ring, tube]: [f64; 2], u: f64, t: f64) -> Jet {
    let (sin, cos) = ((2.0 * t - 1.0) * PI).sin_cos();
    let around = tube * DVec2::new(cos, sin);
    revolution(u, [around + ring * DVec2::X, TAU * tube * DVec2::new(-sin, cos), -TAU * TAU * around])
}

/// `z = x^3 - 3 x y^2` over the square -1..1.
pub fn monkey_saddle(u: f64, t: f64) -> Jet {
    let (x, y) = (2.0 * u - 1.0, 2.0 * t - 1.0);
    Jet {
        position: DVec3::new(x, y, x * x * x - 3.0 * x * y * y),
        u: DVec3::new(2.0, 0.0, 6.0 * (x * x - y * y)),
        t: DVec3::new(0.0, 2.0, -12.0 * x * y),
        uu: DVec3::new(0.0, 0.0, 24.0 * x),
        ut: DVec3::new(0.0, 0.0, -24.0 * y),
        tt: DVec3::new(0.0, 0.0, -24.0 * x),
    }
}

/// The surface of a profile turned around `z`: the profile's point and its first and second derivative, each as
/// distance from the axis and height.
fn revolution(u: f64, [point, first, second]: [DVec2; 3]) -> Jet {
    let (sin, cos) = ((u - 0.5) * TAU).sin_cos();
    let (east, outward) = (DVec3::new(cos, sin, 0.0), DVec3::new(sin, -cos, 0.0));
    let lifted = |profile: DVec2| profile.x * outward + profile.y * DVec3::Z;
    Jet {
        position: lifted(point),
        u: TAU * point.x * east,
        t: lifted(first),
        uu: -TAU * TAU * point.x * outward,
        ut: TAU * first.x * east,
        tt: lifted(second),
    }
}
