//! Bump mapping drawn by the processor: the surface lit with the exact or with Blinn's normal, the curvature, the
//! product of height and curvature by which the two normals differ, and both as needles.
//!
//! The pictures are those of M. S. Mikkelsen, *Simulation of Wrinkled Surfaces Revisited* (2008), figures 6, 8, 9 and
//! 11. Heights are read once per pixel, at its centre.

use glam::{DVec2, Vec2, Vec3};
use rayon::prelude::*;

use super::raster::rasterize;
use crate::color::{LOBE_COLORS, srgb8_from_linear};
use crate::filter::reflect;
use crate::image_io::RasterImage;
use crate::lit_surface::{LitSurface, SurfacePoint};
use crate::normal_map::Addressing;
use crate::normal_map::height::{self, SlopeKernel};
use crate::scene::Jet;
use crate::scene::bump::{BumpRule, HeightSample, perturbed_normal};

/// What is drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum BumpView {
    /// The surface lit, with this normal.
    Lit(BumpRule),
    /// The larger principal curvature, black for none, white for the largest seen.
    Curvature,
    /// Its product with the height, likewise.
    #[default]
    Product,
}

/// A relief on a parametric surface.
#[derive(Clone, Copy, Debug)]
pub struct BumpPicture<'a> {
    /// The surface, its material, light and camera.
    pub surface: &'a LitSurface,
    /// The heights, an integer's full scale as 1.
    pub heights: &'a RasterImage,
    /// What a height of 1 is in the surface's own units.
    pub scale: f64,
    /// How slopes are taken.
    pub kernel: SlopeKernel,
    /// What lies beyond the map's edge.
    pub addressing: Addressing,
    /// What is drawn.
    pub view: BumpView,
    /// Points along each side at which both normals are drawn as needles.
    pub needles: u32,
}

/// A drawn picture.
#[derive(Clone, Debug, PartialEq)]
pub struct DrawnBump {
    /// sRGB and coverage, four bytes a pixel.
    pub rgba: Vec<u8>,
    /// The largest value seen, where curvature or the product is drawn.
    pub largest: Option<f64>,
}

/// Length of the needles in world space.
const NEEDLE: f32 = 0.15;
/// The needles' colours: the exact normal, Blinn's.
const NEEDLE_COLORS: [(BumpRule, [u8; 3]); 2] = [(BumpRule::Blinn, LOBE_COLORS[1]), (BumpRule::Exact, LOBE_COLORS[0])];

