//! The parametric surfaces: plane, sphere and torus.
//!
//! Each carries texture coordinates `u` right and `v` down, and an orthonormal frame per vertex whose tangent runs
//! along growing u and whose bitangent runs up the image, along falling v.

use std::f32::consts::{PI, TAU};

use glam::Vec3;

use super::mesh::{Mesh, Vertex};

/// Which surface wears the map.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ShapeKind {
    /// The square -1..1 in `z = 0`, facing `+z`.
    #[default]
    Plane,
    /// The unit sphere.
    Sphere,
    /// A torus around `z`, radii 0.75 and 0.35.
    Torus,
}

/// A surface and how often the map repeats on it.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(default)]
pub struct Shape {
    /// Which surface.
    pub kind: ShapeKind,
    /// Repeats of the map along u and along v.
    pub tiling: [f32; 2],
}

impl Default for Shape {
    fn default() -> Self {
        Self { kind: ShapeKind::Plane, tiling: [2.0, 2.0] }
    }
}

/// Distance from the torus's centre to its tube's centre.
const TORUS_RADIUS: f32 = 0.75;
/// Radius of the torus's tube.
const TUBE_RADIUS: f32 = 0.35;

impl ShapeKind {
    /// Every kind, in the order they are offered.
    pub const ALL: [Self; 3] = [Self::Plane, Self::Sphere, Self::Torus];

    /// The name to show.
    pub fn label(self) -> &'static str {
        match self {
            Self::Plane => "Plane",
            Self::Sphere => "Sphere",
            Self::Torus => "Torus",
        }
    }

    /// The surface's point and frame at texture coordinates in `0..=1`.
    pub fn vertex(self, u: f32, v: f32) -> Vertex {
        match self {
            Self::Plane => plane(u, v),
            Self::Sphere => sphere(u, v),
            Self::Torus => torus(u, v),
        }
    }

    /// The surface as triangles; texture coordinates run once over it, from 0 to 1.
    pub fn mesh(self) -> Mesh {
        match self {
            Self::Plane => Mesh::over_unit_square(1, 1, plane),
            Self::Sphere => Mesh::over_unit_square(192, 96, sphere),
            Self::Torus => Mesh::over_unit_square(192, 96, torus),
        }
    }
}

impl Shape {
    /// The surface as triangles, before tiling.
    pub fn mesh(&self) -> Mesh {
        self.kind.mesh()
    }
}

fn plane(u: f32, v: f32) -> Vertex {
    Vertex::new(Vec3::new(2.0 * u - 1.0, 1.0 - 2.0 * v, 0.0), Vec3::X, Vec3::Z, [u, v])
}

/// Longitude along u, eastwards; latitude falls along v from the north pole.
fn sphere(u: f32, v: f32) -> Vertex {
    let (east, outward) = around(u);
    let (sin, cos) = (v * PI).sin_cos();
    // At a pole the sine is all but zero; exactly zero closes the surface there.
    let ring = if v == 0.0 || v == 1.0 { 0.0 } else { sin };
    let position = ring * outward + cos * Vec3::Z;
    Vertex::new(position, east, position, [u, v])
}

/// Around the axis along u, eastwards; around the tube along v, from the inside over the top to the outside.
fn torus(u: f32, v: f32) -> Vertex {
    let (east, outward) = around(u);
    let (sin, cos) = ((1.0 - 2.0 * v) * PI).sin_cos();
    let normal = cos * outward + sin * Vec3::Z;
    Vertex::new(TORUS_RADIUS * outward + TUBE_RADIUS * normal, east, normal, [u, v])
}

/// The directions along and away from the z axis at turn `u`, which is 0 at the front, `-y`.
fn around(u: f32) -> (Vec3, Vec3) {
    let (sin, cos) = ((u - 0.5) * TAU).sin_cos();
    (Vec3::new(cos, sin, 0.0), Vec3::new(sin, -cos, 0.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec2;

    #[test]
    fn frames_are_orthonormal_and_lie_in_the_surface() {
        for kind in ShapeKind::ALL {
            for vertex in kind.mesh().vertices {
                let [t, n] = [vertex.tangent, vertex.normal].map(Vec3::from);
                assert!((t.length() - 1.0).abs() < 1e-5 && (n.length() - 1.0).abs() < 1e-5, "{kind:?} {vertex:?}");
                assert!(t.dot(n).abs() < 1e-5, "{kind:?} {vertex:?}");
            }
        }
    }

    #[test]
    fn tangents_run_along_growing_u_and_bitangents_along_falling_v() {
        for kind in ShapeKind::ALL {
            for [a, b, c] in kind.mesh().triangles() {
                let edge = |p: &Vertex| Vec3::from(p.position) - Vec3::from(a.position);
                let step = |p: &Vertex| Vec2::from(p.uv) - Vec2::from(a.uv);
                let (t, n) = (Vec3::from(a.tangent), Vec3::from(a.normal));
                for p in [b, c] {
                    // Stretched by the surface, but never reversed: a map on it is not mirrored.
                    let (along_t, along_b) = (edge(p).dot(t), edge(p).dot(n.cross(t)));
                    assert!(along_t * step(p).x > -2e-3, "{kind:?} {a:?} {p:?}");
                    assert!(along_b * -step(p).y > -2e-3, "{kind:?} {a:?} {p:?}");
                }
                assert!(edge(b).cross(edge(c)).dot(n) > 0.0, "{kind:?}: a triangle faces inward");
            }
        }
    }

    #[test]
    fn areas_come_close_to_those_of_the_true_surfaces() {
        let area = |kind: ShapeKind| -> f32 {
            let twice = |[a, b, c]: [&Vertex; 3]| {
                let [a, b, c] = [a, b, c].map(|p| Vec3::from(p.position));
                (b - a).cross(c - a).length()
            };
            kind.mesh().triangles().map(twice).sum::<f32>() / 2.0
        };
        assert!((area(ShapeKind::Plane) - 4.0).abs() < 1e-6);
        assert!((area(ShapeKind::Sphere) / (4.0 * PI) - 1.0).abs() < 1e-3);
        assert!((area(ShapeKind::Torus) / (TAU * TAU * TORUS_RADIUS * TUBE_RADIUS) - 1.0).abs() < 1e-3);
    }
}
