//! Directions in tangent space as users write and read them.

use std::str::FromStr;

use glam::{DVec3, Vec3};

/// A unit vector in tangent space: `+x` right, `+y` up the image, `+z` out of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Direction(DVec3);

impl Direction {
    /// The direction of `vector`, or `None` where it has none (zero or not finite).
    pub fn new(vector: DVec3) -> Option<Self> {
        vector.try_normalize().map(Self)
    }

    /// The unit vector.
    pub fn vector(self) -> DVec3 {
        self.0
    }
}

/// Why a direction could not be read.
#[derive(Debug, thiserror::Error, PartialEq, Eq)]
#[error("'{0}' is not a direction: write X,Y,Z, for example 0,0.3,1")]
pub struct ParseDirectionError(String);

impl FromStr for Direction {
    type Err = ParseDirectionError;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let fields: Option<Vec<f64>> = text
            .split(|c: char| c == ',' || c.is_whitespace())
            .filter(|field| !field.is_empty())
            .map(|field| field.parse().ok())
            .collect();
        match fields.as_deref() {
            Some(&[x, y, z]) => Self::new(DVec3::new(x, y, z)),
            _ => None,
        }
        .ok_or_else(|| ParseDirectionError(text.to_owned()))
    }
}

/// Polar angle from `+z` and azimuth from `+x` towards `+y`, in degrees; the azimuth lies in `0..360`.
pub fn polar_deg(direction: Vec3) -> (f32, f32) {
    let sine = direction.truncate().length();
    let theta = sine.atan2(direction.z).to_degrees();
    (theta, direction.y.atan2(direction.x).to_degrees().rem_euclid(360.0))
}

/// `count` directions of equal solid angle over the hemisphere `z > 0`: Fibonacci points.
pub fn hemisphere(count: usize) -> impl Iterator<Item = DVec3> {
    let golden_angle = std::f64::consts::PI * (3.0 - 5.0_f64.sqrt());
    (0..count).map(move |i| {
        let z = 1.0 - (i as f64 + 0.5) / count as f64;
        let (sin, cos) = (i as f64 * golden_angle).sin_cos();
        let radius = (1.0 - z * z).sqrt();
        DVec3::new(radius * cos, radius * sin, z)
    })
}

/// `count` directions of equal solid angle over the zone around `axis`, a unit vector, between two cosines to it, the
/// `inner` one larger: Fibonacci points.
pub fn zone(axis: DVec3, inner: f64, outer: f64, count: usize) -> impl Iterator<Item = DVec3> {
    let (side, other) = axis.any_orthonormal_pair();
    hemisphere(count).map(move |point| {
        let z = outer + (inner - outer) * point.z;
        let shrink = ((1.0 - z * z) / (1.0 - point.z * point.z)).sqrt();
        shrink * (point.x * side + point.y * other) + z * axis
    })
}

/// Directions spread evenly over the hemisphere, on rings that share the angle from the pole evenly; the set stays the same
/// when mirrored or turned by a right angle, so that what is worked out from it turns with the map. Nine rings have 204.
pub fn symmetric_hemisphere(rings: usize) -> impl Iterator<Item = Vec3> {
    let spacing = std::f64::consts::FRAC_PI_2 / rings as f64;
    (0..rings).flat_map(move |ring| {
        let (sine, z) = ((ring as f64 + 0.5) * spacing).sin_cos();
        let quarter = (std::f64::consts::FRAC_PI_2 * sine / spacing).round().max(1.0) as usize;
        let phase = if ring % 2 == 0 { 0.5 } else { 0.0 };
        (0..quarter).flat_map(move |k| {
            let (sin, cos) = (std::f64::consts::FRAC_PI_2 * (k as f64 + phase) / quarter as f64).sin_cos();
            let (x, y, z) = ((sine * cos) as f32, (sine * sin) as f32, z as f32);
            [Vec3::new(x, y, z), Vec3::new(-y, x, z), Vec3::new(-x, -y, z), Vec3::new(y, -x, z)]
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_symmetric_directions_are_a_mirror_image_of_themselves_and_spread_evenly() {
        let all: Vec<Vec3> = symmetric_hemisphere(9).collect();
        assert_eq!(all.len(), 204);
        let nearest = |v: Vec3| all.iter().map(|w| v.distance(*w)).filter(|&d| d > 0.0).fold(f32::MAX, f32::min);
        for &v in &all {
            assert!((v.length() - 1.0).abs() < 1e-6 && nearest(v) > 0.11, "{v}");
            for image in [Vec3::new(-v.x, v.y, v.z), Vec3::new(v.x, -v.y, v.z), Vec3::new(-v.y, v.x, v.z)] {
                assert!(all.iter().any(|w| image.distance(*w) < 1e-6), "{v}");
            }
        }
    }

    #[test]
    fn a_zone_holds_unit_vectors_whose_mean_is_its_own() {
        for (inner, outer) in [(1.0, -1.0), (1.0, 0.7), (0.9, 0.1), (0.999, 0.99)] {
            let axis = DVec3::new(0.3, -0.5, 0.6).normalize();
            let points: Vec<DVec3> = zone(axis, inner, outer, 2000).collect();
            let is_inside = |p: &DVec3| (outer..=inner).contains(&p.dot(axis));
            assert!(points.iter().all(|p| (p.length() - 1.0).abs() < 1e-12 && is_inside(p)));
            let mean = points.iter().sum::<DVec3>() / 2000.0;
            assert!((mean - 0.5 * (inner + outer) * axis).length() < 5e-3, "{inner} to {outer}: {mean}");
        }
    }

    #[test]
    fn a_direction_is_normalised_on_reading() {
        let direction: Direction = "0, 3,4".parse().expect("three numbers");
        assert!((direction.vector() - DVec3::new(0.0, 0.6, 0.8)).length() < 1e-15);
        assert!("0,0,0".parse::<Direction>().is_err());
        assert!("1,2".parse::<Direction>().is_err());
    }

    #[test]
    fn polar_angles_run_from_z_and_from_x_towards_y() {
        let (theta, phi) = polar_deg(Vec3::new(0.0, -1.0, 0.0));
        assert!((theta - 90.0).abs() < 1e-4 && (phi - 270.0).abs() < 1e-4);
    }
}
