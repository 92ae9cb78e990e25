//! Lights, and light from everywhere.

pub mod environment;
pub mod light;
pub mod lights;
pub mod procedural_sky;
pub mod sky;
pub mod sky_harmonics;
pub mod sky_samples;
pub mod sky_source;
pub mod sun;

pub use environment::Environment;
pub use light::{Incident, Light, ParseLightError};
pub use lights::{Lights, MAX_LIGHTS};
pub use procedural_sky::ProceduralSky;
pub use sky::Sky;
pub use sky_source::{SkyError, SkySource};
pub use sun::Sun;
