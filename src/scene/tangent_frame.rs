//! Tangent frames of a mesh's vertices: which rule makes them, and the standard one.
//!
//! MikkTSpace (M. S. Mikkelsen, *Simulation of Wrinkled Surfaces Revisited*, 2008, section 3.3, as he published it
//! later) is what most tools bake normal maps for. It wants texture coordinates with v up.

use std::collections::HashMap;
use std::fmt;
use std::str::FromStr;

use bevy_mikktspace::{Geometry, TangentSpace, generate_tangents};
use glam::Vec3;

use super::mesh::{Mesh, Vertex};
use super::soup::Soup;
use super::{file_tangents, frame_groups};

/// Which rule makes a mesh's frames. Written `file`, `mikktspace`, `grouped` or `grouped:DEGREES`.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(try_from = "String", into = "String")]
pub enum FrameRule {
    /// Those that the file brings, as glTF may; MikkTSpace's where it brings none, as glTF asks for.
    #[default]
    File,
    /// MikkTSpace, the standard.
    MikkTSpace,
    /// Groups by the thesis's four rules; derivatives further apart than the threshold are not averaged.
    Grouped {
        /// In degrees, up to 180, which is none.
        threshold_deg: f32,
    },
}

/// A name that is no rule's.
#[derive(Clone, Debug, thiserror::Error, PartialEq, Eq)]
#[error("'{0}' is no rule for frames: write file, mikktspace, grouped or grouped:DEGREES with 0 to 180 degrees")]
pub struct ParseFrameRuleError(String);

impl FromStr for FrameRule {
    type Err = ParseFrameRuleError;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let degrees = |text: &str| text.parse().ok().filter(|degrees| (0.0..=180.0).contains(degrees));
        let threshold = match text {
            "file" => return Ok(Self::File),
            "mikktspace" => return Ok(Self::MikkTSpace),
            "grouped" => Some(180.0),
            _ => text.strip_prefix("grouped:").and_then(degrees),
        };
        let rule = threshold.map(|threshold_deg| Self::Grouped { threshold_deg });
        rule.ok_or_else(|| ParseFrameRuleError(text.to_owned()))
    }
}

impl TryFrom<String> for FrameRule {
    type Error = ParseFrameRuleError;

    fn try_from(text: String) -> Result<Self, Self::Error> {
        text.parse()
    }
}

impl From<FrameRule> for String {
    fn from(rule: FrameRule) -> Self {
        rule.to_string()
    }
}

impl fmt::Display for FrameRule {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::File => formatter.write_str("file"),
            Self::MikkTSpace => formatter.write_str("mikktspace"),
            Self::Grouped { threshold_deg } => write!(formatter, "grouped:{threshold_deg}"),
        }
    }
}

impl FrameRule {
    /// The mesh of a soup of triangles with this rule's frames.
    pub fn mesh(self, soup: &Soup) -> Mesh {
        match self {
            Self::File => file_tangents::of_file(soup),
            Self::MikkTSpace => mikktspace(soup),
            Self::Grouped { threshold_deg } => frame_groups::grouped(soup, threshold_deg),
        }
    }
}

/// A corner's frame: what a vertex is made of beside the soup.
#[derive(Clone, Copy, Debug)]
pub(super) struct CornerFrame {
    /// Along growing u, of any length.
    pub tangent: Vec3,
    /// How far the surface goes per unit of u and of v.
    pub lengths: [f32; 2],
    /// 1, or -1 where the texture is mirrored.
    pub orientation: f32,
}

impl From<TangentSpace> for CornerFrame {
    fn from(frame: TangentSpace) -> Self {
        Self {
            tangent: frame.tangent().into(),
            lengths: [frame.tangent_magnitude(), frame.bi_tangent_magnitude()],
            orientation: if frame.is_orientation_preserving() { 1.0 } else { -1.0 },
        }
    }
}

/// The mesh of a soup of triangles with MikkTSpace's frames; equal corners share a vertex.
pub fn mikktspace(soup: &Soup) -> Mesh {
    let corners = soup.triangles.iter().flatten();
    welded(corners.zip(mikktspace_frames(soup)).map(|(&index, frame)| vertex(soup, index, frame)))
}

/// MikkTSpace's frame of every corner, triangle by triangle; none where the texture has no direction.
pub(super) fn mikktspace_frames(soup: &Soup) -> Vec<Option<CornerFrame>> {
    let mut frames = Frames { soup, of_corners: vec![None; 3 * soup.triangles.len()] };
    if let Err(error) = generate_tangents(&mut frames) {
        // The library knows no error yet; corners without a frame get any.
        log::warn!("no tangent frames: {error}");
    }
    frames.of_corners.into_iter().map(|frame| frame.map(CornerFrame::from)).collect()
}

struct Frames<'a> {
    soup: &'a Soup,
    of_corners: Vec<Option<TangentSpace>>,
}

