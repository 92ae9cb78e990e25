//! Wavefront OBJ: y up, texture coordinates with v up; smooth where it brings no normals.

use std::path::Path;

use glam::{Vec2, Vec3};
use tobj::{LoadError, LoadOptions};

use super::{ImportError, Imported, MAX_TRIANGLES, name, soup};
use crate::scene::soup::{MissingNormals, Part};

/// Faces are fans of triangles, points and lines are passed over; materials are not read.
const OPTIONS: LoadOptions =
    LoadOptions { single_index: true, triangulate: true, ignore_points: true, ignore_lines: true };

/// Reads an OBJ file's bytes.
pub fn read(path: &Path, mut bytes: &[u8]) -> Result<Imported, ImportError> {
    let faces = bytes.split(|&byte| byte == b'\n').filter(|line| line.trim_ascii_start().starts_with(b"f ")).count();
    if faces == 0 && !bytes.trim_ascii().is_ascii() {
        return Err(ImportError::UnknownFormat { name: name(path) });
    }
    if faces > MAX_TRIANGLES {
        return Err(ImportError::TooManyTriangles { name: name(path), triangles: faces });
    }
    let without_materials = |_: &Path| Ok(Default::default());
    let (models, _) = tobj::load_obj_buf(&mut bytes, &OPTIONS, without_materials).map_err(|error| match error {
        LoadError::UnrecognizedCharacter => ImportError::UnknownFormat { name: name(path) },
        error => ImportError::Damaged { name: name(path), format: "OBJ", cause: error.to_string() },
    })?;
    let parts = models.into_iter().map(|model| part(&model.mesh)).collect();
    Ok(Imported { soup: soup(path, parts, MissingNormals::Smooth)?, ..Imported::default() })
}

fn part(mesh: &tobj::Mesh) -> Part {
    Part {
        positions: triples(&mesh.positions).map(Vec3::from).collect(),
        normals: triples(&mesh.normals).map(Vec3::from).collect(),
        uvs: mesh.texcoords.chunks_exact(2).map(|uv| Vec2::new(uv[0], 1.0 - uv[1])).collect(),
        tangents: Vec::new(),
        triangles: triples(&mesh.indices).collect(),
    }
}

fn triples<T: Copy>(values: &[T]) -> impl Iterator<Item = [T; 3]> {
    values.chunks_exact(3).map(|triple| [triple[0], triple[1], triple[2]])
}
