//! Results as files for other programs, and back.

pub mod lobe_shader;
pub mod lobes_exr;
pub mod roughness;
pub mod slopes;
