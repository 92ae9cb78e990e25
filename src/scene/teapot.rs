//! The Utah teapot: M. Newell's 32 bicubic Bezier patches (1975), from the control points of his drawing.
//!
//! Lid, rim, body and bottom are six profiles, each turned around the axis in four quarters; handle and spout are two
//! halves of two patches, one half the mirror image of the other. Texture coordinates go on smoothly from patch to
//! patch (Mikkelsen 2008, equation 47): every patch takes a quarter of u and a sixth of v; on the turned parts u runs
//! eastwards around the axis and v down from the knob, on handle and spout u runs around the tube and v along it.

use glam::{DVec2, DVec3};

use super::jet::Jet;
use super::mesh::{Mesh, Vertex};

/// A bicubic patch: rows of control points along u, row by row along t.
type Patch = [[DVec3; 4]; 4];

/// Quads along each side of a patch.
const SIDE: u32 = 20;

/// The profiles from the knob down to the middle of the bottom: distance from the axis and height.
const PROFILES: [[[f64; 2]; 4]; 6] = [
    [[0.0, 3.15], [0.8, 3.15], [0.0, 2.85], [0.2, 2.7]],
    [[0.2, 2.7], [0.4, 2.55], [1.3, 2.55], [1.3, 2.4]],
    [[1.4, 2.4], [1.3375, 2.53125], [1.4375, 2.53125], [1.5, 2.4]],
    [[1.5, 2.4], [1.75, 1.875], [2.0, 1.35], [2.0, 0.9]],
    [[2.0, 0.9], [2.0, 0.45], [1.5, 0.225], [1.5, 0.15]],
    [[1.5, 0.15], [1.5, 0.075], [1.425, 0.0], [0.0, 0.0]],
];

/// How far along the tangent, in radii, a quarter circle's inner control points lie.
const QUARTER: f64 = 0.56;
/// The same of the knob, whose points Newell rounded another way.
const KNOB_QUARTER: f64 = 0.5625;

/// Half a tube: sections from one end to the other, each from the middle line's one side to its other by way of `-y`.
type Tube = [[[f64; 3]; 4]; 7];

/// The handle from its upper end to the lower one.
const HANDLE: Tube = [
    [[-1.6, 0.0, 2.025], [-1.6, -0.3, 2.025], [-1.5, -0.3, 2.25], [-1.5, 0.0, 2.25]],
    [[-2.3, 0.0, 2.025], [-2.3, -0.3, 2.025], [-2.5, -0.3, 2.25], [-2.5, 0.0, 2.25]],
    [[-2.7, 0.0, 2.025], [-2.7, -0.3, 2.025], [-3.0, -0.3, 2.25], [-3.0, 0.0, 2.25]],
    [[-2.7, 0.0, 1.8], [-2.7, -0.3, 1.8], [-3.0, -0.3, 1.8], [-3.0, 0.0, 1.8]],
    [[-2.7, 0.0, 1.575], [-2.7, -0.3, 1.575], [-3.0, -0.3, 1.35], [-3.0, 0.0, 1.35]],
    [[-2.5, 0.0, 1.125], [-2.5, -0.3, 1.125], [-2.65, -0.3, 0.9375], [-2.65, 0.0, 0.9375]],
    [[-2.0, 0.0, 0.9], [-2.0, -0.3, 0.9], [-1.9, -0.3, 0.6], [-1.9, 0.0, 0.6]],
];

/// The spout from the body to its mouth.
const SPOUT: Tube = [
    [[1.7, 0.0, 1.425], [1.7, -0.66, 1.425], [1.7, -0.66, 0.6], [1.7, 0.0, 0.6]],
    [[2.6, 0.0, 1.425], [2.6, -0.66, 1.425], [3.1, -0.66, 0.825], [3.1, 0.0, 0.825]],
    [[2.3, 0.0, 2.1], [2.3, -0.25, 2.1], [2.4, -0.25, 2.025], [2.4, 0.0, 2.025]],
    [[2.7, 0.0, 2.4], [2.7, -0.25, 2.4], [3.3, -0.25, 2.4], [3.3, 0.0, 2.4]],
    [[2.8, 0.0, 2.475], [2.8, -0.25, 2.475], [3.525, -0.25, 2.49375], [3.525, 0.0, 2.49375]],
    [[2.9, 0.0, 2.475], [2.9, -0.15, 2.475], [3.45, -0.15, 2.5125], [3.45, 0.0, 2.5125]],
    [[2.8, 0.0, 2.4], [2.8, -0.15, 2.4], [3.2, -0.15, 2.4], [3.2, 0.0, 2.4]],
];

/// The middle of the teapot, which is put at the origin.
const CENTER: DVec3 = DVec3::new(0.2625, 0.0, 1.575);
/// The teapot is drawn this many times as large, so that it is about as wide as the plane.
const SCALE: f64 = 0.31;

/// The teapot as triangles.
pub fn mesh() -> Mesh {
    let mut mesh = Mesh::default();
    for (patch, column, row) in patches() {
        mesh.append(Mesh::over_unit_square(SIDE, SIDE, |u, v| {
            let place = [(f64::from(column) + u) / 4.0, (f64::from(row) + v) / 6.0];
            let jet = bezier(&patch, u, 1.0 - v);
            let jet = Jet { position: jet.position - CENTER, ..jet }.scaled(SCALE);
            Vertex::of_jet(&by_the_whole(jet), 1.0 - v, place)
        }));
    }
    mesh
}

