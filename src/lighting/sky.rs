//! How a sky lights the surface: which, turned how far, how bright, by how many bands.

use std::sync::Arc;

use glam::{Mat3, Vec3};
use serde::{Deserialize, Serialize};

use super::Environment;
use super::Incident;
use super::sky_harmonics::{MOST_BANDS, Views};

/// The light from everywhere.
#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(default)]
pub struct Sky {
    /// The sky; `None` for darkness. Files name it elsewhere, for it has to be read.
    #[serde(skip)]
    pub environment: Option<Arc<Environment>>,
    /// Degrees that it is turned around `+z`, from `+x` towards `+y`.
    pub rotation_deg: f32,
    /// Factor on its radiance.
    pub intensity: f32,
    /// The last band l* of the specular light, at most [`MOST_BANDS`]; the truth has none.
    pub last_band: u8,
    /// True where the specular light of its sun is that of a far light; else it goes through the bands with the rest of
    /// the sky, as the paper has it.
    pub is_sun_apart: bool,
    /// True where it is seen behind the surface.
    pub is_seen: bool,
}

impl Default for Sky {
    fn default() -> Self {
        Self {
            environment: None,
            rotation_deg: 0.0,
            intensity: 1.0,
            last_band: Self::LAST_BAND,
            is_sun_apart: true,
            is_seen: true,
        }
    }
}

impl PartialEq for Sky {
    fn eq(&self, other: &Self) -> bool {
        let environment = |sky: &Self| sky.environment.as_ref().map(Arc::as_ptr);
        let rest = |sky: &Self| (sky.rotation_deg, sky.intensity, sky.last_band, sky.is_sun_apart, sky.is_seen);
        environment(self) == environment(other) && rest(self) == rest(other)
    }
}

impl Sky {
    /// What the paper runs.
    pub const LAST_BAND: u8 = 8;

    /// The last band in use.
    pub fn last_band(&self) -> usize {
        usize::from(self.last_band).min(MOST_BANDS)
    }

    /// The sky's own frame from the world's.
    pub fn sky_from_world(&self) -> Mat3 {
        Mat3::from_rotation_z(-self.rotation_deg.to_radians())
    }

    /// What the sun gives everywhere where it is a light of its own, for the specular part alone; a light of radiance 1 is reflected without the
    /// Lambertian's `1/pi`, so that its radiance is the irradiance over pi.
    pub fn sunlight(&self) -> Option<Incident> {
        let sun = self.environment.as_ref().filter(|_| self.is_sun_apart)?.sun?;
        Some(Incident {
            direction_in_world: self.sky_from_world().transpose() * sun.direction_in_sky,
            radiance: self.intensity / std::f32::consts::PI * sun.irradiance,
        })
    }

    /// The harmonics of the specular light that goes through the bands.
    pub fn views<'a>(&self, environment: &'a Environment) -> &'a Views {
        let harmonics = &environment.harmonics;
        harmonics.whole.as_ref().filter(|_| !self.is_sun_apart).unwrap_or(&harmonics.rest)
    }

    /// Linear RGB seen in a direction of world space; `None` where no sky is seen.
    pub fn seen(&self, direction_in_world: Vec3) -> Option<Vec3> {
        let environment = self.environment.as_ref().filter(|_| self.is_seen)?;
        Some(self.intensity * environment.seen(self.sky_from_world() * direction_in_world))
    }
}
