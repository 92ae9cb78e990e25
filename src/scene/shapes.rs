//! The parametric surfaces: plane, sphere and torus.
//!
//! Each carries texture coordinates `u` right and `v` down, and an orthonormal frame per vertex whose tangent runs
//! along growing u and whose bitangent runs up the image, along falling v.

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
