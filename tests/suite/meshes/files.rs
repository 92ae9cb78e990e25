//! Mesh files that the tests write, and that those which are sound say the same.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use glam::{Vec2, Vec3, Vec4};
use ndf_inspector::image_io::png_rgb8;
use ndf_inspector::normal_map::MapOptions;
use ndf_inspector::scene::{FrameRule, ImportError, Mesh, Model, import};
use ndf_inspector::session::{MapRequest, opening};
use serde_json::{Value, json};

/// A curved roof over x in -1..1, facing up, whose right half wears the left half's texture, mirrored.
pub struct Roof {
    pub positions: Vec<Vec3>,
    pub normals: Vec<Vec3>,
    /// v down.
    pub uvs: Vec<Vec2>,
    pub triangles: Vec<[u32; 3]>,
}

impl Roof {
    pub fn new(columns: u32) -> Self {
        let mut roof = Self { positions: vec![], normals: vec![], uvs: vec![], triangles: vec![] };
        let along = |i: u32| i as f32 / columns as f32 * 2.0 - 1.0;
        for (row, column) in (0..=columns).flat_map(|row| (0..=columns).map(move |column| (row, column))) {
            let (x, z) = (along(column), along(row));
            roof.positions.push(Vec3::new(x, -0.3 * x * x, z));
            roof.normals.push(Vec3::new(0.6 * x, 1.0, 0.0).normalize());
            roof.uvs.push(Vec2::new(1.0 - x.abs(), 0.5 + 0.5 * z));
        }
        for (row, column) in (0..columns).flat_map(|row| (0..columns).map(move |column| (row, column))) {
            let a = row * (columns + 1) + column;
            let (b, c, d) = (a + 1, a + columns + 1, a + columns + 2);
            let both = if column < columns / 2 { [[a, c, d], [a, d, b]] } else { [[a, c, b], [b, c, d]] };
            roof.triangles.extend(both);
        }
        roof
    }

    pub fn write_obj(&self, folder: &Path) -> PathBuf {
        let mut text = String::from("# a roof\n");
        self.positions.iter().for_each(|p| text += &format!("v {} {} {}\n", p.x, p.y, p.z));
        self.normals.iter().for_each(|n| text += &format!("vn {} {} {}\n", n.x, n.y, n.z));
        self.uvs.iter().for_each(|uv| text += &format!("vt {} {}\n", uv.x, 1.0 - uv.y));
        for corners in &self.triangles {
            let [a, b, c] = corners.map(|index| index + 1);
            text += &format!("f {a}/{a}/{a} {b}/{b}/{b} {c}/{c}/{c}\n");
        }
        let path = folder.join("roof.obj");
        std::fs::write(&path, text).expect("written");
        path
    }

    /// The buffer of a glTF file: positions, normals, texture coordinates, indices.
    pub fn buffer(&self) -> Vec<u8> {
        let vectors = self.positions.iter().chain(&self.normals).flat_map(glam::Vec3::to_array);
        let uvs = self.uvs.iter().flat_map(glam::Vec2::to_array);
        let floats = vectors.chain(uvs).flat_map(f32::to_le_bytes);
        floats.chain(self.triangles.iter().flatten().flat_map(|index| index.to_le_bytes())).collect()
    }

    /// The text of a glTF file whose buffer is the first.
    pub fn document(&self) -> Value {
        let (vertices, corners) = (self.positions.len(), 3 * self.triangles.len());
        let view = |offset: usize, length: usize| json!({"buffer": 0, "byteOffset": offset, "byteLength": length});
        let floats = |view: usize, kind: &str| {
            json!({"bufferView": view, "componentType": 5126, "count": vertices, "type": kind,
                   "min": [-9.0, -9.0, -9.0], "max": [9.0, 9.0, 9.0]})
        };
        json!({
            "asset": {"version": "2.0"},
            "scenes": [{"nodes": [0]}],
            "nodes": [{"mesh": 0}],
            "meshes": [{"primitives": [
                {"attributes": {"POSITION": 0, "NORMAL": 1, "TEXCOORD_0": 2}, "indices": 3}]}],
            "buffers": [{"byteLength": 32 * vertices + 4 * corners}],
            "bufferViews": [
                view(0, 12 * vertices), view(12 * vertices, 12 * vertices), view(24 * vertices, 8 * vertices),
                view(32 * vertices, 4 * corners)],
            "accessors": [
                floats(0, "VEC3"), floats(1, "VEC3"), floats(2, "VEC2"),
                {"bufferView": 3, "componentType": 5125, "count": corners, "type": "SCALAR"}],
        })
    }

