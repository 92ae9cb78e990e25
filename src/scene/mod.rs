//! What is looked at and from where: shapes, their meshes, the camera.

pub mod bump;
pub mod camera;
pub mod file_tangents;
pub mod frame_groups;
pub mod import;
pub mod jet;
pub mod mesh;
pub mod model;
pub mod parametric;
pub mod reconstruction;
pub mod shapes;
pub mod soup;
pub mod sphere_orbit;
pub mod tangent_frame;
pub mod teapot;

pub use camera::Camera;
pub use import::ImportError;
pub use jet::Jet;
pub use mesh::{Mesh, Vertex};
pub use model::Model;
pub use reconstruction::Reconstruction;
pub use shapes::{Shape, ShapeKind};
pub use sphere_orbit::SphereOrbit;
pub use tangent_frame::FrameRule;
