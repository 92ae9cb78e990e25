//! The truth without samples: every base texel clipped to the pixel, weighted by its area there.
//!
//! Mikkelsen (2008, section 5, "reference model"): every texel inside the pixel's coverage is lit, those partly inside
//! are clipped against its outline, and the sum over area times light is divided by the whole area. Light and half
//! vector are those of the pixel's centre, as in every method (his section 2.5).
//!
//! What is integrated is precisely what [`Truth`](crate::filter::Truth) samples: the mean, uniform over the pixel's
//! square on the screen, of what the base texel under each point reflects. The areas are therefore taken on the
//! screen. With `d = k - u` the line `u = k` of the map is seen where `(dx_u, dy_u) . o = d (1 + g . o)`
//! (see [`PixelFootprint`]), which is linear in the offset `o`: a column of texels is the part of the square between
//! two lines, a texel the part of a column between two more. All polygons are convex and all areas exact up to
//! rounding; areas in the map, which Mikkelsen names, would weigh the far side of a pixel more than the eye does.
//!
//! On the plane this is the exact quadrilateral of the pixel; on a curved mesh the exact footprint on the triangle at
//! the centre. The surface is taken to go on beyond its edges; a pixel that reaches the horizon is cut there.

use std::sync::Arc;

use glam::{DVec2, DVec3, Vec2, Vec3};

use crate::brdf::{Brdf, Material};
use crate::filter::sampling::address;
use crate::filter::{EffectiveBrdf, Filter, LocalLight, LocalSky, Lookup, PixelFootprint, reflect};
use crate::ndf::Ndf;
use crate::normal_map::NormalMap;
use crate::normal_map::pyramid::Texel;

/// The oracle of the sampled truth.
#[derive(Clone, Debug)]
pub struct ExactCoverage {
    /// The map.
    pub map: Arc<NormalMap>,
}

/// A line over the pixel: zero of `normal . o + offset`, which is positive above it.
#[derive(Clone, Copy, Debug)]
struct Line {
    normal: DVec2,
    offset: f64,
}

/// Corners of a convex polygon, in pixels from the pixel's centre.
type Polygon = Vec<DVec2>;

impl ExactCoverage {
    /// The base texels that a pixel sees, as row-major index and share of the pixel; the shares sum to 1.
    pub fn texels(&self, uv: Vec2, footprint: &PixelFootprint) -> Vec<(usize, f64)> {
        let map = &self.map;
        let [columns, rows] = axes(uv, footprint, [map.width, map.height]);
        let pixel = before_the_horizon(footprint);
        let whole = area(&pixel);
        let mut texels = Vec::new();
        for (x, column) in slices(pixel, &columns) {
            for (y, part) in slices(column, &rows) {
                let at = |index, size| address(index, size, map.options.addressing);
                texels.push((at(y, map.height) * map.width + at(x, map.width), area(&part) / whole));
            }
        }
        texels
    }
}

impl Filter for ExactCoverage {
    fn map(&self) -> &NormalMap {
        &self.map
    }

    fn effective_brdf_of(&self, texel: Texel, brdf: Brdf) -> EffectiveBrdf<'_> {
        let ndf = Ndf::of_texel(&self.map, texel);
        Box::new(move |omega| ndf.effective_brdf(brdf, omega))
    }

    fn is_truth(&self) -> bool {
        true
    }

    fn shade(&self, lookup: &Lookup, light: &LocalLight, material: &Material) -> Vec3 {
        let reflected = |(index, share): (usize, f64)| {
            let normal = lookup.turned(self.map.normal(index).unwrap_or(Vec3::ZERO));
            let specular = material.specular_at(normal.dot(light.half_in_tangent));
            let reflected = reflect(material, specular, normal.dot(light.light_in_tangent));
            share * (self.map.color(index) * reflected).as_dvec3()
        };
        self.texels(lookup.uv, &lookup.footprint).into_iter().map(reflected).sum::<DVec3>().as_vec3()
    }

    fn shade_sky(&self, lookup: &Lookup, sky: &LocalSky<'_>) -> Vec3 {
        let reflected = |(index, share): (usize, f64)| {
            let normal = self.map.normal(index).unwrap_or(Vec3::ZERO);
            share * (self.map.color(index) * sky.exact(normal)).as_dvec3()
        };
        self.texels(lookup.uv, &lookup.footprint).into_iter().map(reflected).sum::<DVec3>().as_vec3()
    }
}

/// One axis of the map as the pixel sees it, in base texels.
struct Axis {
    center: f64,
    derivative: DVec2,
    perspective: DVec2,
}

fn axes(uv: Vec2, footprint: &PixelFootprint, size: [usize; 2]) -> [Axis; 2] {
    let [uv, dx, dy] = [uv, footprint.dx, footprint.dy].map(Vec2::as_dvec2);
    [0, 1].map(|axis| Axis {
        center: uv[axis] * size[axis] as f64,
        derivative: DVec2::new(dx[axis], dy[axis]) * size[axis] as f64,
        perspective: footprint.perspective.as_dvec2(),
    })
}

impl Axis {
    /// The coordinate under a point of the pixel.
    fn at(&self, offset: DVec2) -> f64 {
        self.center + self.derivative.dot(offset) / (1.0 + self.perspective.dot(offset))
    }

    /// Where the coordinate is `edge`; above it, it is larger.
    fn line(&self, edge: f64) -> Line {
        let distance = edge - self.center;
        Line { normal: self.derivative - distance * self.perspective, offset: -distance }
    }
}

