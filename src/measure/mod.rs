//! Every method held against the truth: pictures of both are drawn, and figures taken of what is between them.
//!
//! A [`Measurer`] draws one map at a list of [`Point`]s, each a surface and a fit, and tells a [`Follower`] what it
//! finds. The command line and the window measure by the same one, so their figures are the same numbers.

pub mod dolly;
pub mod figures;
pub mod files;
pub mod findings;
pub mod follower;
pub mod measurer;
pub mod tasks;

pub use figures::{Cell, MethodFigures, Reference};
pub use findings::Findings;
pub use follower::{Finding, Follower, MeasureError, Shown};
pub use measurer::{MeasureSettings, Measurer, Point, bytes_per_texel};
