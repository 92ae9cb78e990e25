//! The passes of a frame, each beside its shader in `shaders/`.

pub mod compare;
pub mod environment;
pub mod sphere;
pub mod surface;
