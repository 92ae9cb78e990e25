//! How the sphere of directions is turned towards the eye: an orthographic view, tilted and spun.
//!
//! View space has `x` right, `y` up and `z` towards the eye; the picture of the unit sphere is the unit disc.

use glam::{DMat3, DVec2, DVec3};

/// Which way the sphere view is turned.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(default)]
pub struct SphereOrbit {
    /// Degrees that the sphere is spun around tangent space's `+z`.
    pub spin_deg: f64,
    /// Degrees that `+z` leans away from the eye: 0 looks down on it, 90 from the side.
    pub tilt_deg: f64,
}

impl Default for SphereOrbit {
    fn default() -> Self {
        Self { spin_deg: 25.0, tilt_deg: 32.0 }
    }
}

impl SphereOrbit {
    /// Looking down `+z`: `+x` right, `+y` up, as the map lies.
    pub const TOP: Self = Self { spin_deg: 0.0, tilt_deg: 0.0 };
    /// Looking along `+y`: `+x` right, `+z` up.
    pub const SIDE: Self = Self { spin_deg: 0.0, tilt_deg: 90.0 };

    /// Takes a direction from tangent space into view space.
    pub fn view_from_tangent(self) -> DMat3 {
        DMat3::from_rotation_x(-self.tilt_deg.to_radians()) * DMat3::from_rotation_z(self.spin_deg.to_radians())
    }

    /// Turns the sphere by a drag, in degrees.
    pub fn turn(&mut self, spin_deg: f64, tilt_deg: f64) {
        self.spin_deg = (self.spin_deg + spin_deg + 180.0).rem_euclid(360.0) - 180.0;
        self.tilt_deg = (self.tilt_deg + tilt_deg).clamp(0.0, 180.0);
    }

    /// The direction, in tangent space, that is seen at a point of the unit disc; `None` beside the sphere.
    pub fn direction_under(self, point_in_disc: DVec2) -> Option<DVec3> {
        let height_squared = 1.0 - point_in_disc.length_squared();
        (height_squared >= 0.0)
            .then(|| self.view_from_tangent().transpose() * point_in_disc.extend(height_squared.sqrt()))
    }

    /// Where a direction is seen: its point of the unit disc, and how far it faces the eye (negative behind the horizon).
    pub fn place(self, direction_in_tangent: DVec3) -> (DVec2, f64) {
        let in_view = self.view_from_tangent() * direction_in_tangent;
        (in_view.truncate(), in_view.z)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_direction_under_a_place_is_the_one_placed_there() {
        let orbit = SphereOrbit { spin_deg: -73.0, tilt_deg: 51.0 };
        for direction in crate::sphere::direction::hemisphere(200) {
            let (point, facing) = orbit.place(direction);
            if facing > 1e-3 {
                let found = orbit.direction_under(point).expect("on the sphere");
                assert!((found - direction).length() < 1e-9, "{direction}: {found}");
            }
        }
        assert_eq!(orbit.direction_under(DVec2::new(0.8, 0.7)), None);
    }

    #[test]
    fn the_presets_show_the_axes_where_they_say() {
        assert!((SphereOrbit::TOP.place(DVec3::Y).0 - DVec2::Y).length() < 1e-12);
        assert!((SphereOrbit::SIDE.place(DVec3::Z).0 - DVec2::Y).length() < 1e-12);
        assert!((SphereOrbit::SIDE.place(DVec3::X).0 - DVec2::X).length() < 1e-12);
        assert!(SphereOrbit::SIDE.place(DVec3::NEG_Y).1 > 0.99);
    }
}
