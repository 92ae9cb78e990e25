//! What happens to a normal map when it is filtered.

pub mod app;
pub mod brdf;
pub mod cli;
pub mod color;
pub mod filter;
pub mod gpu;
pub mod headless;
pub mod image_io;
pub mod jobs;
pub mod lighting;
pub mod lit_surface;
pub mod ndf;
pub mod normal_map;
pub mod reference;
pub mod scene;
pub mod session;
pub mod sphere;