    pub fn write_glb(&self, folder: &Path) -> PathBuf {
        write_glb(folder, &self.document(), &self.buffer())
    }
}

/// Writes a GLB file: a header, the text, the buffer, each padded to four bytes.
pub fn write_glb(folder: &Path, document: &Value, buffer: &[u8]) -> PathBuf {
    let padded = |mut bytes: Vec<u8>, with: u8| {
        bytes.resize(bytes.len().next_multiple_of(4), with);
        bytes
    };
    let text = padded(document.to_string().into_bytes(), b' ');
    let buffer = padded(buffer.to_vec(), 0);
    let mut glb = b"glTF".to_vec();
    let numbers = |values: &[u32]| values.iter().flat_map(|value| value.to_le_bytes()).collect::<Vec<u8>>();
    glb.extend(numbers(&[2, (12 + 8 + text.len() + 8 + buffer.len()) as u32]));
    glb.extend(numbers(&[text.len() as u32, 0x4E4F_534A]));
    glb.extend(text);
    glb.extend(numbers(&[buffer.len() as u32, 0x004E_4942]));
    glb.extend(buffer);
    let path = folder.join("roof.glb");
    std::fs::write(&path, glb).expect("written");
    path
}

fn mesh(model: &Model) -> Arc<Mesh> {
    model.mesh(FrameRule::default())
}

#[test]
fn obj_gltf_and_glb_say_the_same_of_one_mesh() {
    let folder = tempfile::tempdir().expect("a folder");
    let roof = Roof::new(8);
    let glb = Model::read(&roof.write_glb(folder.path())).expect("sound");
    let obj = Model::read(&roof.write_obj(folder.path())).expect("sound");
    let mut document = roof.document();
    document["buffers"][0]["uri"] = json!("roof data.bin".replace(' ', "%20"));
    std::fs::write(folder.path().join("roof data.bin"), roof.buffer()).expect("written");
    let path = folder.path().join("roof.gltf");
    std::fs::write(&path, document.to_string()).expect("written");
    let gltf = Model::read(&path).expect("sound");
    assert_eq!(mesh(&glb).indices.len(), 3 * roof.triangles.len());
    assert_eq!(mesh(&glb), mesh(&gltf));
    // Decimal digits bring f32 back whole, but 1 - (1 - v) does not.
    for ([a, b, c], [p, q, r]) in mesh(&glb).triangles().zip(mesh(&obj).triangles()) {
        for (one, other) in [(a, p), (b, q), (c, r)] {
            assert_eq!((one.position, one.normal), (other.position, other.normal));
            assert!((Vec2::from(one.uv) - Vec2::from(other.uv)).length() < 1e-6);
            assert!(one.along_u.iter().zip(other.along_u).all(|(x, y)| (x - y).abs() < 1e-4));
        }
    }
}

#[test]
fn a_node_that_mirrors_its_mesh_leaves_it_facing_outward() {
    let folder = tempfile::tempdir().expect("a folder");
    let roof = Roof::new(4);
    let mut document = roof.document();
    document["nodes"][0]["scale"] = json!([-2.0, 2.0, 2.0]);
    document["nodes"][0]["rotation"] = json!([0.0, 1.0, 0.0, 0.0]);
    let model = Model::read(&write_glb(folder.path(), &document, &roof.buffer())).expect("sound");
    for [a, b, c] in mesh(&model).triangles() {
        let [p, q, r] = [a, b, c].map(|v| Vec3::from(v.position));
        assert!((q - p).cross(r - p).dot(a.normal.into()) > 0.0);
        assert!(a.normal[2] > 0.5, "the roof still faces up");
    }
}

