//! Triangle meshes, as the graphics adapter and the processor's rasteriser read them.

use glam::{Mat2, Vec2, Vec3};

use super::jet::Jet;

/// A corner of a triangle, with the surface's derivatives by its own texture coordinates.
///
/// Along t is up the image, against v. The two derivatives need not be perpendicular, and where the texture is mirrored
/// they make a left-handed frame with the normal.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct Vertex {
    /// Position in world space.
    pub position: [f32; 3],
    /// Unit normal, outward.
    pub normal: [f32; 3],
    /// Unit vector along growing u, and how far the surface goes per unit of u.
    pub along_u: [f32; 4],
    /// Unit vector up the image, and how far the surface goes per unit of v.
    pub along_t: [f32; 4],
    /// Texture coordinates, before they are turned and tiled; v runs down.
    pub uv: [f32; 2],
    /// The Weingarten matrix by the surface's own coordinates, t up, by columns; 0 where it is not known.
    pub bend: [f32; 4],
}

/// Which way the map lies at a vertex.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tangents {
    /// Unit tangent, along the map's rows.
    pub tangent: Vec3,
    /// Unit bitangent, up the map's columns; not always perpendicular to the tangent.
    pub bitangent: Vec3,
}

impl Vertex {
    /// The vertex of a smooth surface at height `t` of its parameters. Where rows shrink to a pole, the frame is the
    /// limit from within the surface.
    pub fn of_jet(jet: &Jet, t: f64, [u, v]: [f64; 2]) -> Self {
        let to_inside = if t > 0.5 { -1.0 } else { 1.0 };
        let is_pole = jet.u.length() < 1e-9 * jet.ut.length();
        let east = if is_pole { to_inside * jet.ut } else { jet.u };
        let normal = east.cross(jet.t).normalize_or(glam::DVec3::Z);
        let with_length = |direction: glam::DVec3, derivative: glam::DVec3| {
            direction.normalize_or(normal.any_orthonormal_vector()).extend(derivative.length()).as_vec4().to_array()
        };
        Self {
            position: jet.position.as_vec3().to_array(),
            normal: normal.as_vec3().to_array(),
            along_u: with_length(east, jet.u),
            along_t: with_length(jet.t, jet.t),
            uv: [u as f32, v as f32],
            bend: [0.0; 4],
        }
    }

    /// The same vertex of a surface that bends as `jet` does.
    pub fn bent_as(self, jet: &Jet) -> Self {
        let bend = jet.weingarten().as_mat2();
        Self { bend: if bend.is_finite() { bend.to_cols_array() } else { [0.0; 4] }, ..self }
    }

    /// How far the surface goes per unit of either coordinate of a map that is read at `uv_from_surface * uv`.
    pub fn stretch(&self, uv_from_surface: Mat2) -> Vec2 {
        let [[a, minus_c], [minus_b, d]] = uv_from_surface.to_cols_array_2d();
        let derivative = |along: [f32; 4]| Vec3::new(along[0], along[1], along[2]) * along[3].max(LEAST_DERIVATIVE);
        let (along_u, along_t) = (derivative(self.along_u), derivative(self.along_t));
        let lengths = [d * along_u + minus_c * along_t, minus_b * along_u + a * along_t].map(Vec3::length);
        Vec2::from_array(lengths) / uv_from_surface.determinant().abs()
    }

    /// `-A W A^-1`: how the surface bends by the coordinates of such a map, t up.
    pub fn shape_operator(&self, uv_from_surface: Mat2) -> Mat2 {
        let flip = Mat2::from_diagonal(Vec2::new(1.0, -1.0));
        let texture_from_surface = flip * uv_from_surface * flip;
        -(texture_from_surface * Mat2::from_cols_array(&self.bend) * texture_from_surface.inverse())
    }

    /// The frame of a map that is read at `uv_from_surface * uv`.
    ///
    /// With `(s, t) = A (u, t)`, the derivatives by the new coordinates are `[chi_s chi_t] = [sigma_u sigma_t] A^-1`
    /// (Mikkelsen 2008, section 2.4); v runs down, so two of A's elements change their sign. A mirroring A makes the
    /// frame left-handed; the normal stays outward.
    pub fn tangents(&self, uv_from_surface: Mat2) -> Tangents {
        let [[a, minus_c], [minus_b, d]] = uv_from_surface.to_cols_array_2d();
        let derivative = |along: [f32; 4]| Vec3::new(along[0], along[1], along[2]) * along[3].max(LEAST_DERIVATIVE);
        let (along_u, along_t) = (derivative(self.along_u), derivative(self.along_t));
        let orientation = if uv_from_surface.determinant() < 0.0 { -1.0 } else { 1.0 };
        Tangents {
            tangent: (orientation * (d * along_u + minus_c * along_t)).normalize_or_zero(),
            bitangent: (orientation * (minus_b * along_u + a * along_t)).normalize_or_zero(),
        }
    }
}

