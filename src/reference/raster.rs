//! Which surface point lies under each pixel: a rasteriser in homogeneous coordinates.
//!
//! Olano and Greer (1997): with the corners' `(x, y, w)` as columns of a matrix, the rows of its inverse are three
//! functions linear over the screen, `b_i(x, y)`; a pixel is inside where all are positive, `sum b_i` is `1/w`, and
//! `sum b_i a_i / sum b_i` is attribute `a` with perspective. Nothing is clipped, corners behind the eye included;
//! depth outside `0..=1` is rejected per pixel.

use glam::{DMat2, DMat3, DVec2, DVec3, Vec2, Vec3};

use crate::filter::PixelFootprint;
use crate::filter::truth::nearest_texel;
use crate::lit_surface::{LitSurface, SurfacePoint};
use crate::normal_map::NormalMap;
use crate::normal_map::pyramid::Texel;
use crate::scene::bump::Bumped;
use crate::scene::mesh::Tangents;
use crate::scene::{Reconstruction, Vertex};

/// The columns and rows of pixels that are asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Window {
    start: [u32; 2],
    end: [u32; 2],
}

/// A triangle ready to be asked about pixels.
struct ScreenTriangle<'a> {
    corners: [&'a Vertex; 3],
    tangents: [Tangents; 3],
    reconstruction: Reconstruction,
    /// What a relief bumps at each corner, where one does.
    reliefs: Option<[CornerRelief; 3]>,
    /// Where the map is read at each corner.
    uvs: [DVec2; 3],
    /// Takes `(x, y, 1)` to `b_i`.
    coverage_from_pixel: DMat3,
    depth_over_w: DVec3,
    w: DVec3,
}

/// How far the surface goes by texture coordinates at a corner, and how it bends.
#[derive(Clone, Copy)]
struct CornerRelief {
    stretch: DVec2,
    shape_operator: DMat2,
}

/// The surface under a relief between the corners.
fn bumped(corners: DMat3, weights: DVec3, reliefs: [CornerRelief; 3]) -> Bumped {
    let stretch: DVec2 = (0..3).map(|i| weights[i] * reliefs[i].stretch).sum();
    let bend = (0..3).fold(DMat2::ZERO, |sum, i| sum + reliefs[i].shape_operator * weights[i]);
    Bumped::new(corners, stretch, bend)
}

/// The visible surface point under the centre of every pixel, row by row from the top; `None` where there is none.
pub fn rasterize(surface: &LitSurface, size: [u32; 2]) -> Vec<Option<SurfacePoint>> {
    rasterize_window(surface, size, Window { start: [0, 0], end: size })
}

/// The surface point under one pixel of a picture of `size`.
pub fn pick(surface: &LitSurface, size: [u32; 2], pixel: [u32; 2]) -> Option<SurfacePoint> {
    if pixel[0] >= size[0] || pixel[1] >= size[1] {
        return None;
    }
    let window = Window { start: pixel, end: [pixel[0] + 1, pixel[1] + 1] };
    rasterize_window(surface, size, window).into_iter().next().flatten()
}

/// The texel that shades a surface point: the one under it, at the level in use, rounded to a whole level.
pub fn texel_at(surface: &LitSurface, map: &NormalMap, point: &SurfacePoint, lod_range: [f32; 2]) -> Texel {
    let base = (map.width, map.height);
    let lod = point.probes(surface.level_rule(), base, lod_range).lod;
    let sizes = map.level_sizes();
    let level = (lod.round() as usize).min(sizes.len() - 1);
    let addressing = map.options.addressing;
    Texel {
        level,
        x: nearest_texel(point.uv.x, sizes[level].0, addressing),
        y: nearest_texel(point.uv.y, sizes[level].1, addressing),
    }
}

fn rasterize_window(surface: &LitSurface, size: [u32; 2], window: Window) -> Vec<Option<SurfacePoint>> {
    let (columns, rows) = (window.end[0] - window.start[0], window.end[1] - window.start[1]);
    let count = columns as usize * rows as usize;
    let mut nearest = vec![f64::INFINITY; count];
    let mut points = vec![None; count];
    let mesh = surface.shape.mesh();
    for corners in mesh.triangles() {
        let Some(triangle) = ScreenTriangle::new(corners, surface, size) else { continue };
        let bounds = triangle.bounds(window);
        for y in bounds.start[1]..bounds.end[1] {
            for x in bounds.start[0]..bounds.end[0] {
                let index = ((y - window.start[1]) * columns + x - window.start[0]) as usize;
                if let Some(depth) = triangle.depth([x, y]).filter(|&depth| depth < nearest[index]) {
                    nearest[index] = depth;
                    points[index] = Some(triangle.point([x, y]));
                }
            }
        }
    }
    points
}

