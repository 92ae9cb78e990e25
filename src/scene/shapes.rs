//! What wears the map: a parametric surface or a mesh from a file, and how the map lies on it.

use std::sync::{Arc, OnceLock};

use glam::{DMat2, DVec2, Mat2};

use super::bump::BumpRule;
use super::jet::Jet;
use super::mesh::{Mesh, Vertex};
use super::model::Model;
use super::reconstruction::Reconstruction;
use super::tangent_frame::FrameRule;
use super::{parametric, teapot};

/// Which surface wears the map.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ShapeKind {
    /// The square -1..1 in `z = 0`, facing `+z`.
    #[default]
    Plane,
    /// The unit sphere.
    Sphere,
    /// A torus around `z`.
    Torus,
    /// `z = x^3 - 3 x y^2` over a square.
    MonkeySaddle,
    /// The Utah teapot.
    Teapot,
    /// A mesh from a file.
    Mesh,
}

/// A surface and how the map lies on it.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(default)]
pub struct Shape {
    /// Which surface.
    pub kind: ShapeKind,
    /// Radii of the torus: of its ring, and of its tube.
    pub radii: [f32; 2],
    /// Repeats of the map along u and along v.
    pub tiling: [f32; 2],
    /// How far each row of the tiled map is shifted sideways, per unit of height.
    pub shear: f32,
    /// Degrees that the texture coordinates are turned by, counter-clockwise, so that the map turns the other way.
    pub turn_deg: f32,
    /// Whether the map is mirrored, left for right.
    pub mirrored: bool,
    /// The rule of a mesh's frames.
    pub frames: FrameRule,
    /// What is made of the corners' frames at a pixel between them.
    pub reconstruction: Reconstruction,
    /// How a map of heights bumps a parametric surface; without a rule its slopes count texels, on every surface alike.
    pub bump: Option<BumpRule>,
    /// What a height of 1 is then, in the surface's own units.
    pub bump_scale: f32,
    /// The mesh, where the kind asks for one; a session file names its path.
    #[serde(skip)]
    pub model: Option<Arc<Model>>,
}

impl Shape {
    /// The shape of a first start.
    pub const DEFAULT: Self = Self {
        kind: ShapeKind::Plane,
        radii: [0.75, 0.35],
        tiling: [2.0, 2.0],
        shear: 0.0,
        turn_deg: 0.0,
        mirrored: false,
        frames: FrameRule::File,
        reconstruction: Reconstruction::Orthonormal,
        bump: None,
        bump_scale: 0.0625,
        model: None,
    };
}

impl Default for Shape {
    fn default() -> Self {
        Self::DEFAULT
    }
}

/// How much of its own size the monkey saddle is drawn with: its heights reach from -2 to 2.
const SADDLE_SCALE: f64 = 0.45;

/// How near its poles a sphere's curvature is asked for.
const BESIDE_POLE: f64 = 1e-4;

impl ShapeKind {
    /// Every kind that needs no file, in the order they are offered.
    pub const BUILT_IN: [Self; 5] = [Self::Plane, Self::Sphere, Self::Torus, Self::MonkeySaddle, Self::Teapot];

    /// The name to show.
    pub fn label(self) -> &'static str {
        match self {
            Self::Plane => "Plane",
            Self::Sphere => "Sphere",
            Self::Torus => "Torus",
            Self::MonkeySaddle => "Monkey saddle",
            Self::Teapot => "Teapot",
            Self::Mesh => "Mesh",
        }
    }

    /// The name on the command line and in session files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Plane => "plane",
            Self::Sphere => "sphere",
            Self::Torus => "torus",
            Self::MonkeySaddle => "monkey-saddle",
            Self::Teapot => "teapot",
            Self::Mesh => "mesh",
        }
    }
}

impl Shape {
    /// A surface that needs no file, the map as on a first start.
    pub fn of_kind(kind: ShapeKind) -> Self {
        Self { kind, ..Self::default() }
    }

    /// The mesh of a file.
    pub fn of_model(model: Arc<Model>) -> Self {
        Self { kind: ShapeKind::Mesh, model: Some(model), ..Self::default() }
    }

    /// The surface to second order, in its own units, where it is one function of u and t.
    pub fn jet(&self, u: f64, t: f64) -> Option<Jet> {
        match self.kind {
            ShapeKind::Plane => Some(parametric::plane(u, t)),
            ShapeKind::Sphere => Some(parametric::sphere(u, t)),
            ShapeKind::Torus => Some(parametric::torus(self.radii.map(f64::from), u, t)),
            ShapeKind::MonkeySaddle => Some(parametric::monkey_saddle(u, t)),
            ShapeKind::Teapot | ShapeKind::Mesh => None,
        }
    }

