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

#[cfg(test)]
mod tests {
    use super::*;

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
