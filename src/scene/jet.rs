//! A surface to second order at one point: what bump mapping and curvature are made of.
//!
//! `sigma(u, t)` runs along u rightwards and along t up the image. With the unit normal `n` along
//! `sigma_u x sigma_t`, the fundamental forms are `E = sigma_u . sigma_u`, `F`, `G` and `e = sigma_uu . n`, `f`, `g`;
//! the Weingarten matrix is `W = [E F; F G]^-1 [e f; f g]`, and its eigenvalues are the principal curvatures. After
//! M. S. Mikkelsen, *Simulation of Wrinkled Surfaces Revisited* (2008), sections 2.3 and 2.4.
//!
//! Valid where `sigma_u` and `sigma_t` are independent; at the poles of a surface the frame is a limit, and W has no
//! meaning.

use glam::{DMat2, DVec2, DVec3};

/// The point and its derivatives, in the surface's own units.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Jet {
    /// `sigma`.
    pub position: DVec3,
    /// `sigma_u`.
    pub u: DVec3,
    /// `sigma_t`.
    pub t: DVec3,
    /// `sigma_uu`.
    pub uu: DVec3,
    /// `sigma_ut`.
    pub ut: DVec3,
    /// `sigma_tt`.
    pub tt: DVec3,
}

impl Jet {
    /// The unit normal, outward; zero where the derivatives are dependent.
    pub fn normal(&self) -> DVec3 {
        self.u.cross(self.t).normalize_or_zero()
    }

    /// The Weingarten matrix W, taken as acting on `(du, dt)`.
    pub fn weingarten(&self) -> DMat2 {
        let normal = self.normal();
        let symmetric = |a: f64, b: f64, c: f64| DMat2::from_cols(DVec2::new(a, b), DVec2::new(b, c));
        let first = symmetric(self.u.dot(self.u), self.u.dot(self.t), self.t.dot(self.t));
        let second = symmetric(self.uu.dot(normal), self.ut.dot(normal), self.tt.dot(normal));
        first.inverse() * second
    }

    /// The principal curvatures, the larger first: per unit of length, positive where the surface bends towards its
    /// normal.
    pub fn principal_curvatures(&self) -> [f64; 2] {
        let w = self.weingarten();
        let (mean, gauss) = (0.5 * (w.x_axis.x + w.y_axis.y), w.determinant());
        let half_difference = (mean * mean - gauss).max(0.0).sqrt();
        [mean + half_difference, mean - half_difference]
    }

    /// The larger of the principal curvatures' magnitudes.
    pub fn max_curvature(&self) -> f64 {
        let [a, b] = self.principal_curvatures();
        a.abs().max(b.abs())
    }

    /// The same surface, `factor` times as large.
    pub fn scaled(&self, factor: f64) -> Self {
        let by = |v: DVec3| factor * v;
        Self {
            position: by(self.position),
            u: by(self.u),
            t: by(self.t),
            uu: by(self.uu),
            ut: by(self.ut),
            tt: by(self.tt),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::parametric::{monkey_saddle, sphere, torus};

    #[test]
    fn derivatives_are_those_of_finite_differences() {
        type Parametric = fn(f64, f64) -> Jet;
        let surfaces: [(&str, Parametric); 3] =
            [("sphere", sphere), ("torus", |u, t| torus([0.75, 0.35], u, t)), ("monkey saddle", monkey_saddle)];
        let step = 1e-5;
        for (name, surface) in surfaces {
            for (u, t) in [(0.3, 0.6), (0.71, 0.2), (0.05, 0.9)] {
                let jet = surface(u, t);
                let along_u = |value: fn(&Jet) -> DVec3| {
                    (value(&surface(u + step, t)) - value(&surface(u - step, t))) / (2.0 * step)
                };
                let along_t = |value: fn(&Jet) -> DVec3| {
                    (value(&surface(u, t + step)) - value(&surface(u, t - step))) / (2.0 * step)
                };
                // The error of a central difference is a sixth of the third derivative times the step squared.
                let close = |a: DVec3, b: DVec3| (a - b).length() < 1e-7;
                assert!(close(jet.u, along_u(|j| j.position)) && close(jet.t, along_t(|j| j.position)), "{name}");
                assert!(close(jet.uu, along_u(|j| j.u)) && close(jet.tt, along_t(|j| j.t)), "{name}");
                assert!(close(jet.ut, along_t(|j| j.u)) && close(jet.ut, along_u(|j| j.t)), "{name}");
            }
        }
    }

    #[test]
    fn a_sphere_bends_alike_everywhere_and_away_from_its_normal() {
        for (u, t) in [(0.1, 0.5), (0.6, 0.1), (0.9, 0.95)] {
            let [a, b] = sphere(u, t).principal_curvatures();
            // Two equal roots are as far apart as the square root of a rounding.
            assert!((a + 1.0).abs() < 1e-7 && (b + 1.0).abs() < 1e-7, "{a} {b}");
            let half = sphere(u, t).scaled(0.5);
            assert!((half.max_curvature() - 2.0).abs() < 1e-7);
        }
    }

    #[test]
    fn a_torus_of_a_thin_tube_has_the_tubes_curvature_everywhere() {
        // Mikkelsen, section 2.6.2: kappa_max = 1/b where b < a/2; else 1/(a - b) on the inside.
        let largest = |radii: [f64; 2]| {
            let at = |i: u32, j: u32| torus(radii, f64::from(i) / 40.0, f64::from(j) / 40.0).max_curvature();
            let all = (0..40).flat_map(|i| (0..40).map(move |j| at(i, j)));
            all.fold([f64::INFINITY, 0.0_f64], |[low, high], k| [low.min(k), high.max(k)])
        };
        for (radii, kappa) in [([1.0, 0.3], 1.0 / 0.3), ([1.0, 0.1], 10.0)] {
            assert!(largest(radii).iter().all(|k| (k - kappa).abs() < 1e-9), "{radii:?}");
        }
        let [low, high] = largest([1.0, 0.6]);
        assert!((low - 1.0 / 0.6).abs() < 1e-9 && (high - 2.5).abs() < 1e-9, "{low} {high}");
    }

    #[test]
    fn the_monkey_saddle_has_mikkelsens_curvatures() {
        // Section 2.6.1 reports 0.0026 to 2.4495 over the pixels of figure 8; the origin itself is flat.
        let size = 1001;
        let mut high = 0.0_f64;
        let mut flat = f64::INFINITY;
        for (i, j) in (0..size).flat_map(|i| (0..size).map(move |j| (i, j))) {
            let kappa = monkey_saddle(f64::from(i) / 1000.0, f64::from(j) / 1000.0).max_curvature();
            (high, flat) = (high.max(kappa), flat.min(kappa));
        }
        assert!((high - 2.4495).abs() < 1e-4, "{high}");
        // Near the origin kappa is 6 r: a value of 0.0026 is that of a pixel 0.00043 from it.
        assert!(flat < 1e-9);
        let near = monkey_saddle(0.5 + 0.5 * 0.0026 / 6.0, 0.5).max_curvature();
        assert!((near - 0.0026).abs() < 1e-6, "{near}");
    }
}