/// A derivative's length counts as this at least, so that a pole keeps its directions; the shader's too.
pub const LEAST_DERIVATIVE: f32 = 1e-6;

/// Vertices, and three indices a triangle, counter-clockwise seen from outside.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// The corners.
    pub vertices: Vec<Vertex>,
    /// Three a triangle.
    pub indices: Vec<u32>,
}

impl Mesh {
    /// The grid of `columns` by `rows` quads over `uv` in `0..=1`, whose vertices `vertex` places; triangles without
    /// area, as at a pole, are left out.
    pub fn over_unit_square(columns: u32, rows: u32, vertex: impl Fn(f64, f64) -> Vertex) -> Self {
        let along = |i: u32, count: u32| f64::from(i) / f64::from(count);
        let vertices: Vec<Vertex> = (0..=rows)
            .flat_map(|row| (0..=columns).map(move |column| (column, row)))
            .map(|(column, row)| vertex(along(column, columns), along(row, rows)))
            .collect();
        let at = |column: u32, row: u32| row * (columns + 1) + column;
        let mut indices = Vec::with_capacity((columns * rows * 6) as usize);
        for row in 0..rows {
            for column in 0..columns {
                let (a, b) = (at(column, row), at(column + 1, row));
                let (c, d) = (at(column, row + 1), at(column + 1, row + 1));
                for triangle in [[a, c, d], [a, d, b]] {
                    if has_area(&vertices, triangle) {
                        indices.extend(triangle);
                    }
                }
            }
        }
        Self { vertices, indices }
    }

    /// Adds another mesh's triangles.
    pub fn append(&mut self, other: Self) {
        let first = self.vertices.len() as u32;
        self.vertices.extend(other.vertices);
        self.indices.extend(other.indices.iter().map(|index| first + index));
    }

    /// The triangles, as three vertices each.
    pub fn triangles(&self) -> impl Iterator<Item = [&Vertex; 3]> {
        self.indices.chunks_exact(3).map(|corner| std::array::from_fn(|i| &self.vertices[corner[i] as usize]))
    }

    /// Vertices that differ from another in their frame alone: where textures meet that do not go on smoothly.
    pub fn splits(&self) -> usize {
        let place = |vertex: &Vertex| {
            bytemuck::cast::<Vertex, [u32; 20]>(Vertex { along_u: [0.0; 4], along_t: [0.0; 4], ..*vertex })
        };
        let places: std::collections::HashSet<_> = self.vertices.iter().map(place).collect();
        self.vertices.len() - places.len()
    }

    /// Position and normal of the first point that has these texture coordinates, if any has.
    pub fn point_at(&self, uv: Vec2) -> Option<[Vec3; 2]> {
        self.triangles().find_map(|corners| {
            let weights = barycentric(corners.map(|corner| corner.uv.into()), uv)?;
            let blend = |value: fn(&Vertex) -> [f32; 3]| -> Vec3 {
                corners.iter().zip(weights).map(|(corner, weight)| weight * Vec3::from(value(corner))).sum()
            };
            Some([blend(|corner| corner.position), blend(|corner| corner.normal).normalize_or_zero()])
        })
    }
}

fn has_area(vertices: &[Vertex], triangle: [u32; 3]) -> bool {
    let [a, b, c] = triangle.map(|index| Vec3::from(vertices[index as usize].position));
    (b - a).cross(c - a).length() > 1e-9
}

/// The weights of a triangle's corners at a point inside it.
fn barycentric([a, b, c]: [Vec2; 3], point: Vec2) -> Option<[f32; 3]> {
    let whole = (b - a).perp_dot(c - a);
    let weights = [(b - point).perp_dot(c - point), (c - point).perp_dot(a - point), (a - point).perp_dot(b - point)];
    let weights = weights.map(|part| part / whole);
    // A zero area makes NaN, which is not inside either.
    weights.iter().all(|weight| *weight >= 0.0).then_some(weights)
}
