//! One light: infinitely far away, or at a point.
//!
//! Both are one thing in homogeneous coordinates: a point light stands at `(p, 1)`, a directional one at `(d, 0)` with
//! d a unit vector. From the point x the light lies along `v = p - w x` and gives `radiance / |v|^2`, which leaves a
//! directional light as it is and has a point light fall off by the inverse square.

use std::str::FromStr;

use glam::{Vec3, Vec4, Vec4Swizzles};

use crate::color::linear_from_srgb;

/// A light in world space, placed by angles around the origin so that it can be dragged and typed.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(default)]
pub struct Light {
    /// Degrees above the horizon plane `z = 0`, `-90..=90`.
    pub elevation_deg: f32,
    /// Degrees from `+x` towards `+y`, `-180..=180`.
    pub azimuth_deg: f32,
    /// Linear RGB.
    pub color: Vec3,
    /// Factor on the colour; of a point light, at a distance of 1.
    pub intensity: f32,
    /// From the origin, above 0; `None` for a directional light.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub distance: Option<f32>,
}

/// What a light gives at a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Incident {
    /// Unit vector towards the light; zero at the light itself.
    pub direction_in_world: Vec3,
    /// Linear RGB.
    pub radiance: Vec3,
}

/// The least squared distance that is told apart, so that nothing shines without bound.
const LEAST_SQUARED: f32 = 1e-4;

impl Default for Light {
    fn default() -> Self {
        Self::DEFAULT
    }
}

impl Light {
    /// What a new session starts with.
    pub const DEFAULT: Self =
        Self { elevation_deg: 48.0, azimuth_deg: 155.0, color: Vec3::ONE, intensity: 1.5, distance: None };

    /// The least distance of a point light.
    pub const MIN_DISTANCE: f32 = 0.1;
    /// The greatest.
    pub const MAX_DISTANCE: f32 = 50.0;

    /// Unit vector from the origin towards the light in world space.
    pub fn direction_in_world(&self) -> Vec3 {
        let (sin_e, cos_e) = self.elevation_deg.to_radians().sin_cos();
        let (sin_a, cos_a) = self.azimuth_deg.to_radians().sin_cos();
        Vec3::new(cos_e * cos_a, cos_e * sin_a, sin_e)
    }

    /// Where the light stands, in homogeneous coordinates.
    pub fn position_in_world(&self) -> Vec4 {
        let direction = self.direction_in_world();
        self.distance.map_or(direction.extend(0.0), |distance| (distance * direction).extend(1.0))
    }

    /// Linear RGB; of a point light, at a distance of 1.
    pub fn radiance(&self) -> Vec3 {
        self.color * self.intensity
    }

    /// What arrives at a point of world space.
    pub fn at(&self, point_in_world: Vec3) -> Incident {
        let position = self.position_in_world();
        let to_light = position.xyz() - position.w * point_in_world;
        let squared = to_light.length_squared().max(LEAST_SQUARED);
        Incident { direction_in_world: to_light.normalize_or_zero(), radiance: self.radiance() / squared }
    }

    /// The same light at this distance, or infinitely far away, and as bright at the origin.
    pub fn moved_to(self, distance: Option<f32>) -> Self {
        let squared = |distance: Option<f32>| distance.map_or(1.0, |distance| distance * distance);
        Self { distance, intensity: self.intensity * squared(distance) / squared(self.distance), ..self }
    }
}

/// Why a light could not be read.
#[derive(Debug, thiserror::Error, PartialEq, Eq)]
#[error(
    "'{0}' is not a light: write azimuth=DEGREES, elevation=DEGREES, intensity=FACTOR, color=#RRGGBB and distance=D \
     with commas between, whichever are wanted"
)]
pub struct ParseLightError(String);

impl FromStr for Light {
    type Err = ParseLightError;

    /// Reads `azimuth=30,elevation=45,intensity=2,color=#ffcc88,distance=3`; what is not named is the default's.
    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let mut light = Self::DEFAULT;
        for part in text.split(',') {
            light.set(part).ok_or_else(|| ParseLightError(text.to_owned()))?;
        }
        Ok(light)
    }
}

impl Light {
    /// Sets what `part` names; `None` where that cannot be.
    fn set(&mut self, part: &str) -> Option<()> {
        let (name, value) = part.trim().split_once('=')?;
        let number = |least: f32, most: f32| value.parse().ok().filter(|number| (least..=most).contains(number));
        match name {
            "azimuth" => self.azimuth_deg = number(-360.0, 360.0)?,
            "elevation" => self.elevation_deg = number(-90.0, 90.0)?,
            "intensity" => self.intensity = number(0.0, 1e6)?,
            "color" => self.color = hexadecimal(value)?,
            "distance" => self.distance = Some(number(Self::MIN_DISTANCE, Self::MAX_DISTANCE)?),
            _ => return None,
        }
        Some(())
    }
}

/// Linear RGB of `#RRGGBB`, sRGB.
fn hexadecimal(text: &str) -> Option<Vec3> {
    let digits = text.strip_prefix('#').filter(|digits| digits.len() == 6 && digits.is_ascii())?;
    let channel = |at: usize| u8::from_str_radix(digits.get(at..at + 2)?, 16).ok();
    let linear = |at: usize| channel(at).map(|code| linear_from_srgb(f32::from(code) / 255.0));
    Some(Vec3::new(linear(0)?, linear(2)?, linear(4)?))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_directional_light_is_the_same_everywhere_and_a_point_light_falls_off_by_the_inverse_square() {
        let far = Light::DEFAULT;
        let near = Light { distance: Some(2.0), ..far };
        let at = |share: f32| share * near.direction_in_world();
        for share in [-1.0, 0.0, 1.5] {
            let incident = far.at(at(share));
            assert!((incident.radiance - far.radiance()).abs().max_element() < 1e-6);
            assert!((incident.direction_in_world - far.direction_in_world()).length() < 1e-6);
            let squared = (2.0 - share) * (2.0 - share);
            assert!((near.at(at(share)).radiance * squared - near.radiance()).abs().max_element() < 1e-5, "{share}");
        }
        assert!(near.at(at(3.0)).direction_in_world.dot(near.direction_in_world()) < -0.999, "it lies behind");
        assert!(near.at(at(2.0)).radiance.is_finite(), "at the light itself");
    }

    #[test]
    fn a_light_moved_nearer_is_as_bright_at_the_origin() {
        let moved = Light::DEFAULT.moved_to(Some(3.0));
        assert!((moved.at(Vec3::ZERO).radiance - Light::DEFAULT.radiance()).abs().max_element() < 1e-6);
        assert_eq!(moved.moved_to(None), Light::DEFAULT);
    }

    #[test]
    fn a_light_is_read_by_its_names_and_nothing_else_is() {
        let light: Light = "azimuth=-30,elevation=10,intensity=2,color=#ff8000,distance=3".parse().expect("a light");
        assert_eq!((light.azimuth_deg, light.elevation_deg, light.intensity), (-30.0, 10.0, 2.0));
        assert_eq!(light.distance, Some(3.0));
        assert!((light.color - Vec3::new(1.0, 0.2159, 0.0)).abs().max_element() < 1e-3, "{}", light.color);
        assert_eq!("elevation=20".parse(), Ok(Light { elevation_deg: 20.0, ..Light::DEFAULT }));
        for text in ["", "30", "azimuth", "azimuth=x", "elevation=91", "color=ff8000", "color=#ff80é", "distance=0"] {
            assert!(text.parse::<Light>().is_err(), "{text}");
        }
    }
}
