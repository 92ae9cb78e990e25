//! What is made of the frames of a triangle's corners at a pixel between them.
//!
//! A normal `n` of the map stands for the surface's normal along `C n`. Interpolation leaves the corners' tangent t,
//! bitangent b and normal neither of length 1 nor at right angles, and there is no one way to mend that: whoever baked
//! the map has chosen one, and it should be read by the same (M. S. Mikkelsen, *Simulation of Wrinkled Surfaces
//! Revisited*, 2008, sections 3.4 and 3.5).
//!
//! Methods light their normals in an orthonormal frame R, where a rotation takes lights and half vectors to. What C does
//! beyond that is `R^T C`, which turns normals apart where the texture is sheared: single normals, those of the truth and
//! the mean directions of lobes, turn as they are, exactly; what a rival keeps of a distribution turns with its mean.

use glam::{DMat3, DVec3, Mat3, Vec3};

/// How the frame at a pixel is reconstructed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Reconstruction {
    /// The normal and, laid into its plane, the tangent, both made unit vectors; the bitangent at right angles to both,
    /// on its own side: `C = R`, a rotation, or a mirrored one.
    #[default]
    Orthonormal,
    /// Section 3.4: the normal made a unit vector, then both derivatives laid into its plane. `C = (T^-1)^T` of their
    /// directions (equation 56): the lengths of the third step cancel in a map of normals, whose slopes count texels.
    Projected,
    /// Section 3.5: the interpolated vectors as they are, `C = T` (equations 57 and 58).
    Interpolated,
}

/// The frame at a pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PixelFrame {
    /// R: tangent, bitangent up the image, outward normal, orthonormal; left-handed where the map is mirrored.
    pub world_from_tangent: DMat3,
    /// `R^T C`, which takes the map's normals to that frame, up to their length.
    pub tangent_from_map: DMat3,
}

/// Below this the area that tangent and bitangent span is none, and their inverse means nothing.
const LEAST_DETERMINANT: f64 = 1e-3;

impl Reconstruction {
    /// Every way, in the order they are offered.
    pub const ALL: [Self; 3] = [Self::Orthonormal, Self::Projected, Self::Interpolated];

    /// The name on the command line and in session files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Orthonormal => "orthonormal",
            Self::Projected => "projected",
            Self::Interpolated => "interpolated",
        }
    }

    /// The name to show.
    pub fn label(self) -> &'static str {
        match self {
            Self::Orthonormal => "orthonormal",
            Self::Projected => "projected (Mikkelsen 3.4)",
            Self::Interpolated => "interpolated (3.5)",
        }
    }

    /// The frame from the interpolated tangent, bitangent and normal, the columns of a matrix.
    pub fn frame(self, interpolated: DMat3) -> PixelFrame {
        let DMat3 { x_axis: tangent, y_axis: bitangent, z_axis: normal } = interpolated;
        let normal = normal.normalize_or_zero();
        let laid = |v: DVec3| (v - normal * normal.dot(v)).normalize_or_zero();
        let tangent = laid(tangent);
        let across = normal.cross(tangent);
        // A mirrored map makes a left-handed frame.
        let side = if across.dot(bitangent) < 0.0 { -1.0 } else { 1.0 };
        let own = DMat3::from_cols(tangent, side * across, normal);
        let determinant = across.dot(laid(bitangent));
        let tangent_from_map = match self {
            Self::Projected if determinant.abs() > LEAST_DETERMINANT => {
                let inverse = [laid(bitangent).cross(normal) / determinant, across / determinant, normal];
                own.transpose() * DMat3::from_cols(inverse[0], inverse[1], inverse[2])
            }
            Self::Orthonormal | Self::Projected => DMat3::IDENTITY,
            Self::Interpolated => own.transpose() * interpolated,
        };
        PixelFrame { world_from_tangent: own, tangent_from_map }
    }
}

/// A normal as `tangent_from_map` takes it, its length left: a mean normal's tells how its normals are spread.
pub fn turned(tangent_from_map: Mat3, normal: Vec3) -> Vec3 {
    if tangent_from_map == Mat3::IDENTITY {
        return normal;
    }
    normal.length() * (tangent_from_map * normal).normalize_or_zero()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_frame_that_is_orthonormal_stays_as_it_is_of_either_orientation() {
        let right = DMat3::from_rotation_x(0.3) * DMat3::from_rotation_z(1.1);
        let left = right * DMat3::from_diagonal(DVec3::new(1.0, -1.0, 1.0));
        for (frame, way) in [right, left].into_iter().flat_map(|frame| Reconstruction::ALL.map(|way| (frame, way))) {
            let found = way.frame(frame);
            assert!(found.world_from_tangent.abs_diff_eq(frame, 1e-12), "{way:?}");
            assert!(found.tangent_from_map.abs_diff_eq(DMat3::IDENTITY, 1e-12), "{way:?}");
        }
    }

    #[test]
    fn projected_is_the_inverse_transposed_of_unit_derivatives_in_the_normals_plane() {
        let (t, b, n) = (DVec3::new(0.8, 0.1, 0.2), DVec3::new(0.5, 0.7, -0.1), DVec3::new(0.1, -0.1, 0.9));
        let whole = DMat3::from_cols(t, b, n);
        let all = |way: Reconstruction| {
            let found = way.frame(whole);
            found.world_from_tangent * found.tangent_from_map
        };
        let n = n.normalize();
        let laid = |v: DVec3| (v - n * n.dot(v)).normalize();
        let expected = DMat3::from_cols(laid(t), laid(b), n).inverse().transpose();
        assert!(all(Reconstruction::Projected).abs_diff_eq(expected, 1e-12));
        assert!(all(Reconstruction::Interpolated).abs_diff_eq(whole, 1e-12));
        for way in [Reconstruction::Orthonormal, Reconstruction::Projected] {
            // What is flat in the map is the surface's own normal, whatever the texture does.
            assert!((all(way) * DVec3::Z - n).length() < 1e-12, "{way:?}");
        }
    }

    #[test]
    fn derivatives_that_fall_together_leave_a_finite_frame() {
        let frame = DMat3::from_cols(DVec3::X, DVec3::new(1.0, 1e-5, 0.0), DVec3::Z);
        let found = Reconstruction::Projected.frame(frame).tangent_from_map;
        assert!(found.abs_diff_eq(DMat3::IDENTITY, 1e-12), "{found}");
    }
}