/// Derivatives by the whole teapot's coordinates, of which a patch has a quarter along u and a sixth along t.
fn by_the_whole(jet: Jet) -> Jet {
    Jet { u: 4.0 * jet.u, t: 6.0 * jet.t, uu: 16.0 * jet.uu, ut: 24.0 * jet.ut, tt: 36.0 * jet.tt, ..jet }
}

/// Every patch with its column and row in texture coordinates.
fn patches() -> Vec<(Patch, u32, u32)> {
    let mut patches = Vec::with_capacity(32);
    for (profile, row) in PROFILES.iter().zip(0..) {
        patches.extend((0..4).map(|quarter| (turned(profile, quarter), quarter, row)));
    }
    for tube in [&HANDLE, &SPOUT] {
        for (half, mirrored) in [(0, false), (1, true)] {
            // The tube runs along t, that is up: its first piece is the lower in texture coordinates.
            patches.push((tube_patch(tube, mirrored, 0), half, 1));
            patches.push((tube_patch(tube, mirrored, 3), half, 0));
        }
    }
    patches
}

/// A quarter turn of a profile, eastwards from the back, `+y`; the profile runs down, t up.
fn turned(profile: &[[f64; 2]; 4], quarter: u32) -> Patch {
    let (sin, cos) = (f64::from(quarter) * std::f64::consts::FRAC_PI_2).sin_cos();
    let (from, to) = (DVec2::new(-sin, cos), DVec2::new(-cos, -sin));
    std::array::from_fn(|j| {
        let [radius, height] = profile[3 - j];
        let inner = if [radius, height] == PROFILES[0][1] { KNOB_QUARTER } else { QUARTER };
        let directions = [from, from + inner * to, inner * from + to, to];
        directions.map(|direction| (radius * direction).extend(height))
    })
}

/// Four sections of a tube, `first` the first of them, or their mirror image.
fn tube_patch(tube: &Tube, mirrored: bool, first: usize) -> Patch {
    std::array::from_fn(|j| {
        let section = tube[first + j].map(DVec3::from);
        let reflected = |i: usize| section[3 - i] * DVec3::new(1.0, -1.0, 1.0);
        if mirrored { std::array::from_fn(reflected) } else { section }
    })
}

/// The Bernstein polynomials of degree 3 and their first and second derivatives.
fn bernstein(x: f64) -> [[f64; 4]; 3] {
    let y = 1.0 - x;
    [
        [y * y * y, 3.0 * x * y * y, 3.0 * x * x * y, x * x * x],
        [-3.0 * y * y, 3.0 * y * (y - 2.0 * x), 3.0 * x * (2.0 * y - x), 3.0 * x * x],
        [6.0 * y, 6.0 * (x - 2.0 * y), 6.0 * (y - 2.0 * x), 6.0 * x],
    ]
}

fn bezier(patch: &Patch, u: f64, t: f64) -> Jet {
    let (along_u, along_t) = (bernstein(u), bernstein(t));
    let sum = |du: usize, dt: usize| -> DVec3 {
        let row = |j: usize| (0..4).map(|i| along_u[du][i] * patch[j][i]).sum::<DVec3>();
        (0..4).map(|j| along_t[dt][j] * row(j)).sum()
    };
    Jet { position: sum(0, 0), u: sum(1, 0), t: sum(0, 1), uu: sum(2, 0), ut: sum(1, 1), tt: sum(0, 2) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    #[test]
    fn neighbouring_patches_meet_without_a_gap_and_with_one_normal() {
        let patches = patches();
        assert_eq!(patches.len(), 32);
        for quarter in 0..4_u32 {
            for row in 0..6_usize {
                let patch = |quarter: u32| &patches[4 * row + quarter as usize].0;
                let (here, next) = (bezier(patch(quarter), 1.0, 0.37), bezier(patch((quarter + 1) % 4), 0.0, 0.37));
                assert!((here.position - next.position).length() < 1e-12, "row {row}, quarter {quarter}");
                assert!((here.normal() - next.normal()).length() < 1e-12, "row {row}, quarter {quarter}");
            }
        }
        // The halves of handle and spout meet where y is 0.
        for tube in [&HANDLE, &SPOUT] {
            let [one, other] = [false, true].map(|mirrored| bezier(&tube_patch(tube, mirrored, 0), 0.0, 0.6));
            assert!(one.position.y.abs() < 1e-12 && other.position.y.abs() < 1e-12);
        }
    }

    #[test]
    fn normals_point_outward_everywhere_the_poles_too() {
        let mesh = mesh();
        for [a, b, c] in mesh.triangles() {
            let [p, q, r] = [a, b, c].map(|v| Vec3::from(v.position));
            let facing = (q - p).cross(r - p).normalize();
            for vertex in [a, b, c] {
                let normal = Vec3::from(vertex.normal);
                // A triangle spans a twentieth of a patch: its corners turn by far less than a right angle.
                assert!(facing.dot(normal) > 0.5, "{vertex:?}");
            }
        }
        let top = mesh.vertices.iter().max_by(|a, b| a.position[2].total_cmp(&b.position[2])).expect("vertices");
        assert!((Vec3::from(top.normal) - Vec3::Z).length() < 1e-5, "{top:?}");
    }

    #[test]
    fn the_bernstein_polynomials_sum_to_one_and_their_derivatives_to_nothing() {
        for x in [0.0, 0.2, 0.77, 1.0] {
            let sums = bernstein(x).map(|row| row.iter().sum::<f64>());
            assert!((sums[0] - 1.0).abs() < 1e-15 && sums[1].abs() < 1e-14 && sums[2].abs() < 1e-14, "{sums:?}");
        }
    }
}
