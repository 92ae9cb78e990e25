//! The processor's own picture of the lit surface, pixel for pixel what the graphics adapter should draw, the
//! figures by which pictures are judged, the oracle of the sampled truth, bump mapping, and the picture of an NDF.

pub mod bump_picture;
pub mod exact_coverage;
pub mod figures;
pub mod flip;
mod flip_color;
pub mod metrics;
pub mod ndf_density;
pub mod raster;
pub mod shade;

pub use exact_coverage::ExactCoverage;
pub use figures::{Compared, Figures, Region};
pub use flip::flip;
pub use metrics::{normalised_color_error, rmse, standard_error, standard_error_of, temporal_change};
pub use ndf_density::NdfPicture;
pub use shade::{Picture, render};
