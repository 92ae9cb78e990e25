//! glTF 2.0 and GLB: y up, texture coordinates with v down, flat where it brings no normals. Tangents are taken up where
//! there are normals too (Khronos 2021, section 3.7.2.1): the bitangent is `normal x tangent` times their w.
//!
//! Every triangle of the default scene is taken, each node in its place; a node that mirrors its mesh has its triangles
//! turned round, so that they still face outward. Lines, points, strips, skins and animation are passed over.

use std::collections::HashSet;
use std::path::Path;

use ::gltf::accessor::{DataType, Dimensions};
use ::gltf::buffer::{Data, Source};
use ::gltf::{Accessor, Document, Error, Gltf, Material, Node, Primitive, Semantic, image};
use glam::{Mat3, Mat4, Vec2, Vec3, Vec4, Vec4Swizzles};

use super::{ImportError, Imported, MAX_TRIANGLES, name, read_file, soup};
use crate::scene::soup::{MissingNormals, Part};

/// What a texture is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TextureRole {
    /// The normals.
    Normal,
    /// The colour.
    BaseColor,
}

/// A texture's file, as it stands in a glTF file or beside it.
#[derive(Clone, Debug, PartialEq)]
pub struct Texture {
    /// The image file's bytes.
    pub bytes: Vec<u8>,
    /// By how much the normals' x and y are to be multiplied; 1 for colours.
    pub scale: f32,
}

/// A primitive with the matrix that puts it in its place.
type Placed<'a> = (Primitive<'a>, Mat4);

/// Reads a glTF file's bytes, and the files that it is spread over.
pub fn read(path: &Path, bytes: &[u8]) -> Result<Imported, ImportError> {
    let Gltf { document, blob } = parse(path, bytes)?;
    let primitives = primitives(&document);
    let claimed = primitives.iter().map(|(primitive, _)| claimed_triangles(primitive));
    let triangles = claimed.fold(0, usize::saturating_add);
    if triangles > MAX_TRIANGLES {
        return Err(ImportError::TooManyTriangles { name: name(path), triangles });
    }
    let buffers = buffers(path, &document, blob)?;
    let parts: Result<Vec<Part>, ImportError> =
        primitives.iter().map(|(primitive, place)| part(path, primitive, *place, &buffers)).collect();
    let material = || primitives.iter().map(|(primitive, _)| primitive.material());
    let base_color = material().next().map(|material| material.pbr_metallic_roughness().base_color_factor());
    Ok(Imported {
        soup: soup(path, parts?, MissingNormals::Flat)?,
        base_color: base_color.map(|[r, g, b, _]| Vec3::new(r, g, b)).filter(|color| *color != Vec3::ONE),
        has_normal_map: material().any(|material| material.normal_texture().is_some()),
    })
}

/// The first texture of a role that the file's surface wears.
///
/// # Errors
/// One sentence that names the file and the cause.
pub fn texture(path: &Path, role: TextureRole) -> Result<Texture, ImportError> {
    let Gltf { document, blob } = parse(path, &read_file(path)?)?;
    let materials = primitives(&document).into_iter().map(|(primitive, _)| primitive.material());
    let found: Option<(image::Source<'_>, f32)> = match role {
        TextureRole::Normal => materials
            .filter_map(|material| material.normal_texture())
            .map(|normal| (normal.texture().source().source(), normal.scale()))
            .next(),
        TextureRole::BaseColor => materials
            .filter_map(|material| material.pbr_metallic_roughness().base_color_texture())
            .map(|color| (color.texture().source().source(), 1.0))
            .next(),
    };
    let what = match role {
        TextureRole::Normal => "normal",
        TextureRole::BaseColor => "base colour",
    };
    let (source, scale) = found.ok_or_else(|| ImportError::NoTexture { name: name(path), what })?;
    let bytes = match source {
        image::Source::Uri { uri, .. } => part_of(path, Source::Uri(uri), &mut None)?,
        image::Source::View { view, .. } => {
            let buffers = buffers(path, &document, blob)?;
            let end = view.offset().saturating_add(view.length());
            let bytes = buffers.get(view.buffer().index()).and_then(|buffer| buffer.get(view.offset()..end));
            bytes.ok_or_else(|| damaged(path, "a texture reaches beyond its buffer"))?.to_vec()
        }
    };
    Ok(Texture { bytes, scale })
}

