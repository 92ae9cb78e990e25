//! The pixel's footprint: the part of the map that a pixel's square sees.
//!
//! On a plane under a perspective camera `q = 1/w` and `q uv` are linear over the screen, so that a step `o` (in
//! pixels, from the pixel's centre) changes the texture coordinates by
//! `uv(o) - uv = (dx o_x + dy o_y) / (1 + g . o)`, exactly: `dx` and `dy` are the derivatives at the centre and
//! `g = grad q / q`. The square maps to a quadrilateral; with `g = 0` it is the parallelogram that first derivatives
//! alone would give. On a curved mesh it is the footprint on the plane of the triangle at the centre.

use glam::Vec2;

/// How texture coordinates run over one pixel.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PixelFootprint {
    /// Derivative of `uv` at the pixel's centre, per pixel to the right.
    pub dx: Vec2,
    /// The same per pixel down.
    pub dy: Vec2,
    /// Derivative of the logarithm of `1/w`, per pixel right and down: how much nearer the surface comes.
    pub perspective: Vec2,
}

impl PixelFootprint {
    /// The least that `1 + g . o` may be: a pixel that reaches up to the horizon sees finitely much of the map.
    pub const HORIZON: f32 = 1.0 / 64.0;

    /// The change of `uv` over `offset` pixels from the centre.
    pub fn uv_step(&self, offset: Vec2) -> Vec2 {
        let nearness = (1.0 + self.perspective.dot(offset)).max(Self::HORIZON);
        (offset.x * self.dx + offset.y * self.dy) / nearness
    }

    /// True where no corner of the pixel reaches the horizon, so that the map from pixel to `uv` is one to one.
    pub fn is_before_the_horizon(&self) -> bool {
        1.0 - 0.5 * (self.perspective.x.abs() + self.perspective.y.abs()) > Self::HORIZON
    }
}