fn centre(pixel: [u32; 2]) -> DVec2 {
    DVec2::new(f64::from(pixel[0]) + 0.5, f64::from(pixel[1]) + 0.5)
}

impl<'a> ScreenTriangle<'a> {
    fn new(corners: [&'a Vertex; 3], surface: &LitSurface, size: [u32; 2]) -> Option<Self> {
        let aspect = size[0] as f32 / size[1] as f32;
        // The matrix is the shader's, rounded to f32; what follows is exact enough to be its judge.
        let clip_from_world = surface.camera.clip_from_world(aspect).as_dmat4();
        let clip = corners.map(|v| clip_from_world * Vec3::from(v.position).as_dvec3().extend(1.0));
        let half = DVec2::new(f64::from(size[0]), f64::from(size[1])) / 2.0;
        let screen = clip.map(|c| DVec3::new(half.x * (c.w + c.x), half.y * (c.w - c.y), c.w));
        let matrix = DMat3::from_cols_array_2d(&screen.map(|s| s.to_array()));
        if matrix.determinant().abs() < 1e-12 {
            return None;
        }
        let depth_over_w = DVec3::new(clip[0].z, clip[1].z, clip[2].z);
        let w = DVec3::new(clip[0].w, clip[1].w, clip[2].w);
        let coverage_from_pixel = matrix.inverse();
        let uv_from_surface = surface.shape.uv_from_surface();
        let tangents = corners.map(|corner| corner.tangents(uv_from_surface));
        let uvs = corners.map(|corner| uv_from_surface.as_dmat2() * Vec2::from(corner.uv).as_dvec2());
        let reconstruction = surface.shape.reconstruction;
        let relief = |corner: &Vertex| CornerRelief {
            stretch: corner.stretch(uv_from_surface).as_dvec2(),
            shape_operator: corner.shape_operator(uv_from_surface).as_dmat2(),
        };
        let reliefs = surface.shape.bump_rule().map(|_| corners.map(relief));
        Some(Self { corners, tangents, reconstruction, reliefs, uvs, coverage_from_pixel, depth_over_w, w })
    }

    /// The pixels it can touch, within `window`.
    fn bounds(&self, window: Window) -> Window {
        if self.w.min_element() <= 0.0 {
            return window;
        }
        let screen = self.coverage_from_pixel.inverse();
        let corners = [0, 1, 2].map(|i| screen.col(i).truncate() / screen.col(i).z);
        let low = corners[0].min(corners[1]).min(corners[2]);
        let high = corners[0].max(corners[1]).max(corners[2]);
        let clamp =
            |value: f64, axis: usize| value.clamp(f64::from(window.start[axis]), f64::from(window.end[axis])) as u32;
        Window {
            start: [clamp(low.x.floor(), 0), clamp(low.y.floor(), 1)],
            end: [clamp(high.x.ceil(), 0), clamp(high.y.ceil(), 1)],
        }
    }

    fn coverage(&self, pixel: [u32; 2]) -> DVec3 {
        self.coverage_from_pixel * centre(pixel).extend(1.0)
    }

    /// Depth in `0..=1` where the triangle covers the pixel's centre before the eye.
    fn depth(&self, pixel: [u32; 2]) -> Option<f64> {
        let b = self.coverage(pixel);
        if b.min_element() < 0.0 || b.element_sum() <= 0.0 {
            return None;
        }
        // z_clip and w are attributes: their ratio is the depth.
        let depth = b.dot(self.depth_over_w) / b.dot(self.w);
        (0.0..=1.0).contains(&depth).then_some(depth)
    }

    fn weights(&self, pixel: [u32; 2]) -> DVec3 {
        let b = self.coverage(pixel);
        b / b.element_sum()
    }

    fn blend(&self, weights: DVec3, attribute: impl Fn(&Vertex) -> [f32; 3]) -> DVec3 {
        (0..3).map(|i| weights[i] * Vec3::from(attribute(self.corners[i])).as_dvec3()).sum()
    }

    fn blend_tangents(&self, weights: DVec3, which: impl Fn(&Tangents) -> Vec3) -> DVec3 {
        (0..3).map(|i| weights[i] * which(&self.tangents[i]).as_dvec3()).sum()
    }

    fn blend_uvs(&self, weights: DVec3) -> DVec2 {
        (0..3).map(|i| weights[i] * self.uvs[i]).sum()
    }

    fn uv(&self, pixel: [u32; 2]) -> DVec2 {
        self.blend_uvs(self.weights(pixel))
    }

    /// The surface point, its derivatives taken as a GPU takes them: between the pixels of its 2 x 2 quad, outside
    /// the triangle too.
    fn point(&self, pixel: [u32; 2]) -> SurfacePoint {
        let [x, y] = pixel;
        let weights = self.weights(pixel);
        let uv = |pixel| self.uv(pixel);
        let corners = DMat3::from_cols(
            self.blend_tangents(weights, |frame| frame.tangent),
            self.blend_tangents(weights, |frame| frame.bitangent),
            self.blend(weights, |v| v.normal),
        );
        let frame = self.reconstruction.frame(corners);
        SurfacePoint {
            position_in_world: self.blend(weights, |v| v.position).as_vec3(),
            world_from_tangent: frame.world_from_tangent.as_mat3(),
            tangent_from_map: frame.tangent_from_map.as_mat3(),
            bumped: self.reliefs.map(|reliefs| bumped(corners, weights, reliefs)),
            uv: uv(pixel).as_vec2(),
            uv_dx: (uv([x | 1, y]) - uv([x & !1, y])).as_vec2(),
            uv_dy: (uv([x, y | 1]) - uv([x, y & !1])).as_vec2(),
            footprint: self.footprint(pixel),
        }
    }

    /// From the linear `b_i`: with `q = sum b_i`, `uv = sum b_i uv_i / q` has the derivative
    /// `(sum b_i' uv_i - uv q') / q`.
    fn footprint(&self, pixel: [u32; 2]) -> PixelFootprint {
        let uv = self.uv(pixel);
        let nearness = self.coverage(pixel).element_sum();
        let derivatives = [0, 1].map(|axis| {
            let slope = self.coverage_from_pixel.col(axis);
            let change = self.blend_uvs(slope);
            let approach = slope.element_sum() / nearness;
            (((change / nearness) - approach * uv).as_vec2(), approach as f32)
        });
        let [(dx, right), (dy, down)] = derivatives;
        PixelFootprint { dx, dy, perspective: Vec2::new(right, down) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Camera, Shape, ShapeKind};

    fn surface(kind: ShapeKind, distance: f32, elevation_deg: f32) -> LitSurface {
        LitSurface {
            shape: Shape { tiling: [1.0, 1.0], ..Shape::of_kind(kind) },
            camera: Camera { distance, elevation_deg, ..Camera::default() },
            ..LitSurface::default()
        }
    }

    #[test]
    fn the_plane_from_above_shows_the_map_the_right_way_up() {
        let seen = surface(ShapeKind::Plane, 3.0, 89.9);
        let size = [64, 64];
        let top_left = pick(&seen, size, [8, 8]).expect("on the plane");
        let bottom_right = pick(&seen, size, [55, 55]).expect("on the plane");
        assert!(top_left.uv.max_element() < 0.25, "{top_left:?}");
        assert!(bottom_right.uv.min_element() > 0.75, "{bottom_right:?}");
        assert!(top_left.uv_dx.x > 0.0 && top_left.uv_dy.y > 0.0);
    }

    #[test]
    fn a_picked_point_projects_onto_its_pixel() {
        let seen = surface(ShapeKind::Torus, 3.2, 50.0);
        let size = [96, 72];
        for (index, point) in rasterize(&seen, size).into_iter().enumerate().step_by(131) {
            let Some(point) = point else { continue };
            let clip = seen.camera.clip_from_world(96.0 / 72.0) * point.position_in_world.extend(1.0);
            let (x, y) = (48.0 * (1.0 + clip.x / clip.w), 36.0 * (1.0 - clip.y / clip.w));
            assert!((x - 0.5 - (index % 96) as f32).abs() < 1e-3 && (y - 0.5 - (index / 96) as f32).abs() < 1e-3);
            assert_eq!(pick(&seen, size, [index as u32 % 96, index as u32 / 96]), Some(point));
        }
    }

    #[test]
    fn a_plane_that_passes_behind_the_eye_still_covers_what_lies_before_it() {
        let seen = surface(ShapeKind::Plane, 0.3, 20.0);
        let points = rasterize(&seen, [32, 32]);
        assert!(points[31 * 32 + 16].is_some(), "the foot of the picture looks at the plane");
        assert!(points[16].is_none(), "the head of the picture looks over it");
    }

    #[test]
    fn a_sphere_shows_only_the_side_that_faces_the_eye() {
        let seen = surface(ShapeKind::Sphere, 3.2, 30.0);
        let points: Vec<_> = rasterize(&seen, [64, 48]).into_iter().flatten().collect();
        assert!(points.len() > 500);
        let eye = seen.camera.eye_in_world();
        assert!(points.iter().all(|p| (eye - p.position_in_world).dot(p.world_from_tangent.z_axis) > -0.05));
    }
}