    /// The rule by which a map of heights bumps the surface, where it is one function of u and t.
    pub fn bump_rule(&self) -> Option<BumpRule> {
        self.bump.filter(|_| self.jet(0.5, 0.5).is_some())
    }

    /// World units in one of the surface's own units.
    pub fn scale(&self) -> f64 {
        if self.kind == ShapeKind::MonkeySaddle { SADDLE_SCALE } else { 1.0 }
    }

    /// The surface as triangles, before its texture coordinates are turned and tiled. A mesh that is not read yet has
    /// none.
    pub fn mesh(&self) -> Arc<Mesh> {
        match (self.kind, &self.model) {
            (ShapeKind::Teapot, _) => {
                static TEAPOT: OnceLock<Arc<Mesh>> = OnceLock::new();
                Arc::clone(TEAPOT.get_or_init(|| Arc::new(teapot::mesh())))
            }
            (ShapeKind::Mesh, Some(model)) => model.mesh(self.frames),
            _ => Arc::new(self.parametric_mesh()),
        }
    }

    fn parametric_mesh(&self) -> Mesh {
        let [columns, rows] = match self.kind {
            ShapeKind::Plane => [1, 1],
            ShapeKind::MonkeySaddle => [128, 128],
            _ => [192, 96],
        };
        let vertex = |u: f64, v: f64| {
            let jet = self.jet(u, 1.0 - v).unwrap_or_default().scaled(self.scale());
            // At a pole there is no curvature by u; near it there is.
            let bends = self.jet(u, (1.0 - v).clamp(BESIDE_POLE, 1.0 - BESIDE_POLE)).unwrap_or_default();
            Vertex::of_jet(&jet, 1.0 - v, [u, v]).bent_as(&bends.scaled(self.scale()))
        };
        Mesh::over_unit_square(columns, rows, vertex)
    }

    /// True where both shapes have the same triangles; the map may lie on them differently.
    pub fn has_mesh_of(&self, other: &Self) -> bool {
        let same_radii = self.kind != ShapeKind::Torus || self.radii == other.radii;
        let same_model = self.kind != ShapeKind::Mesh || self.model == other.model && self.frames == other.frames;
        self.kind == other.kind && same_radii && same_model
    }

    /// Where the map is read, from the surface's own coordinates, t up in both: `(s, t) = R K S (u, t)` in Mikkelsen's
    /// order (2008, section 2.6.2), first tiled (and mirrored), then sheared, then turned. The origin is the top left.
    pub fn texture_from_surface(&self) -> DMat2 {
        let [across, down] = self.tiling.map(f64::from);
        let across = if self.mirrored { -across } else { across };
        let tile = DMat2::from_diagonal(DVec2::new(across, down));
        let shear = DMat2::from_cols(DVec2::X, DVec2::new(self.shear.into(), 1.0));
        DMat2::from_angle(f64::from(self.turn_deg).to_radians()) * shear * tile
    }

