//! Results as files for other programs, and back.

pub mod lobes_exr;
