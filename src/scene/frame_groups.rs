//! Tangent frames by groups of triangles, as M. S. Mikkelsen has them in *Simulation of Wrinkled Surfaces Revisited*
//! (2008), section 3.3.
//!
//! Around a vertex two triangles belong together where they share, at two vertices, position, normal and texture
//! coordinates, and where their textures have the same orientation: the sign of
//! `det T = (t2 - t1)_x (t3 - t1)_y - (t2 - t1)_y (t3 - t1)_x`. Connected ones form a group, whose frame at the vertex is
//! the mean of the triangles' derivatives (equations 42 and 43), each laid into the plane of the normal and made a unit
//! vector; their lengths have a mean of their own. An angular threshold narrows the mean of each triangle to those of
//! its group whose derivatives both lie within it. The sums are taken in an order of their own, so that nothing
//! depends on the order of the triangles.
//!
//! A triangle whose texture has no area has no derivatives: it stands alone, with any frame.

use std::collections::HashMap;

use glam::{DVec3, Vec2, Vec3};

use super::mesh::{Mesh, Vertex};
use super::soup::Soup;
use super::tangent_frame::welded;

/// A triangle's derivatives by its texture coordinates, t up; zero where the texture has no area.
#[derive(Clone, Copy, Debug)]
pub(super) struct Derivatives {
    s: DVec3,
    t: DVec3,
    preserves_orientation: bool,
}

impl Derivatives {
    /// How far the surface goes per unit of either coordinate.
    pub(super) fn lengths(&self) -> [f64; 2] {
        [self.s.length(), self.t.length()]
    }
}

/// What a triangle adds to the mean at a vertex: unit vectors in the normal's plane, and the derivatives' lengths.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Contribution {
    s: DVec3,
    t: DVec3,
    lengths: [f64; 2],
}

/// The mesh of a soup of triangles with frames by groups; derivatives further apart than the threshold are not averaged.
pub fn grouped(soup: &Soup, threshold_deg: f32) -> Mesh {
    let ids = shared_ids(soup);
    let derivatives: Vec<Derivatives> = soup.triangles.iter().map(|&corners| derivatives(soup, corners)).collect();
    let mut around: HashMap<u32, Vec<[usize; 2]>> = HashMap::new();
    for (triangle, corners) in soup.triangles.iter().enumerate() {
        for corner in 0..3 {
            around.entry(ids[corners[corner] as usize]).or_default().push([triangle, corner]);
        }
    }
    let mut vertices = vec![None; 3 * soup.triangles.len()];
    let least_cosine = f64::from(threshold_deg).to_radians().cos();
    for at_vertex in around.values() {
        for group in groups(soup, &ids, &derivatives, at_vertex) {
            let index = soup.triangles[group[0][0]][group[0][1]] as usize;
            let normal = soup.normals[index].as_dvec3();
            let members: Vec<Contribution> =
                group.iter().map(|[triangle, _]| contribution(&derivatives[*triangle], normal)).collect();
            for (&[triangle, corner], own) in group.iter().zip(&members) {
                let near = members.iter().filter(|other| is_within(own, other, least_cosine)).copied().collect();
                vertices[3 * triangle + corner] =
                    Some(vertex(soup, index, near, derivatives[triangle].preserves_orientation));
            }
        }
    }
    welded(vertices.into_iter().flatten())
}

/// The same number for vertices of the same position, normal and texture coordinates.
fn shared_ids(soup: &Soup) -> Vec<u32> {
    let mut known = HashMap::new();
    let key = |index: usize| {
        let (p, n, uv) = (soup.positions[index], soup.normals[index], soup.uvs[index]);
        // Adding zero makes one of the two zeros.
        [p.x, p.y, p.z, n.x, n.y, n.z, uv.x, uv.y].map(|value| (value + 0.0).to_bits())
    };
    (0..soup.positions.len() as u32).map(|index| *known.entry(key(index as usize)).or_insert(index)).collect()
}

