//! Everything that is drawn by a graphics adapter: which adapter, the textures, the passes and the frame.
//!
//! Nothing in here knows the window: the window's viewport and the command line record the same frame.

pub mod context;
pub mod exact_tables;
pub mod frame;
pub mod frame_data;
pub mod layout;
pub mod map_group;
pub mod measured_table;
pub mod method_picture;
pub mod pass_timer;
pub mod passes;
pub mod picture;
pub mod picture_readback;
pub mod readback;
pub mod reflectance;
pub mod rival_textures;
pub mod sky_textures;
pub mod snapshots;
pub mod surface_pipelines;
pub mod textures;
pub mod upload;

pub use context::{AdapterChoice, Gpu, GpuError};
pub use frame::{FrameBudget, FrameInput, SurfaceFrame};
pub use picture::{PICTURE_FORMAT, render_to_rgba8};
