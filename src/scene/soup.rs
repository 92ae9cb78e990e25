//! Triangles as a file has them, checked at the door: finite, with texture coordinates and some area, and brought to
//! where the camera looks.

use std::collections::HashMap;

use glam::{Vec2, Vec3, Vec4, Vec4Swizzles};

/// Checked triangles. Corners share a vertex where position, normal and texture coordinates are the same in the file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Soup {
    /// Positions, z up, within the unit sphere.
    pub positions: Vec<Vec3>,
    /// Unit normals.
    pub normals: Vec<Vec3>,
    /// Texture coordinates, v down.
    pub uvs: Vec<Vec2>,
    /// Tangents as a file has them, along growing u; the fourth component is the sign of `normal x tangent` up the image,
    /// 0 where a vertex has none.
    pub tangents: Vec<Vec4>,
    /// Three vertices each, counter-clockwise seen from outside.
    pub triangles: Vec<[u32; 3]>,
    /// Triangles without area that were left out.
    pub dropped: usize,
}

/// One piece of a file: vertices and triangles in the file's space, y up.
#[derive(Clone, Debug, Default)]
pub struct Part {
    /// Positions.
    pub positions: Vec<Vec3>,
    /// Normals of any length, one a vertex, or none at all.
    pub normals: Vec<Vec3>,
    /// Texture coordinates, v down.
    pub uvs: Vec<Vec2>,
    /// Tangents with the sign of `normal x tangent` up the image, one a vertex, or none at all.
    pub tangents: Vec<Vec4>,
    /// Three vertices each.
    pub triangles: Vec<[u32; 3]>,
}

/// What normals a file means that brings none.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MissingNormals {
    /// A smooth surface: the mean of the triangles around a position, each by its angle there.
    Smooth,
    /// Flat triangles.
    Flat,
}

/// What is wrong with triangles.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum SoupError {
    /// There is none.
    #[error("holds no triangles")]
    Empty,
    /// A vertex has no texture coordinates.
    #[error("has no texture coordinates, by which the map would lie on it")]
    NoTextureCoordinates,
    /// A position, normal or texture coordinate is infinite or not a number.
    #[error("holds {0} that are not finite")]
    NotFinite(&'static str),
    /// A triangle names a vertex that is not there.
    #[error("is damaged: a triangle names a vertex that is not there")]
    OutOfBounds,
    /// All triangles are points or lines.
    #[error("has no surface: none of its triangles has an area")]
    NoArea,
}

/// Twice the area below which a triangle of a mesh of radius 1 is a line or a point.
const LEAST_AREA: f32 = 1e-12;

impl Soup {
    /// Checks the parts of a file and brings them together.
    ///
    /// # Errors
    /// What is wrong with them.
    pub fn new(parts: Vec<Part>, missing: MissingNormals) -> Result<Self, SoupError> {
        let parts: Vec<Part> = parts.into_iter().filter(|part| !part.triangles.is_empty()).collect();
        if parts.is_empty() {
            return Err(SoupError::Empty);
        }
        parts.iter().try_for_each(Part::check)?;
        let [low, high] = bounds(&parts);
        let center = 0.5 * (low + high);
        let reach = parts.iter().flat_map(|part| &part.positions).map(|p| (*p - center).length()).fold(0.0, f32::max);
        if reach <= f32::MIN_POSITIVE || !reach.is_finite() {
            return Err(SoupError::NoArea);
        }
        let mut soup = Self::default();
        for mut part in parts {
            part.positions.iter_mut().for_each(|p| *p = z_up((*p - center) / reach));
            part.normals.iter_mut().for_each(|n| *n = z_up(*n));
            part.tangents.iter_mut().for_each(|t| *t = z_up(t.xyz()).extend(t.w));
            soup.dropped += part.drop_without_area();
            soup.append(part.with_normals(missing));
        }
        if soup.triangles.is_empty() { Err(SoupError::NoArea) } else { Ok(soup) }
    }

    fn append(&mut self, part: Part) {
        let first = self.positions.len() as u32;
        self.positions.extend(part.positions);
        self.normals.extend(part.normals);
        self.uvs.extend(part.uvs);
        self.tangents.extend(part.tangents);
        self.tangents.resize(self.positions.len(), Vec4::ZERO);
        self.triangles.extend(part.triangles.into_iter().map(|corners| corners.map(|index| first + index)));
    }
}

