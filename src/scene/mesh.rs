//! Triangle meshes, as the graphics adapter and the processor's rasteriser read them.

use glam::Vec3;

/// A corner of a triangle. The bitangent is `normal x tangent`, so every frame is right-handed.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct Vertex {
    /// Position in world space.
    pub position: [f32; 3],
    /// Unit tangent, along growing u.
    pub tangent: [f32; 3],
    /// Unit normal, outward.
    pub normal: [f32; 3],
    /// Texture coordinates in `0..=1`, before tiling.
    pub uv: [f32; 2],
}

impl Vertex {
    /// The vertex of a surface at `uv`, with its frame made orthonormal.
    pub fn new(position: Vec3, tangent: Vec3, normal: Vec3, uv: [f32; 2]) -> Self {
        let normal = normal.normalize_or(Vec3::Z);
        let tangent = tangent.reject_from_normalized(normal).normalize_or(normal.any_orthonormal_vector());
        Self { position: position.to_array(), tangent: tangent.to_array(), normal: normal.to_array(), uv }
    }
}

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
    pub fn over_unit_square(columns: u32, rows: u32, vertex: impl Fn(f32, f32) -> Vertex) -> Self {
        let along = |i: u32, count: u32| i as f32 / count as f32;
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

    /// The triangles, as three vertices each.
    pub fn triangles(&self) -> impl Iterator<Item = [&Vertex; 3]> {
        self.indices.chunks_exact(3).map(|corner| std::array::from_fn(|i| &self.vertices[corner[i] as usize]))
    }
}

fn has_area(vertices: &[Vertex], triangle: [u32; 3]) -> bool {
    let [a, b, c] = triangle.map(|index| Vec3::from(vertices[index as usize].position));
    (b - a).cross(c - a).length() > 1e-9
}