impl Frames<'_> {
    fn corner(&self, face: usize, corner: usize) -> usize {
        self.soup.triangles[face][corner] as usize
    }
}

impl Geometry for Frames<'_> {
    fn num_faces(&self) -> usize {
        self.soup.triangles.len()
    }

    fn num_vertices_of_face(&self, _face: usize) -> usize {
        3
    }

    fn position(&self, face: usize, corner: usize) -> [f32; 3] {
        self.soup.positions[self.corner(face, corner)].to_array()
    }

    fn normal(&self, face: usize, corner: usize) -> [f32; 3] {
        self.soup.normals[self.corner(face, corner)].to_array()
    }

    fn tex_coord(&self, face: usize, corner: usize) -> [f32; 2] {
        let uv = self.soup.uvs[self.corner(face, corner)];
        [uv.x, 1.0 - uv.y]
    }

    fn set_tangent(&mut self, tangent_space: Option<TangentSpace>, face: usize, corner: usize) {
        self.of_corners[3 * face + corner] = tangent_space;
    }
}

/// A corner with its frame. The bitangent is `normal x tangent` with the sign of the orientation, as MikkTSpace and glTF
/// have it; without a frame the texture has no direction there and any will do.
pub(super) fn vertex(soup: &Soup, index: u32, frame: Option<CornerFrame>) -> Vertex {
    let index = index as usize;
    let normal = soup.normals[index];
    let any = CornerFrame { tangent: normal.any_orthonormal_vector(), lengths: [1.0; 2], orientation: 1.0 };
    let CornerFrame { tangent, lengths, orientation } = frame.unwrap_or(any);
    let tangent = tangent.normalize_or(any.tangent);
    let bitangent = orientation * normal.cross(tangent).normalize_or_zero();
    Vertex {
        position: soup.positions[index].to_array(),
        normal: normal.to_array(),
        along_u: tangent.extend(lengths[0]).to_array(),
        along_t: bitangent.extend(lengths[1]).to_array(),
        uv: soup.uvs[index].to_array(),
        bend: [0.0; 4],
    }
}

/// Three corners a triangle as a mesh in which equal ones share a vertex.
pub fn welded(corners: impl Iterator<Item = Vertex>) -> Mesh {
    let mut mesh = Mesh::default();
    let mut known = HashMap::new();
    for vertex in corners {
        let next = mesh.vertices.len() as u32;
        let index = *known.entry(bytemuck::cast::<Vertex, [u32; 20]>(vertex)).or_insert(next);
        if index == next {
            mesh.vertices.push(vertex);
        }
        mesh.indices.push(index);
    }
    mesh
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::mesh::Tangents;
    use crate::scene::soup::tests::mirrored_roof;
    use glam::Mat2;

    #[test]
    fn frames_on_both_sides_of_a_mirror_are_mirror_images() {
        let mesh = mikktspace(&mirrored_roof());
        let halfway_on = |side: f32| {
            let found = mesh.vertices.iter().filter(move |v| v.uv[0] == 0.5 && side * v.position[0] > 0.0);
            found.map(|v| (*v, v.tangents(Mat2::IDENTITY))).collect::<Vec<_>>()
        };
        let [left, right] = [halfway_on(-1.0), halfway_on(1.0)];
        assert!(!left.is_empty() && left.len() == right.len());
        for (vertex, Tangents { tangent, bitangent }) in left {
            let normal = Vec3::from(vertex.normal);
            assert!(normal.cross(tangent).dot(bitangent) > 0.99, "not mirrored here");
            let mirror = Vec3::new(-1.0, 1.0, 1.0);
            let twin = right.iter().any(|(other, frame)| {
                let alike = |a: Vec3, b: Vec3| (mirror * a - b).length() < 1e-5;
                alike(normal, other.normal.into())
                    && alike(tangent, frame.tangent)
                    && alike(bitangent, frame.bitangent)
                    && Vec3::from(other.normal).cross(frame.tangent).dot(frame.bitangent) < -0.99
            });
            assert!(twin, "{vertex:?} has no twin");
        }
    }

    #[test]
    fn a_rule_reads_back_as_it_is_written() {
        for rule in [FrameRule::File, FrameRule::MikkTSpace, FrameRule::Grouped { threshold_deg: 22.5 }] {
            assert_eq!(rule.to_string().parse(), Ok(rule));
        }
        assert!("grouped:200".parse::<FrameRule>().is_err() && "other".parse::<FrameRule>().is_err());
    }

    #[test]
    fn equal_corners_share_a_vertex_and_the_mirror_splits_its_line() {
        let soup = mirrored_roof();
        let mesh = mikktspace(&soup);
        assert_eq!(mesh.indices.len(), 3 * soup.triangles.len());
        // The vertices on the mirror's line carry a frame for either side.
        let on_the_line = soup.positions.iter().filter(|p| p.x.abs() < 1e-6).count();
        assert_eq!(mesh.vertices.len(), soup.positions.len() + on_the_line);
    }
}
