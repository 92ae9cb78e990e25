//! Every method held against the truth: pictures of both are drawn, and figures taken of what is between them.
//!
//! A [`Measurer`] draws one map at a list of [`Point`]s, each a surface and a fit, and tells a [`Follower`] what it
//! finds. The command line and the window measure by the same one, so their figures are the same numbers. A [`Sweep`]
//! is a list of points along one axis, a [`SweepRun`] the job that measures it.

pub mod dolly;
pub mod figures;
pub mod files;
pub mod findings;
pub mod follower;
pub mod measurer;
pub mod metric;
pub mod sweep;
pub mod sweep_files;
pub mod sweep_run;
pub mod tasks;

pub use figures::{Cell, MethodFigures, Reference};
pub use findings::Findings;
pub use follower::{Finding, Follower, MeasureError, Shown};
pub use measurer::{MeasureSettings, Measurer, Point, bytes_per_texel};
pub use metric::Metric;
pub use sweep::{Axis, Sweep};
pub use sweep_run::SweepRun;
