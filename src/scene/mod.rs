//! What is looked at and from where: shapes, their meshes, the camera.

pub mod camera;
pub mod mesh;
pub mod shapes;
pub mod sphere_orbit;

pub use camera::Camera;
pub use mesh::{Mesh, Vertex};
pub use shapes::{Shape, ShapeKind};
pub use sphere_orbit::SphereOrbit;