/// A triangle's derivatives (equations 42 and 43).
pub(super) fn derivatives(soup: &Soup, corners: [u32; 3]) -> Derivatives {
    let [p1, p2, p3] = corners.map(|index| soup.positions[index as usize].as_dvec3());
    let up = |uv: Vec2| Vec2::new(uv.x, -uv.y).as_dvec2();
    let [t1, t2, t3] = corners.map(|index| up(soup.uvs[index as usize]));
    let (a, b) = (t2 - t1, t3 - t1);
    let determinant = a.perp_dot(b);
    if determinant == 0.0 {
        return Derivatives { s: DVec3::ZERO, t: DVec3::ZERO, preserves_orientation: true };
    }
    let (e, f) = (p2 - p1, p3 - p1);
    Derivatives {
        s: (b.y * e - a.y * f) / determinant,
        t: (a.x * f - b.x * e) / determinant,
        preserves_orientation: determinant > 0.0,
    }
}

/// The triangles around a vertex, each with the vertex's place in it, by groups.
fn groups(soup: &Soup, ids: &[u32], derivatives: &[Derivatives], around: &[[usize; 2]]) -> Vec<Vec<[usize; 2]>> {
    // The edges at the vertex are named by their other ends; an orientation has edges of its own.
    let mut group_of_edge: HashMap<(u32, bool), usize> = HashMap::new();
    let mut groups: Vec<Vec<[usize; 2]>> = Vec::new();
    for &[triangle, corner] in around {
        let Derivatives { s, preserves_orientation, .. } = derivatives[triangle];
        if s == DVec3::ZERO {
            groups.push(vec![[triangle, corner]]);
            continue;
        }
        let other = |step: usize| (ids[soup.triangles[triangle][(corner + step) % 3] as usize], preserves_orientation);
        let edges = [other(1), other(2)];
        let mut joined: Vec<usize> = edges.iter().filter_map(|edge| group_of_edge.get(edge).copied()).collect();
        joined.sort_unstable();
        joined.dedup();
        let target = joined.first().copied().unwrap_or(groups.len());
        if target == groups.len() {
            groups.push(Vec::new());
        }
        groups[target].push([triangle, corner]);
        for &absorbed in joined.iter().skip(1) {
            let moved = std::mem::take(&mut groups[absorbed]);
            groups[target].extend(moved);
            group_of_edge.values_mut().filter(|group| **group == absorbed).for_each(|group| *group = target);
        }
        group_of_edge.extend(edges.map(|edge| (edge, target)));
    }
    groups.retain(|group| !group.is_empty());
    groups
}

fn contribution(derivatives: &Derivatives, normal: DVec3) -> Contribution {
    let laid = |v: DVec3| (v - normal * normal.dot(v)).normalize_or_zero();
    Contribution { s: laid(derivatives.s), t: laid(derivatives.t), lengths: derivatives.lengths() }
}

fn is_within(a: &Contribution, b: &Contribution, least_cosine: f64) -> bool {
    a == b || a.s.dot(b.s) >= least_cosine && a.t.dot(b.t) >= least_cosine
}