impl Part {
    fn check(&self) -> Result<(), SoupError> {
        let count = self.positions.len();
        if self.uvs.len() != count {
            return Err(SoupError::NoTextureCoordinates);
        }
        if self.triangles.iter().flatten().any(|&index| index as usize >= count) {
            return Err(SoupError::OutOfBounds);
        }
        let finite = [
            ("positions", self.positions.iter().all(|p| p.is_finite())),
            ("normals", self.normals.iter().all(|n| n.is_finite())),
            ("texture coordinates", self.uvs.iter().all(|uv| uv.is_finite())),
            ("tangents", self.tangents.iter().all(|t| t.is_finite())),
        ];
        finite.iter().find(|(_, is_finite)| !is_finite).map_or(Ok(()), |(what, _)| Err(SoupError::NotFinite(what)))
    }

    fn corners(&self, triangle: [u32; 3]) -> [Vec3; 3] {
        triangle.map(|index| self.positions[index as usize])
    }

    /// The vector perpendicular to a triangle whose length is twice its area.
    fn facing(&self, triangle: [u32; 3]) -> Vec3 {
        let [a, b, c] = self.corners(triangle);
        (b - a).cross(c - a)
    }

    /// Leaves out the triangles without area; how many there were.
    fn drop_without_area(&mut self) -> usize {
        let before = self.triangles.len();
        let mut triangles = std::mem::take(&mut self.triangles);
        triangles.retain(|&triangle| self.facing(triangle).length() > LEAST_AREA);
        self.triangles = triangles;
        before - self.triangles.len()
    }

    /// The part with a unit normal for every vertex.
    fn with_normals(mut self, missing: MissingNormals) -> Self {
        if self.normals.len() == self.positions.len() {
            self.normals.iter_mut().for_each(|normal| *normal = normal.normalize_or(Vec3::Z));
            return self;
        }
        match missing {
            MissingNormals::Flat => self.flat(),
            MissingNormals::Smooth => {
                self.normals = self.smooth_normals();
                self
            }
        }
    }

    /// Every triangle with vertices of its own, which have its normal; tangents of another normal mean nothing.
    fn flat(&self) -> Self {
        let mut flat = Self::default();
        for &triangle in &self.triangles {
            let first = flat.positions.len() as u32;
            flat.positions.extend(self.corners(triangle));
            flat.normals.extend([self.facing(triangle).normalize_or(Vec3::Z); 3]);
            flat.uvs.extend(triangle.map(|index| self.uvs[index as usize]));
            flat.triangles.push([first, first + 1, first + 2]);
        }
        flat
    }

    /// Of every vertex the mean direction of the triangles at its position, each weighted by its angle there.
    fn smooth_normals(&self) -> Vec<Vec3> {
        let key = |index: u32| (self.positions[index as usize] + 0.0).to_array().map(f32::to_bits);
        let mut sums: HashMap<[u32; 3], Vec3> = HashMap::new();
        for &triangle in &self.triangles {
            let (corners, facing) = (self.corners(triangle), self.facing(triangle).normalize_or_zero());
            for (i, &index) in triangle.iter().enumerate() {
                let [here, next, last] = [corners[i], corners[(i + 1) % 3], corners[(i + 2) % 3]];
                *sums.entry(key(index)).or_default() += (next - here).angle_between(last - here) * facing;
            }
        }
        let normal = |index| sums.get(&key(index)).map_or(Vec3::Z, |sum| sum.normalize_or(Vec3::Z));
        (0..self.positions.len() as u32).map(normal).collect()
    }
}

fn bounds(parts: &[Part]) -> [Vec3; 2] {
    let positions = parts.iter().flat_map(|part| &part.positions);
    positions.fold([Vec3::INFINITY, Vec3::NEG_INFINITY], |[low, high], &p| [low.min(p), high.max(p)])
}