fn parse(path: &Path, bytes: &[u8]) -> Result<Gltf, ImportError> {
    Gltf::from_slice(bytes).map_err(|error| damaged(path, &error.to_string()))
}

fn damaged(path: &Path, cause: &str) -> ImportError {
    ImportError::Damaged { name: name(path), format: "glTF", cause: cause.trim_end_matches(';').to_owned() }
}

/// Every triangle list of the default scene, or of the first where none is the default.
fn primitives(document: &Document) -> Vec<Placed<'_>> {
    let Some(scene) = document.default_scene().or_else(|| document.scenes().next()) else { return Vec::new() };
    let mut found = Vec::new();
    // A node has one parent; a file that says otherwise must not lead round in circles.
    let mut visited = HashSet::new();
    let mut open: Vec<(Node<'_>, Mat4)> = scene.nodes().map(|node| (node, Mat4::IDENTITY)).collect();
    while let Some((node, parent)) = open.pop() {
        if !visited.insert(node.index()) {
            continue;
        }
        let place = parent * Mat4::from_cols_array_2d(&node.transform().matrix());
        let triangles = node.mesh().into_iter().flat_map(|mesh| mesh.primitives());
        let triangles = triangles.filter(|primitive| primitive.mode() == ::gltf::mesh::Mode::Triangles);
        found.extend(triangles.map(|primitive| (primitive, place)));
        open.extend(node.children().map(|child| (child, place)));
    }
    found
}

fn claimed_triangles(primitive: &Primitive<'_>) -> usize {
    let corners = primitive.indices().or_else(|| primitive.get(&Semantic::Positions));
    // Vertices that no triangle uses are read too.
    let vertices = primitive.get(&Semantic::Positions).map_or(0, |accessor| accessor.count());
    corners.map_or(0, |accessor| accessor.count() / 3).max(vertices / 3)
}

fn buffers(path: &Path, document: &Document, mut blob: Option<Vec<u8>>) -> Result<Vec<Data>, ImportError> {
    let read = |buffer: ::gltf::Buffer<'_>| {
        let data = part_of(path, buffer.source(), &mut blob)?;
        if data.len() < buffer.length() {
            return Err(damaged(path, &format!("a buffer holds {} of {} bytes", data.len(), buffer.length())));
        }
        Ok(Data(data))
    };
    document.buffers().map(read).collect()
}

/// The bytes that a source names: inside the file, encoded in its text, or in a file beside it.
fn part_of(path: &Path, source: Source<'_>, blob: &mut Option<Vec<u8>>) -> Result<Vec<u8>, ImportError> {
    let part = match source {
        Source::Uri(uri) if !uri.starts_with("data:") => uri.to_owned(),
        _ => "its own data".to_owned(),
    };
    let folder = path.parent().unwrap_or(Path::new(""));
    let read = Data::from_source_and_blob(source, Some(folder), blob);
    read.map(|data| data.0).map_err(|error| {
        let cause = match error {
            Error::Io(error) if error.kind() == std::io::ErrorKind::NotFound => "it does not exist".to_owned(),
            error => error.to_string(),
        };
        ImportError::MissingPart { name: name(path), part, cause }
    })
}

