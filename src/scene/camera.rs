//! An orbiting perspective camera.

use glam::camera::rh::{proj::directx::perspective, view::look_at_mat4};
use glam::{Mat4, Vec3};

/// Looks at the origin from `distance` away; world `+z` is up.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(default)]
pub struct Camera {
    /// Degrees around `+z`, from `-y` towards `+x`; 0 has the x axis running right.
    pub azimuth_deg: f32,
    /// Degrees above the plane `z = 0`, `-89.9..=89.9`.
    pub elevation_deg: f32,
    /// From eye to origin.
    pub distance: f32,
    /// Vertical field of view.
    pub field_of_view_deg: f32,
}

impl Default for Camera {
    fn default() -> Self {
        Self { azimuth_deg: 0.0, elevation_deg: 50.0, distance: 3.2, field_of_view_deg: 40.0 }
    }
}

impl Camera {
    /// Nearest distance a dolly may reach.
    pub const MIN_DISTANCE: f32 = 0.2;
    /// Farthest distance a dolly may reach.
    pub const MAX_DISTANCE: f32 = 60.0;

    /// The eye's position.
    pub fn eye_in_world(&self) -> Vec3 {
        let (sin_a, cos_a) = self.azimuth_deg.to_radians().sin_cos();
        let (sin_e, cos_e) = self.elevation_deg.to_radians().sin_cos();
        self.distance * Vec3::new(sin_a * cos_e, -cos_a * cos_e, sin_e)
    }

    /// Clip space from world, depth in `0..=1`, for a picture `aspect` times as wide as high.
    pub fn clip_from_world(&self, aspect: f32) -> Mat4 {
        let near = (self.distance - 4.0).max(self.distance * 0.02);
        let projection = perspective(self.field_of_view_deg.to_radians(), aspect, near, self.distance + 8.0);
        projection * look_at_mat4(self.eye_in_world(), Vec3::ZERO, Vec3::Z)
    }

    /// Turns the camera around its target, in degrees.
    pub fn orbit(&mut self, azimuth_deg: f32, elevation_deg: f32) {
        self.azimuth_deg = (self.azimuth_deg + azimuth_deg + 180.0).rem_euclid(360.0) - 180.0;
        self.elevation_deg = (self.elevation_deg + elevation_deg).clamp(-89.9, 89.9);
    }

    /// Moves towards the target (`factor` below 1) or away from it.
    pub fn dolly(&mut self, factor: f32) {
        self.distance = (self.distance * factor).clamp(Self::MIN_DISTANCE, Self::MAX_DISTANCE);
    }
}
