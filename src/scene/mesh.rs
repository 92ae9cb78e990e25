//! Triangle meshes.
/// Mesh.
#[derive(Clone, Debug)]
pub struct Mesh;
