//! Lights.

pub mod directional;

pub use directional::DirectionalLight;
