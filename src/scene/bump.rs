//! The normal of a bump-mapped surface: Blinn's, and the exact one of the displaced surface.
//!
//! A height `alpha(s, t)` along the outward normal n displaces the surface `chi(s, t) = sigma(Phi(s, t))`. Up to its
//! length the displaced surface's normal is
//! ```text
//! (N'^-1)^T M' (-alpha_s, -alpha_t, 1),   N' = [chi_s | chi_t | n],
//!
//!      | 1 + alpha z4     -alpha z3          0 |
//! M' = |   -alpha z2    1 + alpha z1         0 |     [z1 z2; z3 z4] = -J^-1 W J,   J = J(Phi),
//!      |       0              0            m33 |     m33 = (1 + alpha z1)(1 + alpha z4) - alpha^2 z2 z3,
//! ```
//! with W the Weingarten matrix; Blinn's approximation (1978) is `M' = I`. Both hold where Phi turns the orientation
//! round: n stays the surface's own. M. S. Mikkelsen, *Simulation of Wrinkled Surfaces Revisited* (2008), equations 21,
//! 24 and 25.
//!
//! Valid where the texture coordinates are a smooth, invertible map of the surface's, and the displacement stays within
//! the smaller radius of curvature; beyond it the displaced surface folds through itself.

use glam::{DMat2, DMat3, DVec2, DVec3};

use super::jet::Jet;

/// A height over the surface and its slopes by the texture coordinates, t up, in the surface's own units.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct HeightSample {
    /// `alpha`.
    pub height: f64,
    /// `(alpha_s, alpha_t)`.
    pub slope: DVec2,
}

impl HeightSample {
    /// The same relief, `scale` times as high.
    pub fn scaled(self, scale: f64) -> Self {
        Self { height: scale * self.height, slope: scale * self.slope }
    }
}

/// Which normal is taken.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum BumpRule {
    /// Blinn's: the height counts by its slopes alone.
    Blinn,
    /// That of the displaced surface.
    #[default]
    Exact,
}

/// The unit normal of a bump-mapped surface, outward. `texture_from_surface` is the Jacobian of the texture
/// coordinates `(s, t)` by the surface's `(u, t)`, of either orientation.
pub fn perturbed_normal(jet: &Jet, texture_from_surface: DMat2, sample: HeightSample, rule: BumpRule) -> DVec3 {
    let jacobian = texture_from_surface.inverse();
    let along = |column: DVec2| column.x * jet.u + column.y * jet.t;
    let frame = DMat3::from_cols(along(jacobian.x_axis), along(jacobian.y_axis), jet.normal());
    let slopes = (-sample.slope).extend(1.0);
    let corrected = match rule {
        BumpRule::Blinn => slopes,
        BumpRule::Exact => {
            let shape = -(texture_from_surface * jet.weingarten() * jacobian);
            correction(shape, sample.height) * slopes
        }
    };
    (frame.inverse().transpose() * corrected).normalize_or_zero()
}

/// A surface under a relief, interpolated to one pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bumped {
    /// `N' = [chi_s | chi_t | n]`, by Mikkelsen's three steps (section 3.4): n a unit vector, the derivatives in its
    /// plane and of the interpolated lengths.
    pub world_from_texture: DMat3,
    /// `-J^-1 W J`, whose elements are `[z1 z2; z3 z4]`.
    pub shape_operator: DMat2,
}

impl Bumped {
    /// From the interpolated tangent, bitangent and normal, the columns of a matrix, and the lengths of the derivatives.
    pub fn new(interpolated: DMat3, stretch: DVec2, shape_operator: DMat2) -> Self {
        let normal = interpolated.z_axis.normalize_or_zero();
        let laid = |v: DVec3| (v - normal * normal.dot(v)).normalize_or_zero();
        let [s, t] = [stretch.x * laid(interpolated.x_axis), stretch.y * laid(interpolated.y_axis)];
        Self { world_from_texture: DMat3::from_cols(s, t, normal), shape_operator }
    }

    /// Takes the normals of a map of heights to those of the bump-mapped surface, up to their length. `rise` is by how
    /// much slopes by texture coordinates, in world units, are steeper than those of the map, which count texels.
    pub fn world_from_map(&self, height: f64, rise: DVec2, rule: BumpRule) -> DMat3 {
        let correction = match rule {
            BumpRule::Blinn => DMat3::IDENTITY,
            BumpRule::Exact => correction(self.shape_operator, height),
        };
        self.world_from_texture.inverse().transpose() * correction * DMat3::from_diagonal(rise.extend(1.0))
    }
}

