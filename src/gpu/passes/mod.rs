//! The passes of a frame, one file each, beside the shader of the same name.

pub mod sphere;