/// A polygon cut along the edges between texels of one axis, with the texels' indices.
fn slices(polygon: Polygon, axis: &Axis) -> Vec<(i64, Polygon)> {
    let [mut low, mut high] = [f64::INFINITY, f64::NEG_INFINITY];
    for &corner in &polygon {
        (low, high) = (low.min(axis.at(corner)), high.max(axis.at(corner)));
    }
    if polygon.is_empty() {
        return Vec::new();
    }
    let [first, last] = [low, high].map(|coordinate| coordinate.floor() as i64);
    let mut rest = polygon;
    let mut slices = Vec::with_capacity((last - first + 1) as usize);
    for index in first..last {
        let [below, above] = split(&rest, axis.line((index + 1) as f64));
        slices.push((index, below));
        rest = above;
    }
    slices.push((last, rest));
    slices
}

/// The parts of a convex polygon below and above a line (Sutherland and Hodgman 1974, for both sides at once).
fn split(polygon: &[DVec2], line: Line) -> [Polygon; 2] {
    let height = |point: DVec2| line.normal.dot(point) + line.offset;
    let [mut below, mut above] = [Polygon::new(), Polygon::new()];
    for (index, &from) in polygon.iter().enumerate() {
        let to = polygon[(index + 1) % polygon.len()];
        let (start, end) = (height(from), height(to));
        if start <= 0.0 {
            below.push(from);
        }
        if start >= 0.0 {
            above.push(from);
        }
        if start * end < 0.0 {
            let crossing = from + start / (start - end) * (to - from);
            below.push(crossing);
            above.push(crossing);
        }
    }
    [below, above]
}

/// The pixel's square, without what lies beyond the horizon.
fn before_the_horizon(footprint: &PixelFootprint) -> Polygon {
    let square = [(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)].map(DVec2::from).to_vec();
    if footprint.is_before_the_horizon() {
        return square;
    }
    let offset = 1.0 - f64::from(PixelFootprint::HORIZON);
    let [_, seen] = split(&square, Line { normal: footprint.perspective.as_dvec2(), offset });
    seen
}

fn area(polygon: &[DVec2]) -> f64 {
    let next = polygon.iter().cycle().skip(1);
    0.5 * polygon.iter().zip(next).map(|(a, b)| a.perp_dot(*b)).sum::<f64>().abs()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::normal_map::procedural;

    fn oracle() -> ExactCoverage {
        ExactCoverage { map: Arc::new(procedural::default_map()) }
    }

    /// A footprint of some texels, askew and in perspective.
    fn askew(map: &NormalMap) -> PixelFootprint {
        let texel = 1.0 / map.width as f32;
        PixelFootprint {
            dx: Vec2::new(3.3, 0.7) * texel,
            dy: Vec2::new(-1.1, 6.2) * texel,
            perspective: Vec2::new(0.1, -0.4),
        }
    }

    #[test]
    fn shares_of_a_pixel_sum_to_1() {
        let oracle = oracle();
        for perspective in [Vec2::ZERO, Vec2::new(0.1, -0.4), Vec2::new(0.0, 1.99), Vec2::new(0.0, 3.0)] {
            let footprint = PixelFootprint { perspective, ..askew(&oracle.map) };
            let texels = oracle.texels(Vec2::new(0.503, 0.998), &footprint);
            let sum: f64 = texels.iter().map(|(_, share)| share).sum();
            assert!((sum - 1.0).abs() < 1e-9 && texels.len() > 20, "{perspective}: {sum} of {}", texels.len());
            assert!(texels.iter().all(|(_, share)| *share >= 0.0));
        }
    }

    #[test]
    fn a_pixel_of_two_by_three_texels_sees_each_by_a_sixth() {
        let oracle = oracle();
        let (width, height) = (oracle.map.width, oracle.map.height);
        let texel = Vec2::new(1.0 / width as f32, 1.0 / height as f32);
        let footprint = PixelFootprint { dx: 2.0 * texel * Vec2::X, dy: 3.0 * texel * Vec2::Y, ..Default::default() };
        let mut texels = oracle.texels(Vec2::new(9.0, 5.5) * texel, &footprint);
        texels.retain(|(_, share)| *share > 1e-6);
        let expected = [4, 5, 6].map(|y| [8, 9].map(|x| y * width + x)).concat();
        texels.sort_by_key(|(index, _)| *index);
        assert_eq!(texels.iter().map(|(index, _)| *index).collect::<Vec<_>>(), expected);
        assert!(texels.iter().all(|(_, share)| (share - 1.0 / 6.0).abs() < 1e-5), "{texels:?}");
    }

    #[test]
    fn shares_are_what_points_all_over_the_pixel_count() {
        let oracle = oracle();
        let map = &oracle.map;
        let (uv, footprint) = (Vec2::new(0.31, 0.47), askew(map));
        let mut counted = vec![0.0; map.len()];
        let side = 1000;
        for (i, j) in (0..side).flat_map(|i| (0..side).map(move |j| (i, j))) {
            let at = |step: i32| (step as f32 + 0.5) / side as f32 - 0.5;
            let seen =
                (uv + footprint.uv_step(Vec2::new(at(i), at(j)))) * Vec2::new(map.width as f32, map.height as f32);
            counted[seen.y as usize * map.width + seen.x as usize] += 1e-6;
        }
        for (index, share) in oracle.texels(uv, &footprint) {
            counted[index] -= share;
        }
        // A texel of a fortieth of the pixel has some 600 points on its outline, half of them on the wrong side.
        assert!(counted.iter().all(|difference: &f64| difference.abs() < 3e-4));
    }
}