/// The roof as a GLB file with tangents, which its node puts in its place.
fn with_tangents(folder: &Path, roof: &Roof, tangents: &[Vec4], node: &[(&str, Value)]) -> Result<Model, ImportError> {
    let (mut document, mut buffer) = (roof.document(), roof.buffer());
    let at = buffer.len();
    buffer.extend(tangents.iter().flat_map(glam::Vec4::to_array).flat_map(f32::to_le_bytes));
    document["buffers"][0]["byteLength"] = json!(buffer.len());
    let views = document["bufferViews"].as_array_mut().expect("views");
    views.push(json!({"buffer": 0, "byteOffset": at, "byteLength": buffer.len() - at}));
    let accessors = document["accessors"].as_array_mut().expect("accessors");
    accessors.push(json!({"bufferView": 4, "componentType": 5126, "count": tangents.len(), "type": "VEC4"}));
    document["meshes"][0]["primitives"][0]["attributes"]["TANGENT"] = json!(4);
    for (key, value) in node {
        document["nodes"][0][key] = value.clone();
    }
    Model::read(&write_glb(folder, &document, &buffer))
}

/// Along the surface, turned by 0.4 from growing x: what no rule would find. The bitangent on either side.
fn turned_tangents(roof: &Roof) -> Vec<Vec4> {
    let tangent = |(index, normal): (usize, &Vec3)| {
        let across = Vec3::Z.cross(*normal).normalize();
        let turned = 0.4_f32.cos() * across + 0.4_f32.sin() * normal.cross(across);
        turned.extend(if index % 3 == 0 { -1.0 } else { 1.0 })
    };
    roof.normals.iter().enumerate().map(tangent).collect()
}

#[test]
fn a_node_that_flattens_its_mesh_leaves_its_normals_across_it() {
    let folder = tempfile::tempdir().expect("a folder");
    let roof = Roof::new(4);
    let mut document = roof.document();
    document["nodes"][0]["scale"] = json!([1.0, 0.0, 1.0]);
    let model = Model::read(&write_glb(folder.path(), &document, &roof.buffer())).expect("sound");
    assert!(mesh(&model).vertices.iter().all(|vertex| vertex.normal == [0.0, 0.0, 1.0] && vertex.position[2] == 0.0));
}

#[test]
fn a_gltfs_own_tangents_are_taken_up_with_their_side_and_its_nodes_place() {
    let folder = tempfile::tempdir().expect("a folder");
    let roof = Roof::new(8);
    let tangents = turned_tangents(&roof);
    // From glTF's axes to the program's, after the node's own place.
    let z_up = |v: Vec3| Vec3::new(v.x, -v.z, v.y);
    for mirror in [1.0_f32, -1.0] {
        let place = |v: Vec3| z_up(v * Vec3::new(mirror, 1.0, 1.0));
        let node = [("scale", json!([2.0 * mirror, 2.0, 2.0]))];
        let model = with_tangents(folder.path(), &roof, &tangents, &node).expect("sound");
        let own = mesh(&model);
        for (corners, &[a, b, c]) in own.triangles().zip(&roof.triangles) {
            // A mirror turns triangles round.
            let indices = if mirror < 0.0 { [a, c, b] } else { [a, b, c] };
            for (vertex, index) in corners.into_iter().zip(indices.map(|index| index as usize)) {
                let (frame, tangent) = (vertex.tangents(glam::Mat2::IDENTITY), tangents[index]);
                // bitangent = w (normal x tangent) in the file's own space, which goes along with the mesh.
                let bitangent = tangent.w * roof.normals[index].cross(tangent.truncate());
                assert!((frame.tangent - place(tangent.truncate())).length() < 1e-4, "{mirror}: {vertex:?}");
                assert!((frame.bitangent - place(bitangent)).length() < 1e-4, "{mirror}: {vertex:?}");
            }
        }
        assert_ne!(own, model.mesh(FrameRule::MikkTSpace), "MikkTSpace finds others");
    }
}

