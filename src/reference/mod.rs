//! The processor's own picture of the lit surface, pixel for pixel what the graphics adapter should draw, and the
//! figures by which pictures are judged.

pub mod metrics;
pub mod raster;
pub mod shade;

pub use metrics::{normalised_color_error, rmse};
pub use shade::{Picture, render};
