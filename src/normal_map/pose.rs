//! The eight ways a map can lie: mirrored, flipped, turned by right angles, and what combines them.
//!
//! A fit that depends on the order of sums, or on which of two equal costs comes first, would come out otherwise for a
//! map that lies otherwise. Taken in the one pose that all eight share, it cannot.

use std::cmp::Ordering;
use std::sync::Arc;

use glam::Vec3;
use rayon::prelude::*;

use super::NormalMap;
use super::pyramid::Texel;

/// A change of pose: first left and right trade places, then up and down, then rows and columns.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Pose {
    /// Left and right trade places.
    pub mirrored: bool,
    /// Up and down trade places.
    pub flipped: bool,
    /// Rows become columns.
    pub transposed: bool,
}

impl Pose {
    /// As it lies.
    pub const IDENTITY: Self = Self { mirrored: false, flipped: false, transposed: false };

    /// All eight, the identity first.
    pub fn all() -> [Self; 8] {
        std::array::from_fn(|i| Self { mirrored: i & 1 > 0, flipped: i & 2 > 0, transposed: i & 4 > 0 })
    }

    /// The change that brings a map to the pose that it shares with its seven images: not higher than wide, and of
    /// those the first in the order of its normals, texel by texel.
    pub fn canonical(map: &NormalMap) -> Self {
        let size = (map.width, map.height);
        let lies = |pose: &Self| {
            let (width, height) = pose.size(size);
            width >= height
        };
        let poses = Self::all().into_iter().filter(lies);
        poses.min_by(|a, b| a.compare(b, map)).unwrap_or(Self::IDENTITY)
    }

    /// Two poses of a map by the first normal in which they differ; equal where they look the same.
    fn compare(self, other: &Self, map: &NormalMap) -> Ordering {
        let size = (map.width, map.height);
        let width = self.size(size).0;
        (0..map.len())
            .map(|index| {
                let at = |pose: Self| {
                    let (x, y) = pose.source(size, (index % width, index / width));
                    pose.vector(normal(map, y * map.width + x)).to_array()
                };
                // Unit vectors and zero: they have an order.
                at(self).partial_cmp(&at(*other)).unwrap_or(Ordering::Equal)
            })
            .find(|order| order.is_ne())
            .unwrap_or(Ordering::Equal)
    }

    /// The change back.
    #[must_use]
    pub fn inverse(self) -> Self {
        if self.transposed { Self { mirrored: self.flipped, flipped: self.mirrored, ..self } } else { self }
    }

    /// The size of what had `size`.
    pub fn size(self, (width, height): (usize, usize)) -> (usize, usize) {
        if self.transposed { (height, width) } else { (width, height) }
    }

    /// Where the element at `(x, y)` of what had `size` comes to.
    pub fn target(self, (width, height): (usize, usize), (x, y): (usize, usize)) -> (usize, usize) {
        let x = if self.mirrored { width - 1 - x } else { x };
        let y = if self.flipped { height - 1 - y } else { y };
        if self.transposed { (y, x) } else { (x, y) }
    }

    /// Where the element that is now at `(x, y)` came from, in what had `size`.
    pub fn source(self, size: (usize, usize), place: (usize, usize)) -> (usize, usize) {
        self.inverse().target(self.size(size), place)
    }

    /// A tangent-space vector, `+y` up the image, as it points afterwards.
    pub fn vector(self, v: Vec3) -> Vec3 {
        // What pointed right points down once rows are columns. Zero keeps one sign.
        let x = if self.mirrored { 0.0 - v.x } else { v.x };
        let y = if self.flipped { 0.0 - v.y } else { v.y };
        if self.transposed { Vec3::new(0.0 - y, 0.0 - x, v.z) } else { Vec3::new(x, y, v.z) }
    }

    /// A texel of a level of `size`, in the pose.
    pub fn texel(self, size: (usize, usize), texel: Texel) -> Texel {
        let (x, y) = self.target(size, (texel.x, texel.y));
        Texel { x, y, ..texel }
    }

    /// The normals of a map in the pose. Its colour and its stored samples stay behind.
    pub fn map(self, map: &Arc<NormalMap>) -> Arc<NormalMap> {
        if self == Self::IDENTITY {
            return Arc::clone(map);
        }
        let size = (map.width, map.height);
        let (width, height) = self.size(size);
        let mut planes = [(); 3].map(|()| vec![0.0; map.len()]);
        let [x, y, z] = &mut planes;
        let rows = x.par_chunks_mut(width).zip(y.par_chunks_mut(width)).zip(z.par_chunks_mut(width));
        rows.enumerate().for_each(|(row, ((x, y), z))| {
            for column in 0..width {
                let source = self.source(size, (column, row));
                let n = self.vector(normal(map, source.1 * map.width + source.0));
                (x[column], y[column], z[column]) = (n.x, n.y, n.z);
            }
        });
        let [x, y, z] = planes;
        Arc::new(NormalMap {
            width,
            height,
            x,
            y,
            z,
            invalid: map.invalid,
            options: map.options.clone(),
            source: map.source.clone(),
            stored: Arc::clone(&map.stored),
            warnings: Vec::new(),
            decoder: None,
            albedo: None,
        })
    }
}

/// The normal of a texel, zero where there is none.
fn normal(map: &NormalMap, index: usize) -> Vec3 {
    Vec3::new(map.x[index], map.y[index], map.z[index])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::normal_map::procedural;

    #[test]
    fn a_change_and_the_change_back_leave_all_as_it_was() {
        let map = Arc::new(procedural::find("brushed").expect("bundled").make(16));
        let size = (5, 3);
        for pose in Pose::all() {
            let back = pose.inverse();
            assert_eq!(back.size(pose.size(size)), size);
            for place in (0..3).flat_map(|y| (0..5).map(move |x| (x, y))) {
                assert_eq!(back.target(pose.size(size), pose.target(size, place)), place, "{pose:?}");
                assert_eq!(pose.source(size, pose.target(size, place)), place, "{pose:?}");
            }
            let v = Vec3::new(0.48, -0.6, 0.64);
            assert_eq!(back.vector(pose.vector(v)), v, "{pose:?}");
            let again = back.map(&pose.map(&map));
            assert_eq!((&again.x, &again.y, &again.z), (&map.x, &map.y, &map.z), "{pose:?}");
        }
    }

    #[test]
    fn a_vector_turns_with_the_image() {
        // From a place to its neighbour on the right, or above, is where +x, or +y, points.
        let (size, place) = ((9, 7), (4, 3));
        for pose in Pose::all() {
            let (here, right) = (pose.target(size, place), pose.target(size, (5, 3)));
            let above = pose.target(size, (4, 2));
            let step = |to: (usize, usize)| Vec3::new(to.0 as f32 - here.0 as f32, here.1 as f32 - to.1 as f32, 0.0);
            assert_eq!((pose.vector(Vec3::X), pose.vector(Vec3::Y)), (step(right), step(above)), "{pose:?}");
        }
    }

    #[test]
    fn all_images_of_a_map_share_its_canonical_pose() {
        for name in ["plate", "v-groove", "pyramid5"] {
            let map = Arc::new(procedural::find(name).expect("bundled").make(16));
            let canonical = Pose::canonical(&map).map(&map);
            for pose in Pose::all() {
                let image = pose.map(&map);
                let other = Pose::canonical(&image).map(&image);
                assert_eq!(
                    (&other.x, &other.y, &other.z),
                    (&canonical.x, &canonical.y, &canonical.z),
                    "{name} {pose:?}"
                );
            }
        }
    }
}
