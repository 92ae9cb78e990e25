//! Bad mesh files: one sentence that names file and cause, and nothing that was open is lost.

use std::path::Path;
use std::sync::Arc;
use std::time::Duration;

use ndf_inspector::normal_map::procedural;
use ndf_inspector::scene::{FrameRule, Model, ShapeKind};
use ndf_inspector::session::Session;
use serde_json::json;

use super::files::{Roof, write_glb};

/// The sentence that refuses a file of this content.
fn sentence(name: &str, content: impl AsRef<[u8]>) -> String {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join(name);
    std::fs::write(&path, content).expect("written");
    refusal(&path)
}

fn refusal(path: &Path) -> String {
    let sentence = Model::read(path).expect_err("not sound").to_string();
    let name = path.display().to_string();
    assert!(sentence.starts_with(&format!("'{name}'")) && !sentence.contains('\n'), "{sentence}");
    sentence.replace(&name, path.file_name().expect("a name").to_str().expect("text"))
}

const TRIANGLE: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\n";

#[test]
fn a_bad_obj_is_refused_in_one_sentence() {
    assert_eq!(sentence("a.obj", ""), "'a.obj' is empty");
    assert_eq!(
        sentence("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"),
        "'a.obj' has no texture coordinates, by which the map would lie on it"
    );
    assert_eq!(
        sentence("a.obj", format!("{TRIANGLE}f 1/1 2/2 3\n")),
        "'a.obj' has no texture coordinates, by which the map would lie on it"
    );
    assert_eq!(
        sentence("a.obj", "v 0 0 0\nv 1 1 1\nv 2 2 2\nvt 0 0\nvt 1 0\nvt 0 1\nf 1/1 2/2 3/3\n"),
        "'a.obj' has no surface: none of its triangles has an area"
    );
    assert_eq!(
        sentence("a.obj", "v 0 0 nan\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nf 1/1 2/2 3/3\n"),
        "'a.obj' holds positions that are not finite"
    );
    assert_eq!(
        sentence("a.obj", format!("{TRIANGLE}f 1/1 2/2 9/3\n")),
        "'a.obj' is damaged: its OBJ data cannot be decoded (face vertex index out of bounds)"
    );
    assert_eq!(sentence("a.obj", TRIANGLE), "'a.obj' holds no triangles");
    assert_eq!(
        sentence("a.obj", [0x89, b'P', b'N', b'G', 0, 255]),
        "'a.obj' is not a mesh that is read (OBJ, glTF and GLB are)"
    );
    assert_eq!(refusal(Path::new("no/such.obj")), "'such.obj' does not exist");
    assert_eq!(refusal(Path::new("tests")), "'tests' is a folder, not a mesh file");
}

#[test]
fn an_obj_of_more_triangles_than_are_read_is_refused_before_it_is_decoded() {
    let text = TRIANGLE.to_owned() + &"f 1 2 3\n".repeat(5_000_001);
    assert_eq!(sentence("a.obj", text), "'a.obj' claims 5000001 triangles; at most 5000000 are read");
}

/// The sentence that refuses the roof's file after `change`.
fn gltf_sentence(change: impl FnOnce(&mut serde_json::Value)) -> String {
    let folder = tempfile::tempdir().expect("a folder");
    let roof = Roof::new(4);
    let mut document = roof.document();
    change(&mut document);
    refusal(&write_glb(folder.path(), &document, &roof.buffer()))
}

#[test]
fn a_bad_gltf_is_refused_in_one_sentence() {
    let missing = gltf_sentence(|document| document["buffers"][0]["uri"] = json!("lost.bin"));
    assert_eq!(missing, "'roof.glb' needs 'lost.bin', which cannot be read: it does not exist");
    let claimed = gltf_sentence(|document| document["accessors"][3]["count"] = json!(30_000_000));
    assert_eq!(claimed, "'roof.glb' claims 10000000 triangles; at most 5000000 are read");
    let beyond = gltf_sentence(|document| document["accessors"][3]["count"] = json!(3000));
    assert_eq!(
        beyond,
        "'roof.glb' is damaged: its glTF data cannot be decoded (an accessor reaches beyond its buffer)"
    );
    let without = gltf_sentence(|document| {
        let attributes = document["meshes"][0]["primitives"][0]["attributes"].as_object_mut().expect("attributes");
        attributes.remove("TEXCOORD_0");
    });
    assert_eq!(without, "'roof.glb' has no texture coordinates, by which the map would lie on it");
    let flat = gltf_sentence(|document| document["accessors"][0]["type"] = json!("VEC2"));
    assert!(flat.ends_with("(an accessor is of a type that its use does not allow)"), "{flat}");
    let short = gltf_sentence(|document| document["buffers"][0]["byteLength"] = json!(1_000_000));
    assert!(short.contains("a buffer holds"), "{short}");
    let empty = gltf_sentence(|document| document["scenes"] = json!([{"nodes": []}]));
    assert_eq!(empty, "'roof.glb' holds no triangles");
    assert!(sentence("a.glb", b"glTF\x02\0\0\0\xff\0\0\0").starts_with("'a.glb' is damaged"));
    assert!(sentence("a.gltf", "{\"asset\": ").starts_with("'a.gltf' is damaged"));
}

#[test]
fn a_scene_whose_nodes_lead_round_in_circles_ends() {
    let folder = tempfile::tempdir().expect("a folder");
    let roof = Roof::new(4);
    let mut document = roof.document();
    document["nodes"] = json!([{"mesh": 0, "children": [1]}, {"children": [0]}]);
    let model = Model::read(&write_glb(folder.path(), &document, &roof.buffer())).expect("sound");
    assert_eq!(model.mesh(FrameRule::default()).indices.len(), 3 * roof.triangles.len());
}

#[test]
fn a_mesh_that_cannot_be_read_leaves_the_surface_as_it_is() {
    let folder = tempfile::tempdir().expect("a folder");
    let map = procedural::find("waves").expect("bundled").make(16);
    let mut session = Session::with_map(map, Arc::new(|| {}));
    session.surface.shape.kind = ShapeKind::Torus;
    let before = session.surface.clone();
    let mut open = |path: &Path| {
        session.open_mesh(path.to_owned());
        while session.is_opening() {
            session.wait(Duration::from_millis(5));
        }
        (session.surface.clone(), session.take_messages())
    };
    let (surface, messages) = open(&folder.path().join("missing.glb"));
    assert_eq!(surface, before);
    assert!(messages.len() == 1 && messages[0].is_error, "{messages:?}");
    let (surface, messages) = open(&Roof::new(4).write_obj(folder.path()));
    assert!(messages.is_empty() && surface.shape.kind == ShapeKind::Mesh && surface.shape.model.is_some());
}