/// From a space with y up and z to the front to one with z up and -y to the front.
fn z_up(v: Vec3) -> Vec3 {
    Vec3::new(v.x, -v.z, v.y)
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    /// A curved roof over x in -1..1 whose right half wears the left half's texture, mirrored.
    pub fn mirrored_roof() -> Soup {
        let (columns, rows) = (8_u32, 4_u32);
        let mut part = Part::default();
        for (row, column) in (0..=rows).flat_map(|row| (0..=columns).map(move |column| (row, column))) {
            let (x, z) = (column as f32 / columns as f32 * 2.0 - 1.0, row as f32 / rows as f32 * 2.0 - 1.0);
            part.positions.push(Vec3::new(x, -0.3 * x * x, z));
            part.normals.push(Vec3::new(0.6 * x, 1.0, 0.0));
            part.uvs.push(Vec2::new(1.0 - x.abs(), 0.5 + 0.5 * z));
        }
        for (row, column) in (0..rows).flat_map(|row| (0..columns).map(move |column| (row, column))) {
            let a = row * (columns + 1) + column;
            let (b, c, d) = (a + 1, a + columns + 1, a + columns + 2);
            // The diagonal is mirrored too.
            let both = if column < columns / 2 { [[a, c, d], [a, d, b]] } else { [[a, c, b], [b, c, d]] };
            part.triangles.extend(both);
        }
        Soup::new(vec![part], MissingNormals::Smooth).expect("a sound mesh")
    }

    fn triangle() -> Part {
        Part {
            positions: vec![Vec3::ZERO, Vec3::X, Vec3::NEG_Z],
            normals: Vec::new(),
            uvs: vec![Vec2::ZERO, Vec2::X, Vec2::Y],
            tangents: Vec::new(),
            triangles: vec![[0, 1, 2]],
        }
    }

    fn refused(part: Part) -> SoupError {
        Soup::new(vec![part], MissingNormals::Smooth).expect_err("not sound")
    }

    #[test]
    fn what_is_not_a_surface_with_texture_coordinates_is_refused() {
        assert_eq!(Soup::new(Vec::new(), MissingNormals::Flat), Err(SoupError::Empty));
        assert_eq!(refused(Part { uvs: Vec::new(), ..triangle() }), SoupError::NoTextureCoordinates);
        assert_eq!(refused(Part { triangles: vec![[0, 1, 3]], ..triangle() }), SoupError::OutOfBounds);
        assert_eq!(refused(Part { positions: vec![Vec3::X; 3], ..triangle() }), SoupError::NoArea);
        let line = vec![Vec3::ZERO, Vec3::X, 2.0 * Vec3::X];
        assert_eq!(refused(Part { positions: line, ..triangle() }), SoupError::NoArea);
        let broken = vec![Vec3::ZERO, Vec3::X, Vec3::NAN];
        assert_eq!(refused(Part { positions: broken, ..triangle() }), SoupError::NotFinite("positions"));
        let broken = vec![Vec2::ZERO, Vec2::X, Vec2::splat(f32::INFINITY)];
        assert_eq!(refused(Part { uvs: broken, ..triangle() }), SoupError::NotFinite("texture coordinates"));
    }

    #[test]
    fn triangles_without_area_are_left_out_and_counted() {
        let soup = Soup::new(vec![Part { triangles: vec![[0, 1, 2], [1, 1, 2]], ..triangle() }], MissingNormals::Flat);
        let soup = soup.expect("one triangle is sound");
        assert_eq!((soup.triangles.len(), soup.dropped), (1, 1));
    }

    #[test]
    fn a_mesh_is_centred_brought_to_the_unit_sphere_and_stood_up() {
        let far = triangle().positions.iter().map(|p| 1000.0 * *p + Vec3::splat(5e4)).collect();
        let soup = Soup::new(vec![Part { positions: far, ..triangle() }], MissingNormals::Flat).expect("sound");
        let reach = soup.positions.iter().map(|p| p.length()).fold(0.0, f32::max);
        assert!((reach - 1.0).abs() < 1e-3, "{reach}");
        // It faces up in the file, along y, and up in the world, along z.
        assert!((soup.normals[0] - Vec3::Z).length() < 1e-6);
    }

    #[test]
    fn missing_normals_are_smooth_across_seams_of_the_texture_or_flat() {
        let roof = mirrored_roof();
        // The same roof with every triangle's vertices its own, as an exporter splits them at seams.
        let corners: Vec<u32> = roof.triangles.iter().flatten().copied().collect();
        let at = |index: &u32| *index as usize;
        let positions: Vec<Vec3> = corners.iter().map(|i| roof.positions[at(i)]).collect();
        let part = Part {
            positions: positions.iter().map(|p| Vec3::new(p.x, p.z, -p.y)).collect(),
            uvs: corners.iter().map(|i| roof.uvs[at(i)]).collect(),
            triangles: (0..corners.len() as u32 / 3).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect(),
            normals: Vec::new(),
            tangents: Vec::new(),
        };
        let smooth = Soup::new(vec![part.clone()], MissingNormals::Smooth).expect("sound");
        let top = |soup: &Soup| {
            let on_top = (0..soup.positions.len()).filter(|&i| soup.positions[i].x.abs() < 1e-6);
            on_top.map(|i| soup.normals[i]).collect::<Vec<_>>()
        };
        // The ridge is symmetric: its smooth normal is straight up, a flat one leans to its side.
        assert!(top(&smooth).iter().all(|n| (*n - Vec3::Z).length() < 1e-3), "{:?}", top(&smooth));
        let flat = Soup::new(vec![part], MissingNormals::Flat).expect("sound");
        assert!(top(&flat).iter().all(|n| n.x.abs() > 0.03));
    }
}
