//! Mathematics on the unit sphere: directions, zonal series, von Mises-Fisher lobes and mixtures of them.

pub mod direction;
pub mod harmonics;
pub mod mixture;
pub mod vmf;

pub use direction::Direction;
pub use mixture::{Lobe, Mixture, StoredLobe};
