//! Drawing on the GPU: wgpu only, no user interface.

pub mod passes;