/// The vertex whose frame is the mean of `contributions`.
fn vertex(soup: &Soup, index: usize, mut contributions: Vec<Contribution>, preserves_orientation: bool) -> Vertex {
    let key = |c: &Contribution| [c.s.to_array(), c.t.to_array(), [c.lengths[0], c.lengths[1], 0.0]].concat();
    contributions.sort_by(|a, b| {
        let pairs = key(a).into_iter().zip(key(b));
        pairs.map(|(a, b)| a.total_cmp(&b)).find(|order| order.is_ne()).unwrap_or(std::cmp::Ordering::Equal)
    });
    let mean = |value: fn(&Contribution) -> DVec3| contributions.iter().map(value).sum::<DVec3>();
    let length = |axis: usize| contributions.iter().map(|c| c.lengths[axis]).sum::<f64>() / contributions.len() as f64;
    let normal = soup.normals[index];
    let along_u = mean(|c| c.s).as_vec3().normalize_or(normal.any_orthonormal_vector());
    let orientation = if preserves_orientation { 1.0 } else { -1.0 };
    let across: Vec3 = orientation * normal.cross(along_u);
    Vertex {
        position: soup.positions[index].to_array(),
        normal: normal.to_array(),
        along_u: along_u.extend(length(0) as f32).to_array(),
        along_t: mean(|c| c.t).as_vec3().normalize_or(across).extend(length(1) as f32).to_array(),
        uv: soup.uvs[index].to_array(),
        bend: [0.0; 4],
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::mesh::Tangents;
    use crate::scene::soup::tests::mirrored_roof;
    use crate::scene::tangent_frame::mikktspace;
    use glam::Mat2;

    /// A dented sheet: neighbouring derivatives lie some degrees apart.
    fn dented() -> Soup {
        let mut soup = mirrored_roof();
        for (i, uv) in soup.uvs.iter_mut().enumerate() {
            let wobble = (i * i % 11) as f32 / 11.0 - 0.5;
            *uv += 0.06 * Vec2::new(wobble, -wobble);
        }
        soup
    }

    /// Every corner's vertex, by its triangle's corners, in no order that the mesh gives.
    fn corners(mesh: &Mesh) -> Vec<[[u32; 20]; 3]> {
        let mut all: Vec<[[u32; 20]; 3]> = mesh
            .triangles()
            .map(|corners| {
                let mut corners = corners.map(|vertex| bytemuck::cast::<Vertex, [u32; 20]>(*vertex));
                corners.sort_unstable();
                corners
            })
            .collect();
        all.sort_unstable();
        all
    }

    #[test]
    fn the_order_of_triangles_and_of_their_corners_changes_nothing() {
        let soup = dented();
        let mut shuffled = soup.clone();
        let count = shuffled.triangles.len();
        // A permutation without fixed rhythm; odd triangles begin with another corner.
        shuffled.triangles = (0..count).map(|i| soup.triangles[(i * 37 + 11) % count]).collect();
        shuffled.triangles.iter_mut().skip(1).step_by(2).for_each(|corners| corners.rotate_left(1));
        for threshold in [180.0, 25.0, 2.0] {
            let (one, other) = (grouped(&soup, threshold), grouped(&shuffled, threshold));
            assert!(corners(&one) == corners(&other), "{threshold} degrees");
        }
    }

    #[test]
    fn a_stricter_threshold_splits_more_and_none_splits_only_at_the_mirror() {
        let plain = grouped(&mirrored_roof(), 180.0);
        let on_the_mirror = mirrored_roof().positions.iter().filter(|p| p.x.abs() < 1e-6).count();
        assert_eq!(plain.splits(), on_the_mirror);
        let splits = [180.0, 5.0, 1.0].map(|threshold| grouped(&dented(), threshold).splits());
        println!("splits of the dented roof: {splits:?}");
        assert!(splits[0] < splits[1] && splits[1] < splits[2], "{splits:?}");
        assert_eq!(splits[0], on_the_mirror);
    }

    #[test]
    fn on_a_sound_mesh_the_groups_agree_with_mikktspace() {
        // Both average by group; MikkTSpace weighs by angle, the thesis does not.
        let soup = mirrored_roof();
        let [ours, standard] = [grouped(&soup, 180.0), mikktspace(&soup)];
        assert_eq!(ours.vertices.len(), standard.vertices.len());
        for ([a, ..], [b, ..]) in ours.triangles().zip(standard.triangles()) {
            let (a, b): (Tangents, Tangents) = (a.tangents(Mat2::IDENTITY), b.tangents(Mat2::IDENTITY));
            assert!(a.tangent.dot(b.tangent) > 0.999 && a.bitangent.dot(b.bitangent) > 0.999, "{a:?} {b:?}");
        }
    }

    #[test]
    fn a_texture_without_area_stands_alone_and_finite() {
        let mut soup = mirrored_roof();
        let [a, b, c] = soup.triangles[5].map(|index| index as usize);
        (soup.uvs[a], soup.uvs[b]) = (soup.uvs[c], soup.uvs[c]);
        let mesh = grouped(&soup, 45.0);
        let finite = |vertex: &Vertex| vertex.along_u.iter().chain(&vertex.along_t).all(|value| value.is_finite());
        assert!(mesh.vertices.iter().all(finite));
    }
}
