//! The frames that a file brings: a tangent of every vertex, and the side of its bitangent.
//!
//! glTF has them (Khronos 2021, section 3.7.2.1): a unit tangent along growing u, and w, 1 or -1, with
//! `bitangent = w (normal x tangent)` up the image. A map that was baked with them wants them back. How far the surface
//! goes per unit of texture, which a turned or sheared map needs, is the mean over the triangles around a vertex.

use super::frame_groups::derivatives;
use super::mesh::Mesh;
use super::soup::Soup;
use super::tangent_frame::{CornerFrame, mikktspace_frames, vertex, welded};

/// The mesh of a soup of triangles with its file's frames; MikkTSpace's where it brings none.
pub fn of_file(soup: &Soup) -> Mesh {
    let own = |index: u32| soup.tangents.get(index as usize).copied().filter(|tangent| tangent.w != 0.0);
    let corners = || soup.triangles.iter().flatten().copied();
    let lengths = if corners().any(|index| own(index).is_some()) { lengths(soup) } else { Vec::new() };
    let standard = if corners().any(|index| own(index).is_none()) { mikktspace_frames(soup) } else { Vec::new() };
    let frame = |(corner, index): (usize, u32)| match own(index) {
        Some(tangent) => Some(CornerFrame {
            tangent: tangent.truncate(),
            lengths: lengths[index as usize],
            orientation: tangent.w.signum(),
        }),
        None => standard[corner],
    };
    welded(corners().enumerate().map(|corner| vertex(soup, corner.1, frame(corner))))
}

/// Of every vertex the mean lengths of the derivatives around it; 1 where no texture has an area.
fn lengths(soup: &Soup) -> Vec<[f32; 2]> {
    let mut sums = vec![([0.0; 2], 0.0); soup.positions.len()];
    for &corners in &soup.triangles {
        let [s, t] = derivatives(soup, corners).lengths();
        for index in corners.map(|index| index as usize).into_iter().filter(|_| s > 0.0 && t > 0.0) {
            let ([along_u, along_t], count) = &mut sums[index];
            (*along_u, *along_t, *count) = (*along_u + s, *along_t + t, *count + 1.0);
        }
    }
    let mean =
        |([s, t], count): ([f64; 2], f64)| [s, t].map(|sum| if count > 0.0 { (sum / count) as f32 } else { 1.0 });
    sums.into_iter().map(mean).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::FrameRule;
    use crate::scene::mesh::Tangents;
    use crate::scene::soup::tests::mirrored_roof;
    use glam::{Mat2, Vec3, Vec4};

    /// The roof with tangents turned by an angle from what MikkTSpace finds; none of them for the right half.
    fn roof(turn: f32) -> Soup {
        let mut soup = mirrored_roof();
        soup.tangents = vec![Vec4::ZERO; soup.positions.len()];
        for [a, b, c] in FrameRule::MikkTSpace.mesh(&soup).triangles() {
            for vertex in [a, b, c].into_iter().filter(|_| [a, b, c].iter().all(|corner| corner.position[0] <= 1e-6)) {
                let [position, normal] = [vertex.position, vertex.normal].map(Vec3::from);
                let Tangents { tangent, bitangent } = vertex.tangents(Mat2::IDENTITY);
                let (sin, cos) = turn.sin_cos();
                let side = normal.cross(tangent).dot(bitangent).signum();
                let index = soup.positions.iter().position(|p| *p == position).expect("a vertex of the roof");
                soup.tangents[index] = (cos * tangent + sin * bitangent).extend(side);
            }
        }
        soup
    }

    #[test]
    fn what_a_file_brings_is_taken_and_the_rest_is_the_standards() {
        let soup = roof(0.3);
        let [own, standard] = [FrameRule::File, FrameRule::MikkTSpace].map(|rule| rule.mesh(&soup));
        let mut apart = [0, 0];
        for (own, standard) in own.triangles().flatten().zip(standard.triangles().flatten()) {
            let [a, b] = [own, standard].map(|vertex| vertex.tangents(Mat2::IDENTITY));
            let normal = Vec3::from(own.normal);
            let side = normal.cross(b.tangent).dot(b.bitangent).signum();
            let is_own = own.position[0] < -1e-6;
            let angle = if is_own { 0.3_f32 } else { 0.0 };
            if own.position[0].abs() > 1e-6 {
                let expected = angle.cos() * b.tangent + angle.sin() * b.bitangent;
                assert!((a.tangent - expected).length() < 1e-4, "{own:?}: {} for {expected}", a.tangent);
                assert!((a.bitangent - side * normal.cross(a.tangent)).length() < 1e-4, "{own:?}");
                apart[usize::from(is_own)] += 1;
            }
            // The mean of the triangles' lengths is near MikkTSpace's, which weighs by angle.
            assert!((own.along_u[3] / standard.along_u[3] - 1.0).abs() < 0.1, "{own:?} {standard:?}");
        }
        assert!(apart[0] > 20 && apart[1] > 20, "{apart:?}");
    }

    #[test]
    fn without_tangents_in_the_file_the_frames_are_mikktspaces() {
        let soup = mirrored_roof();
        assert_eq!(FrameRule::File.mesh(&soup), FrameRule::MikkTSpace.mesh(&soup));
    }
}