impl BumpPicture<'_> {
    /// The surface to second order and the relief where the map is read at `uv`; `None` on surfaces that are no single
    /// function.
    fn at(&self, uv: DVec2) -> Option<(Jet, HeightSample)> {
        let place = self.surface.shape.texture_from_surface().inverse() * DVec2::new(uv.x, -uv.y);
        let jet = self.surface.shape.jet(place.x, 1.0 + place.y)?;
        let sample = height::sample(self.heights, uv, self.addressing, self.kernel).scaled(self.scale);
        Some((jet, sample))
    }

    fn normal(&self, (jet, sample): &(Jet, HeightSample), rule: BumpRule) -> Vec3 {
        perturbed_normal(jet, self.surface.shape.texture_from_surface(), *sample, rule).as_vec3()
    }

    /// Draws the picture; black where nothing is seen.
    pub fn draw(&self, size: [u32; 2]) -> DrawnBump {
        let points = rasterize(self.surface, size);
        let (colors, largest) = match self.view {
            BumpView::Lit(rule) => (self.lit(&points, rule), None),
            BumpView::Curvature | BumpView::Product => {
                let values: Vec<f64> = points.par_iter().map(|point| self.value(point.as_ref())).collect();
                let largest = values.iter().fold(0.0, |a: f64, b| a.max(*b));
                let grey = |value: &f64| [(255.0 * value / largest.max(f64::MIN_POSITIVE)) as u8; 3];
                (values.iter().map(grey).collect(), Some(largest))
            }
        };
        let alpha = |point: &Option<SurfacePoint>| if point.is_some() { 255 } else { 0 };
        let texels = colors.iter().zip(&points).map(|(&[r, g, b], point)| [r, g, b, alpha(point)]);
        let mut picture: Vec<[u8; 4]> = texels.collect();
        self.draw_needles(&mut picture, &points, size);
        DrawnBump { rgba: picture.concat(), largest }
    }

    fn lit(&self, points: &[Option<SurfacePoint>], rule: BumpRule) -> Vec<[u8; 3]> {
        let shade = |point: &Option<SurfacePoint>| {
            let Some(point) = point else { return [0; 3] };
            let Some(at) = self.at(point.uv.as_dvec2()) else { return [0; 3] };
            srgb8_from_linear(self.shade(point.position_in_world, self.normal(&at, rule)))
        };
        points.par_iter().map(shade).collect()
    }

    fn shade(&self, position: Vec3, normal: Vec3) -> Vec3 {
        let surface = self.surface;
        let to_eye = (surface.camera.eye_in_world() - position).normalize();
        let of_light = |light: &crate::lighting::Light| {
            let incident = light.at(position);
            let half = (to_eye + incident.direction_in_world).normalize_or(normal);
            let material = self.surface.material.towards(half.dot(to_eye));
            let specular = material.specular_at(normal.dot(half));
            incident.radiance * reflect(&material, specular, normal.dot(incident.direction_in_world))
        };
        surface.exposure() * surface.lights.as_slice().iter().map(of_light).sum::<Vec3>()
    }

    fn value(&self, point: Option<&SurfacePoint>) -> f64 {
        let Some((jet, sample)) = point.and_then(|point| self.at(point.uv.as_dvec2())) else { return 0.0 };
        let factor = if self.view == BumpView::Product { sample.height.abs() } else { 1.0 };
        let value = factor * jet.max_curvature();
        if value.is_finite() { value } else { 0.0 }
    }

    fn draw_needles(&self, picture: &mut [[u8; 4]], points: &[Option<SurfacePoint>], size: [u32; 2]) {
        let place = |index: u32| (f64::from(index) + 0.5) / f64::from(self.needles);
        for (i, j) in (0..self.needles).flat_map(|i| (0..self.needles).map(move |j| (i, j))) {
            let uv = self.surface.shape.texture_from_surface() * DVec2::new(place(i), -place(j));
            let Some(at) = self.at(DVec2::new(uv.x, -uv.y)) else { return };
            let foot = (self.surface.shape.scale() * at.0.position).as_vec3();
            let Some(start) = self.pixel(foot, size).filter(|pixel| is_seen(foot, *pixel, points, size)) else {
                continue;
            };
            for (rule, color) in NEEDLE_COLORS {
                if let Some(end) = self.pixel(foot + NEEDLE * self.normal(&at, rule), size) {
                    draw_line(picture, size, [start, end], color);
                }
            }
        }
    }

    /// Where a point of the world is seen, in pixels from the top left.
    fn pixel(&self, position: Vec3, [width, height]: [u32; 2]) -> Option<Vec2> {
        let (width, height) = (width as f32, height as f32);
        let clip = self.surface.camera.clip_from_world(width / height) * position.extend(1.0);
        let place = Vec2::new(clip.x, -clip.y) / clip.w * 0.5 + 0.5;
        (clip.w > 0.0).then(|| place * Vec2::new(width, height))
    }
}

/// True where the surface seen at a pixel is the one that the point lies on, and not something before it.
fn is_seen(position: Vec3, pixel: Vec2, points: &[Option<SurfacePoint>], size: [u32; 2]) -> bool {
    let point = index_of(pixel, size).and_then(|index| points[index].as_ref());
    point.is_some_and(|point| point.position_in_world.distance(position) < 0.3 * NEEDLE)
}

fn index_of(pixel: Vec2, [width, height]: [u32; 2]) -> Option<usize> {
    let inside = pixel.min_element() >= 0.0 && pixel.x < width as f32 && pixel.y < height as f32;
    inside.then(|| pixel.y as usize * width as usize + pixel.x as usize)
}