#[test]
fn tangents_without_normals_are_passed_over_and_a_broken_one_is_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    let roof = Roof::new(4);
    let mut tangents = turned_tangents(&roof);
    let model = with_tangents(folder.path(), &roof, &tangents, &[]).expect("sound");
    assert!(model.soup.tangents.iter().all(|tangent| tangent.w != 0.0));
    let mut document = roof.document();
    let attributes = document["meshes"][0]["primitives"][0]["attributes"].as_object_mut().expect("attributes");
    attributes.remove("NORMAL");
    attributes.insert("TANGENT".to_owned(), json!(4));
    let accessors = document["accessors"].as_array_mut().expect("accessors");
    // Any numbers do: they are not read.
    accessors.push(json!({"bufferView": 0, "componentType": 5126, "count": roof.positions.len() / 2, "type": "VEC4"}));
    let flat = Model::read(&write_glb(folder.path(), &document, &roof.buffer())).expect("sound");
    assert_eq!(flat.mesh(FrameRule::File), flat.mesh(FrameRule::MikkTSpace));
    tangents[3].y = f32::NAN;
    let sentence = with_tangents(folder.path(), &roof, &tangents, &[]).expect_err("refused").to_string();
    assert!(sentence.ends_with("roof.glb' holds tangents that are not finite"), "{sentence}");
}

#[test]
fn a_gltfs_own_textures_scale_and_colour_are_taken_up() {
    let folder = tempfile::tempdir().expect("a folder");
    let roof = Roof::new(4);
    // A normal that leans to the right, and a red colour.
    let normals = png_rgb8(Path::new("a texture"), 2, 2, &[178, 128, 246].repeat(4)).expect("encoded");
    let color = png_rgb8(Path::new("a texture"), 2, 2, &[255, 0, 0].repeat(4)).expect("encoded");
    std::fs::write(folder.path().join("normals.png"), &normals).expect("written");
    let mut document = roof.document();
    let mut buffer = roof.buffer();
    let at = buffer.len();
    buffer.extend(&color);
    document["buffers"][0]["byteLength"] = json!(buffer.len());
    let views = document["bufferViews"].as_array_mut().expect("views");
    views.push(json!({"buffer": 0, "byteOffset": at, "byteLength": color.len()}));
    document["images"] = json!([{"uri": "normals.png"}, {"bufferView": 4, "mimeType": "image/png"}]);
    document["textures"] = json!([{"source": 0}, {"source": 1}]);
    document["materials"] = json!([{
        "normalTexture": {"index": 0, "scale": 0.5},
        "pbrMetallicRoughness": {"baseColorTexture": {"index": 1}, "baseColorFactor": [0.5, 0.25, 0.125, 1.0]}}]);
    document["meshes"][0]["primitives"][0]["material"] = json!(0);
    let path = write_glb(folder.path(), &document, &buffer);
    let model = Model::read(&path).expect("sound");
    assert!(model.has_normal_map);
    assert_eq!(model.base_color, Some(Vec3::new(0.5, 0.25, 0.125)));
    let request = MapRequest::File { path: path.clone(), options: MapOptions::default() };
    let map = opening::read(&request).expect("the textures are sound").map;
    let stored = Vec3::new(178.0, 128.0, 246.0) / 127.5 - 1.0;
    let expected = (stored * Vec3::new(0.5, 0.5, 1.0)).normalize();
    assert!((map.normal(0).expect("a normal") - expected).length() < 1e-6);
    assert!((map.precise_normal(0).expect("a normal").as_vec3() - expected).length() < 1e-6);
    assert!((map.color(0) - Vec3::X).length() < 1e-6);
    assert!(import::texture(&roof.write_glb(folder.path()), import::TextureRole::Normal).is_err());
}
