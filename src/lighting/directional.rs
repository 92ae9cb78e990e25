//! A light infinitely far away.

use glam::Vec3;

/// A directional light in world space, placed by angles so that it can be dragged and typed.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(default)]
pub struct DirectionalLight {
    /// Degrees above the horizon plane `z = 0`, `-90..=90`.
    pub elevation_deg: f32,
    /// Degrees from `+x` towards `+y`, `-180..=180`.
    pub azimuth_deg: f32,
    /// Linear RGB.
    pub color: Vec3,
    /// Factor on the colour.
    pub intensity: f32,
}

impl Default for DirectionalLight {
    fn default() -> Self {
        Self::DEFAULT
    }
}

impl DirectionalLight {
    /// What a new session starts with.
    pub const DEFAULT: Self = Self { elevation_deg: 48.0, azimuth_deg: 155.0, color: Vec3::ONE, intensity: 1.5 };

    /// Unit vector towards the light in world space.
    pub fn direction_in_world(&self) -> Vec3 {
        let (sin_e, cos_e) = self.elevation_deg.to_radians().sin_cos();
        let (sin_a, cos_a) = self.azimuth_deg.to_radians().sin_cos();
        Vec3::new(cos_e * cos_a, cos_e * sin_a, sin_e)
    }

    /// Linear RGB radiance.
    pub fn radiance(&self) -> Vec3 {
        self.color * self.intensity
    }
}
