//! Lights.

pub mod light;
pub mod lights;

pub use light::{Light, ParseLightError};
pub use lights::{Lights, MAX_LIGHTS};