fn part(path: &Path, primitive: &Primitive<'_>, place: Mat4, buffers: &[Data]) -> Result<Part, ImportError> {
    let uv_set = uv_set(&primitive.material());
    let floats = |semantic: Semantic, dimensions| {
        let accessor = primitive.get(&semantic);
        accessor.is_none_or(|accessor| is_sound(&accessor, dimensions, &[DataType::F32]))
    };
    let uvs_are_sound = primitive
        .get(&Semantic::TexCoords(uv_set))
        .is_none_or(|accessor| is_sound(&accessor, Dimensions::Vec2, &[DataType::F32, DataType::U8, DataType::U16]));
    let indices_are_sound = primitive
        .indices()
        .is_none_or(|accessor| is_sound(&accessor, Dimensions::Scalar, &[DataType::U8, DataType::U16, DataType::U32]));
    let vectors_are_sound = floats(Semantic::Positions, Dimensions::Vec3)
        && floats(Semantic::Normals, Dimensions::Vec3)
        && floats(Semantic::Tangents, Dimensions::Vec4);
    if !(vectors_are_sound && uvs_are_sound && indices_are_sound) {
        return Err(damaged(path, "an accessor is of a type that its use does not allow"));
    }
    let reader = primitive.reader(|buffer| buffers.get(buffer.index()).map(|data| &data.0[..]));
    let beyond = || damaged(path, "an accessor reaches beyond its buffer");
    let positions: Vec<[f32; 3]> = reader.read_positions().ok_or_else(beyond)?.collect();
    let normals: Vec<[f32; 3]> = reader.read_normals().map(Iterator::collect).unwrap_or_default();
    let tangents: Vec<Vec4> = reader.read_tangents().map(|all| all.map(Vec4::from).collect()).unwrap_or_default();
    let uvs = reader.read_tex_coords(uv_set).map(|uvs| uvs.into_f32().map(Vec2::from).collect());
    let indices: Vec<u32> = match reader.read_indices() {
        Some(indices) => indices.into_u32().collect(),
        None if primitive.indices().is_some() => return Err(beyond()),
        None => (0..positions.len() as u32).collect(),
    };
    let is_mirrored = place.determinant() < 0.0;
    let normal_place = cofactor(Mat3::from_mat4(place)) * if is_mirrored { -1.0 } else { 1.0 };
    // Tangents lie in the surface and go along with it; a mirror turns the side of the bitangent.
    let side = if is_mirrored { -1.0 } else { 1.0 };
    let placed = |t: Vec4| place.transform_vector3(t.xyz()).extend(side * t.w);
    let corners = indices.chunks_exact(3).map(|c| if is_mirrored { [c[0], c[2], c[1]] } else { [c[0], c[1], c[2]] });
    Ok(Part {
        triangles: corners.collect(),
        positions: positions.into_iter().map(|p| place.transform_point3(p.into())).collect(),
        normals: normals.into_iter().map(|n| normal_place * Vec3::from(n)).collect(),
        uvs: uvs.unwrap_or_default(),
        tangents: tangents.into_iter().map(placed).collect(),
    })
}

/// The inverse transposed times the determinant, which takes normals along where a node flattens its mesh, too.
fn cofactor(m: Mat3) -> Mat3 {
    Mat3::from_cols(m.y_axis.cross(m.z_axis), m.z_axis.cross(m.x_axis), m.x_axis.cross(m.y_axis))
}

/// Which of the texture coordinates the map is laid by.
fn uv_set(material: &Material<'_>) -> u32 {
    material.normal_texture().map_or(0, |texture| texture.tex_coord())
}

/// True where the reader may be trusted with an accessor: it checks bounds, but takes type and stride as given.
fn is_sound(accessor: &Accessor<'_>, dimensions: Dimensions, types: &[DataType]) -> bool {
    let stride_holds = accessor.view().and_then(|view| view.stride()).is_none_or(|stride| stride >= accessor.size());
    let sparse_holds = accessor.sparse().is_none_or(|sparse| sparse.count() > 0);
    let type_holds = accessor.dimensions() == dimensions && types.contains(&accessor.data_type());
    accessor.count() > 0 && type_holds && stride_holds && sparse_holds
}
