//! Placeholder types, replaced by the io branch.
/// Raster.
#[derive(Clone, Debug)]
pub struct RasterImage;