    /// The same for texture coordinates with v down.
    pub fn uv_from_surface(&self) -> Mat2 {
        let flip = DMat2::from_diagonal(DVec2::new(1.0, -1.0));
        (flip * self.texture_from_surface() * flip).as_mat2()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::mesh::Tangents;
    use glam::{Vec2, Vec3};
    use std::f32::consts::{PI, TAU};

    fn built_in() -> [Shape; 5] {
        ShapeKind::BUILT_IN.map(Shape::of_kind)
    }

    fn derivative(along: [f32; 4]) -> Vec3 {
        Vec3::new(along[0], along[1], along[2]) * along[3]
    }

    #[test]
    fn frames_lie_in_the_surface_and_are_right_handed() {
        for shape in built_in() {
            for vertex in &shape.mesh().vertices {
                let normal = Vec3::from(vertex.normal);
                let Tangents { tangent, bitangent } = vertex.tangents(Mat2::IDENTITY);
                for unit in [normal, tangent, bitangent] {
                    assert!((unit.length() - 1.0).abs() < 1e-5, "{:?} {vertex:?}", shape.kind);
                }
                assert!(tangent.dot(normal).abs() < 1e-5 && bitangent.dot(normal).abs() < 1e-5, "{vertex:?}");
                assert!(normal.cross(tangent).dot(bitangent) > 0.01, "{:?} {vertex:?}", shape.kind);
            }
        }
    }

    #[test]
    fn derivatives_are_what_the_mesh_does_from_vertex_to_vertex() {
        for shape in built_in() {
            let mesh = shape.mesh();
            for [a, b, c] in mesh.triangles() {
                let edge = |p: &Vertex| Vec3::from(p.position) - Vec3::from(a.position);
                assert!(edge(b).cross(edge(c)).dot(a.normal.into()) > 0.0, "{:?}: a triangle faces inward", shape.kind);
                for p in [b, c] {
                    let step = Vec2::from(p.uv) - Vec2::from(a.uv);
                    // The mean of both ends' derivatives is right to second order: a hundredth on the coarsest mesh,
                    // more where a patch of the teapot shrinks to its pole.
                    let along_u = 0.5 * (derivative(a.along_u) + derivative(p.along_u));
                    let along_t = 0.5 * (derivative(a.along_t) + derivative(p.along_t));
                    let error = (step.x * along_u - step.y * along_t - edge(p)).length();
                    assert!(error < 0.02 * edge(p).length() + 1e-3, "{:?} {a:?} {p:?}: {error}", shape.kind);
                }
            }
        }
    }

    #[test]
    fn areas_come_close_to_those_of_the_true_surfaces() {
        let area = |shape: Shape| -> f32 {
            let twice = |[a, b, c]: [&Vertex; 3]| {
                let [a, b, c] = [a, b, c].map(|p| Vec3::from(p.position));
                (b - a).cross(c - a).length()
            };
            shape.mesh().triangles().map(twice).sum::<f32>() / 2.0
        };
        assert!((area(Shape::of_kind(ShapeKind::Plane)) - 4.0).abs() < 1e-6);
        assert!((area(Shape::of_kind(ShapeKind::Sphere)) / (4.0 * PI) - 1.0).abs() < 1e-3);
        for radii in [[0.75, 0.35], [0.9, 0.1]] {
            let torus = Shape { radii, ..Shape::of_kind(ShapeKind::Torus) };
            assert!((area(torus) / (TAU * TAU * radii[0] * radii[1]) - 1.0).abs() < 1e-3);
        }
    }

    #[test]
    fn tangents_follow_the_rows_of_a_map_that_is_tiled_sheared_turned_and_mirrored() {
        let torus = Shape::of_kind(ShapeKind::Torus);
        let changed = [
            Shape { tiling: [12.0, 4.0], ..torus.clone() },
            Shape { tiling: [12.0, 4.0], shear: 0.4, ..torus.clone() },
            Shape { tiling: [12.0, 4.0], turn_deg: 30.0, ..torus.clone() },
            Shape { tiling: [12.0, 4.0], turn_deg: 30.0, mirrored: true, ..torus },
        ];
        for shape in changed {
            let uv_from_surface = shape.uv_from_surface();
            let step = 1e-4;
            for vertex in shape.mesh().vertices.iter().step_by(577) {
                let Tangents { tangent, bitangent } = vertex.tangents(uv_from_surface);
                let [u, v] = vertex.uv.map(f64::from);
                // One small step along a row of the map, found by inverting where the map is read.
                let moved = |along: Vec2| {
                    let surface_step = (uv_from_surface.inverse() * along).as_dvec2();
                    let place = |sign: f64| {
                        let at = sign * step * surface_step;
                        shape.jet(u + at.x, 1.0 - v - at.y).expect("parametric").position
                    };
                    (place(1.0) - place(-1.0)).as_vec3().normalize()
                };
                assert!((tangent - moved(Vec2::X)).length() < 1e-3, "{shape:?}");
                assert!((bitangent - moved(Vec2::NEG_Y)).length() < 1e-3, "{shape:?}");
                let handedness = Vec3::from(vertex.normal).cross(tangent).dot(bitangent);
                assert_eq!(handedness < 0.0, shape.mirrored, "{shape:?}");
            }
        }
    }

    #[test]
    fn a_turn_alone_turns_the_map_clockwise_on_the_plane() {
        let plane = Shape { tiling: [1.0, 1.0], turn_deg: 30.0, ..Shape::default() };
        let Tangents { tangent, .. } = plane.mesh().vertices[0].tangents(plane.uv_from_surface());
        // Mikkelsen, figure 13(c): R turns the coordinates counter-clockwise, its inverse turns the map.
        let expected = Vec3::new(0.75_f32.sqrt(), -0.5, 0.0);
        assert!((tangent - expected).length() < 1e-6, "{tangent}");
    }
}
