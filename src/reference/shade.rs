//! The lit surface drawn by the processor: slow, simple, and the judge of the shaders.

use glam::Vec3;
use rayon::prelude::*;

use super::raster::rasterize;
use crate::filter::{Filter, Lookup};
use crate::lit_surface::{LitSurface, SurfacePoint, level_of_detail, shade_point};

/// A picture in linear light.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// Pixels across and down.
    pub size: [u32; 2],
    /// Linear RGB, row by row from the top; black where nothing is seen.
    pub rgb: Vec<Vec3>,
    /// True where the surface is seen.
    pub covered: Vec<bool>,
}

/// The lit surface seen through `filter`: levels within `lod_range`, of a base level of `base` texels.
pub fn render(
    surface: &LitSurface,
    filter: &dyn Filter,
    size: [u32; 2],
    lod_range: [f32; 2],
    base: (usize, usize),
) -> Picture {
    let points = rasterize(surface, size);
    let shade = |(index, point): (usize, &Option<SurfacePoint>)| {
        let point = point.as_ref()?;
        let pixel = [index as u32 % size[0], index as u32 / size[0]];
        let lod = level_of_detail(surface.level, point.uv_dx, point.uv_dy, base, lod_range);
        let lookup = Lookup { uv: point.uv, footprint: point.footprint, lod, pixel };
        Some(shade_point(surface, filter, point, &lookup))
    };
    let shaded: Vec<Option<Vec3>> = points.par_iter().enumerate().map(shade).collect();
    Picture {
        size,
        rgb: shaded.iter().map(|color| color.unwrap_or(Vec3::ZERO)).collect(),
        covered: shaded.iter().map(Option::is_some).collect(),
    }
}