fn draw_line(picture: &mut [[u8; 4]], size: [u32; 2], [start, end]: [Vec2; 2], [r, g, b]: [u8; 3]) {
    let steps = (end - start).abs().max_element().ceil().max(1.0) as u32;
    for step in 0..=steps {
        let at = start.lerp(end, step as f32 / steps as f32);
        if let Some(index) = index_of(at, size) {
            picture[index] = [r, g, b, 255];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image_io::{SampleDepth, Samples};
    use crate::scene::{Shape, ShapeKind};

    fn waves() -> RasterImage {
        let size = 64;
        let wave = |i: usize| (0.5 + 0.5 * (i as f32 / size as f32 * std::f32::consts::TAU).sin()) * 0.5;
        let values = (0..size * size).map(|texel| wave(texel % size) + wave(texel / size)).collect();
        RasterImage {
            width: size,
            height: size,
            channels: 1,
            has_alpha: false,
            samples: Samples::F32(values),
            depth: SampleDepth::Float,
            format: "test",
            tagged_srgb: false,
        }
    }

    fn drawn(kind: ShapeKind, radii: [f32; 2], scale: f64, view: BumpView, needles: u32) -> DrawnBump {
        let shape = Shape { radii, tiling: [4.0, 2.0], ..Shape::of_kind(kind) };
        let surface = LitSurface { shape, ..LitSurface::default() };
        let (kernel, addressing) = (SlopeKernel::Central, Addressing::Wrap);
        let heights = &waves();
        BumpPicture { surface: &surface, heights, scale, kernel, addressing, view, needles }.draw([96, 72])
    }

    /// The mean difference of a colour value between the pictures of both normals.
    fn apart(kind: ShapeKind, radii: [f32; 2], scale: f64) -> f64 {
        let [blinn, exact] =
            [BumpRule::Blinn, BumpRule::Exact].map(|rule| drawn(kind, radii, scale, BumpView::Lit(rule), 0).rgba);
        let sum: u32 = blinn.iter().zip(&exact).map(|(a, b)| u32::from(a.abs_diff(*b))).sum();
        f64::from(sum) / blinn.len() as f64
    }

    #[test]
    fn both_normals_light_a_plane_alike_and_part_on_a_thin_torus_as_the_relief_grows() {
        assert!(apart(ShapeKind::Plane, [1.0, 0.3], 0.25) < 1e-9);
        let torus = |scale| apart(ShapeKind::Torus, [0.75, 0.1], scale);
        let parts = [1.0 / 128.0, 1.0 / 32.0, 1.0 / 8.0].map(torus);
        println!("{parts:?}");
        assert!(parts[0] < 0.5 * parts[1] && parts[1] < 0.7 * parts[2], "{parts:?}");
    }

    #[test]
    fn the_product_is_the_curvature_times_the_height() {
        let radii = [0.8, 0.2];
        let largest = |view, scale| drawn(ShapeKind::Torus, radii, scale, view, 0).largest.expect("a value");
        assert!((largest(BumpView::Curvature, 1.0) - 5.0).abs() < 1e-5);
        // The relief reaches 1 somewhere among the pixels, or nearly.
        let product = largest(BumpView::Product, 0.0625);
        assert!(product > 0.9 * 5.0 * 0.0625 && product <= 5.0 * 0.0625 + 1e-6, "{product}");
    }

    #[test]
    fn needles_stand_where_the_surface_is_seen() {
        let without = drawn(ShapeKind::Sphere, [0.8, 0.2], 0.05, BumpView::Product, 0);
        let with = drawn(ShapeKind::Sphere, [0.8, 0.2], 0.05, BumpView::Product, 9);
        let count = |color: [u8; 3]| with.rgba.chunks_exact(4).filter(|texel| texel[..3] == color).count();
        assert!(count(LOBE_COLORS[0]) > 40 && without.rgba != with.rgba);
    }
}