/// M' from `-J^-1 W J` and the height.
fn correction(shape: DMat2, height: f64) -> DMat3 {
    let (z1, z3) = (shape.x_axis.x, shape.x_axis.y);
    let (z2, z4) = (shape.y_axis.x, shape.y_axis.y);
    let stretch = (1.0 + height * z1) * (1.0 + height * z4) - height * height * z2 * z3;
    DMat3::from_cols(
        DVec3::new(1.0 + height * z4, -height * z2, 0.0),
        DVec3::new(-height * z3, 1.0 + height * z1, 0.0),
        DVec3::new(0.0, 0.0, stretch),
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Shape, ShapeKind};
    use proptest::prelude::*;

    /// A relief of two waves, by texture coordinates.
    fn relief(at: DVec2) -> HeightSample {
        let (a, b) = (2.0 * at.x + 0.7 * at.y, 1.3 * at.y - at.x);
        let slope = DVec2::new(2.0 * a.cos() + 0.5 * b.sin(), 0.7 * a.cos() - 0.65 * b.sin());
        HeightSample { height: 1.5 + a.sin() + 0.5 * b.cos(), slope }
    }

    /// The unit normal of the displaced surface by finite differences: no formula of curvature.
    fn displaced_normal(shape: &Shape, [u, t]: [f64; 2], texture_from_surface: DMat2, scale: f64) -> DVec3 {
        let point = |u: f64, t: f64| {
            let jet = shape.jet(u, t).expect("parametric");
            let sample = relief(texture_from_surface * DVec2::new(u, t)).scaled(scale);
            jet.position + sample.height * jet.normal()
        };
        let step = 1e-5;
        let along_u = point(u + step, t) - point(u - step, t);
        let along_t = point(u, t + step) - point(u, t - step);
        along_u.cross(along_t).normalize()
    }

    fn shapes() -> [Shape; 4] {
        let torus = |radii| Shape { radii, ..Shape::of_kind(ShapeKind::Torus) };
        let [sphere, saddle] = [ShapeKind::Sphere, ShapeKind::MonkeySaddle].map(Shape::of_kind);
        [sphere, saddle, torus([1.0, 0.3]), torus([0.75, 0.35])]
    }

    /// Tiled, sheared and turned, of either orientation.
    fn any_change() -> impl Strategy<Value = DMat2> {
        let numbers = (1.0..12.0_f64, 1.0..12.0_f64, -1.0..1.0_f64, -3.0..3.0_f64);
        (numbers, any::<bool>()).prop_map(|((a, b, shear, turn), mirrored)| {
            let across = if mirrored { -a } else { a };
            let tile = DMat2::from_cols(DVec2::new(across, 0.0), DVec2::new(0.0, b));
            DMat2::from_angle(turn) * DMat2::from_cols(DVec2::X, DVec2::new(shear, 1.0)) * tile
        })
    }

    fn angle(a: DVec3, b: DVec3) -> f64 {
        a.cross(b).length().atan2(a.dot(b))
    }

    proptest! {
        #[test]
        fn the_exact_normal_is_that_of_the_displaced_surface(
            change in any_change(), u in 0.05..0.95, t in 0.1..0.9, scale in 0.001..0.02, index in 0_usize..4,
        ) {
            let shape = &shapes()[index];
            let jet = shape.jet(u, t).expect("parametric");
            let sample = relief(change * DVec2::new(u, t)).scaled(scale);
            let exact = perturbed_normal(&jet, change, sample, BumpRule::Exact);
            let displaced = displaced_normal(shape, [u, t], change, scale);
            prop_assert!(angle(exact, displaced) < 1e-3, "{:?} at {u}, {t}: {}", shape.kind, angle(exact, displaced));
        }

        #[test]
        fn both_normals_agree_as_height_times_curvature_goes_to_zero(
            change in any_change(), u in 0.05..0.95, t in 0.1..0.9, index in 0_usize..4,
        ) {
            let jet = shapes()[index].jet(u, t).expect("parametric");
            let slopes = relief(change * DVec2::new(u, t)).slope.normalize_or_zero();
            let apart = |product: f64| {
                // The slopes stay, the height goes: only the product with the curvature is left to differ by.
                let sample = HeightSample { height: product / jet.max_curvature().max(1e-9), slope: slopes };
                let [blinn, exact] =
                    [BumpRule::Blinn, BumpRule::Exact].map(|rule| perturbed_normal(&jet, change, sample, rule));
                angle(blinn, exact)
            };
            // P S P^T (equation 26) stretches directions by at most (1 + k)^2: the angle is within about 2 k.
            for product in [1e-1, 1e-2, 1e-3] {
                prop_assert!(apart(product) < 3.0 * product, "{product}: {}", apart(product));
            }
        }
    }

    #[test]
    fn at_a_fold_of_the_relief_both_normals_are_the_surfaces_own() {
        let jet = Shape::of_kind(ShapeKind::Torus).jet(0.3, 0.4).expect("parametric");
        let sample = HeightSample { height: 0.1, slope: DVec2::ZERO };
        for rule in [BumpRule::Blinn, BumpRule::Exact] {
            let normal = perturbed_normal(&jet, DMat2::IDENTITY, sample, rule);
            assert!((normal - jet.normal()).length() < 1e-12, "{rule:?}");
        }
    }

    #[test]
    fn on_a_plane_blinn_is_exact_at_any_height() {
        let jet = Shape::of_kind(ShapeKind::Plane).jet(0.3, 0.4).expect("parametric");
        let sample = HeightSample { height: 50.0, slope: DVec2::new(2.0, -1.0) };
        let [blinn, exact] =
            [BumpRule::Blinn, BumpRule::Exact].map(|rule| perturbed_normal(&jet, DMat2::IDENTITY, sample, rule));
        assert!((blinn - exact).length() < 1e-12);
    }

    #[test]
    fn a_thin_tube_under_a_high_relief_sets_them_apart() {
        // Mikkelsen, figure 11(d): b = 1/10 and a quarter as scale, twice the tube's radius.
        let torus = Shape { radii: [1.0, 0.1], ..Shape::of_kind(ShapeKind::Torus) };
        let jet = torus.jet(0.3, 0.4).expect("parametric");
        let sample = HeightSample { height: 0.2, slope: DVec2::new(1.0, 1.0) };
        let [blinn, exact] =
            [BumpRule::Blinn, BumpRule::Exact].map(|rule| perturbed_normal(&jet, DMat2::IDENTITY, sample, rule));
        assert!(angle(blinn, exact) > 0.2, "{}", angle(blinn, exact));
    }
}
