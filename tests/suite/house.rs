//! The house keeps its plan: who may import whom, who may know the window and the GPU, and where files stand.
//!
//! The plan is described in the documentation of `lib.rs`; here it is held against the sources themselves.

mod source;

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use source::{Mention, mentions};

/// Every module at the crate's root and its layer. A module imports its own layer and lower ones.
const LAYERS: &[(u8, &[&str])] = &[
    (0, &["sphere", "color"]),
    (1, &["image_io", "normal_map", "scene"]),
    (2, &["ndf", "brdf", "lighting"]),
    (3, &["filter", "lit_surface", "comparison"]),
    (4, &["reference", "export", "gpu"]),
    (5, &["jobs", "session", "measure"]),
    (6, &["app", "headless", "cli", "main"]),
];

/// The highest layer that knows neither the GPU nor the window.
const HIGHEST_PURE_LAYER: u8 = 3;

/// The files that hand our drawing to the window toolkit.
const BRIDGES: &[&str] = &["src/app/viewport.rs", "src/app/window.rs", "src/headless.rs"];

const TOP_LEVEL_FOLDERS: &[&str] = &["src", "shaders", "assets", "tests"];

/// The root module is the map, not a part of the house: it names every module.
const ROOT: &str = "";

struct SourceFile {
    /// From the top of the repository, with `/`.
    name: String,
    /// The module it holds: `["gpu", "frame"]`, empty for the root.
    module: Vec<String>,
    mentions: Vec<Mention>,
}

impl SourceFile {
    /// `name` from the top of the repository, as in `src/gpu/frame.rs`.
    fn new(name: &str, code: &str) -> Self {
        let stem = name.trim_start_matches("src/").trim_end_matches(".rs");
        let stem = stem.strip_suffix("/mod").unwrap_or(stem);
        let module: Vec<String> = stem.split('/').filter(|part| *part != "lib").map(str::to_owned).collect();
        let mentions = mentions(code, &module);
        Self { name: name.to_owned(), module, mentions }
    }

    /// The module at the crate's root that this file belongs to.
    fn top(&self) -> &str {
        self.module.first().map_or(ROOT, String::as_str)
    }

    fn complaint(&self, mention: &Mention, what: &str) -> String {
        format!("{}:{}: `{}`: {what}", self.name, mention.line, mention.path.join("::"))
    }

    /// A complaint for every mention that `is_wrong`.
    fn complaints(&self, what: &str, is_wrong: impl Fn(&[String]) -> bool) -> Vec<String> {
        self.mentions.iter().filter(|m| is_wrong(&m.path)).map(|m| self.complaint(m, what)).collect()
    }
}

// --- The laws, each a list of complaints -----------------------------------------------------------------------------

fn layer_of(module: &str) -> Option<u8> {
    LAYERS.iter().find(|(_, modules)| modules.contains(&module)).map(|(layer, _)| *layer)
}

fn without_a_place(file: &SourceFile) -> Vec<String> {
    let placed = file.top() == ROOT || layer_of(file.top()).is_some();
    if placed { Vec::new() } else { vec![format!("{}: `{}` has no place in the layer table", file.name, file.top())] }
}

fn imports_upwards(file: &SourceFile) -> Vec<String> {
    let Some(own) = layer_of(file.top()) else {
        return Vec::new();
    };
    let imports = file.mentions.iter().filter(|m| m.path.len() > 1 && m.path[0] == "crate");
    imports
        .filter_map(|mention| match layer_of(&mention.path[1]) {
            _ if mention.path[1] == file.top() => None,
            Some(other) if other <= own => None,
            Some(other) => {
                Some(file.complaint(mention, &format!("layer {other}, and `{}` is layer {own}", file.top())))
            }
            None => Some(file.complaint(mention, "no module of the layer table")),
        })
        .collect()
}

fn knows_gpu_or_window_and_should_not(file: &SourceFile) -> Vec<String> {
    let pure = layer_of(file.top()).is_some_and(|layer| layer <= HIGHEST_PURE_LAYER) || file.top() == "reference";
    let mut complaints = Vec::new();
    if pure {
        let what = "layers 0 to 3 and `reference` know neither wgpu nor egui";
        complaints
            .extend(file.complaints(what, |path| path.iter().any(|word| is_gpu_crate(word) || is_window_crate(word))));
    }
    if file.top() == "gpu" {
        complaints.extend(file.complaints("`gpu` knows no egui", |path| path.iter().any(|word| is_window_crate(word))));
    }
    if !BRIDGES.contains(&file.name.as_str()) {
        let what = format!("only {} touch egui_wgpu", BRIDGES.join(", "));
        complaints.extend(file.complaints(&what, |path| path.iter().any(|word| word == "egui_wgpu")));
    }
    complaints
}

fn is_gpu_crate(word: &str) -> bool {
    matches!(word, "wgpu" | "egui_wgpu" | "naga")
}

/// All of egui's family; `egui_wgpu` has a law of its own.
fn is_window_crate(word: &str) -> bool {
    matches!(word, "egui" | "eframe" | "winit") || (word.starts_with("egui_") && word != "egui_wgpu")
}

fn starts_threads_and_should_not(file: &SourceFile) -> Vec<String> {
    if file.top() == "jobs" {
        return Vec::new();
    }
    file.complaints("only `jobs` starts threads", |path| {
        path.iter().any(|word| word == "ThreadPoolBuilder")
            || path.windows(2).any(|pair| {
                matches!(
                    (pair[0].as_str(), pair[1].as_str()),
                    ("thread", "spawn" | "scope" | "Builder") | ("rayon", "spawn" | "spawn_fifo" | "spawn_broadcast")
                )
            })
    })
}

/// Folders that are no part of the house; those that git ignores are nobody's business.
fn folders_too_many(folders: &BTreeSet<String>, gitignore: &str) -> Vec<String> {
    let ignored: Vec<&str> = gitignore.lines().map(|line| line.trim().trim_matches('/')).collect();
    folders
        .iter()
        .map(String::as_str)
        .filter(|name| !name.starts_with('.') && *name != "target")
        .filter(|name| !TOP_LEVEL_FOLDERS.contains(name) && !ignored.contains(name))
        .map(|name| format!("{name}/: the folders at the top are {}", TOP_LEVEL_FOLDERS.join(", ")))
        .collect()
}

fn without_a_twin(shaders: &BTreeSet<String>, passes: &BTreeSet<String>) -> Vec<String> {
    let no_pass = shaders.difference(passes).map(|n| format!("shaders/{n}.wgsl has no src/gpu/passes/{n}.rs"));
    let no_shader = passes.difference(shaders).map(|n| format!("src/gpu/passes/{n}.rs has no shaders/{n}.wgsl"));
    no_pass.chain(no_shader).collect()
}

// --- The house as it stands ------------------------------------------------------------------------------------------

fn top() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// What a folder holds, sorted; nothing if there is no such folder.
fn entries(folder: &Path) -> Vec<PathBuf> {
    let Ok(listing) = fs::read_dir(folder) else {
        return Vec::new();
    };
    let mut paths: Vec<PathBuf> = listing.map(|entry| entry.expect("a readable entry").path()).collect();
    paths.sort();
    paths
}

fn file_name(path: &Path) -> String {
    path.file_name().expect("a name").to_string_lossy().into_owned()
}

fn source_files() -> Vec<SourceFile> {
    let mut files = Vec::new();
    let mut folders = vec![("src".to_owned(), top().join("src"))];
    while let Some((folder_name, folder)) = folders.pop() {
        for path in entries(&folder) {
            let name = format!("{folder_name}/{}", file_name(&path));
            if path.is_dir() {
                folders.push((name, path));
            } else if name.ends_with(".rs") {
                files.push(SourceFile::new(&name, &fs::read_to_string(&path).expect("a readable source")));
            }
        }
    }
    files
}

/// The names, without ending, of the files in `folder` that end in `.ending`.
fn stems(folder: &str, ending: &str) -> BTreeSet<String> {
    let names = entries(&top().join(folder)).into_iter().map(|path| file_name(&path));
    names.filter_map(|name| name.strip_suffix(&format!(".{ending}")).map(str::to_owned)).collect()
}

#[track_caller]
fn assert_kept(law: &str, complaints: &[String]) {
    assert!(complaints.is_empty(), "{law}:\n  {}\n", complaints.join("\n  "));
}

#[track_caller]
fn assert_kept_by_all(law: &str, complaints: impl Fn(&SourceFile) -> Vec<String>) {
    let files = source_files();
    assert!(files.iter().any(|file| file.name == "src/lib.rs"), "the sources were not found");
    assert_kept(law, &files.iter().flat_map(complaints).collect::<Vec<_>>());
}

#[test]
fn every_module_has_its_place_in_the_layer_table() {
    assert_kept_by_all("Give the module a layer, in LAYERS and in the documentation of lib.rs", without_a_place);
}

#[test]
fn a_module_imports_no_higher_layer() {
    assert_kept_by_all("A module imports its own layer and lower ones", imports_upwards);
}

#[test]
fn gpu_and_window_are_known_only_where_they_belong() {
    assert_kept_by_all("Keep wgpu and egui where they belong", knows_gpu_or_window_and_should_not);
}

#[test]
fn only_jobs_starts_threads() {
    assert_kept_by_all("Work in the background is a job", starts_threads_and_should_not);
}

#[test]
fn the_top_level_holds_no_other_folders() {
    let folders = entries(top()).into_iter().filter(|path| path.is_dir()).map(|path| file_name(&path)).collect();
    let gitignore = fs::read_to_string(top().join(".gitignore")).unwrap_or_default();
    assert_kept("A new thing goes into a folder that is there", &folders_too_many(&folders, &gitignore));
}

#[test]
fn every_pass_stands_beside_its_shader() {
    let mut passes = stems("src/gpu/passes", "rs");
    passes.remove("mod");
    assert_kept("A pass and its shader have one name", &without_a_twin(&stems("shaders", "wgsl"), &passes));
}

// --- The laws see what they are for ----------------------------------------------------------------------------------

#[track_caller]
fn assert_seen(law: impl Fn(&SourceFile) -> Vec<String>, name: &str, code: &str, complaint: &str) {
    let complaints = law(&SourceFile::new(name, code));
    assert!(complaints.iter().any(|found| found.contains(complaint)), "{code:?} in {name} gave {complaints:?}");
}

#[track_caller]
fn assert_unseen(law: impl Fn(&SourceFile) -> Vec<String>, name: &str, code: &str) {
    assert_kept(code, &law(&SourceFile::new(name, code)));
}

#[test]
fn a_planted_import_upwards_is_seen() {
    let seen = |name, code, complaint| assert_seen(imports_upwards, name, code, complaint);
    seen("src/sphere/vmf.rs", "\nuse crate::filter::Method;", "src/sphere/vmf.rs:2: `crate::filter::Method`: layer 3");
    seen("src/ndf.rs", "use crate::{color, gpu::Frame};", "`crate::gpu::Frame`");
    seen("src/filter/vmf/em.rs", "fn f() { crate::session::open() }", "`crate::session::open`");
    seen("src/filter/lean.rs", "use super::super::app::panels;", "`crate::app::panels`");
    seen("src/session.rs", "use crate::elsewhere::X;", "no module of the layer table");
}

#[test]
fn an_import_sideways_downwards_or_in_a_comment_is_allowed() {
    let code = "use crate::{sphere, gpu::Frame, export::{self, Png}}; // crate::app";
    assert_unseen(imports_upwards, "src/reference/shade.rs", code);
    assert_unseen(imports_upwards, "src/lib.rs", "pub use crate::session::Session;");
}

#[test]
fn a_planted_module_without_a_place_is_seen() {
    assert_seen(without_a_place, "src/utils/mod.rs", "", "`utils` has no place");
    assert_unseen(without_a_place, "src/main.rs", "");
}

#[test]
fn a_planted_gpu_or_window_is_seen() {
    let seen = |name, code| assert_seen(knows_gpu_or_window_and_should_not, name, code, name);
    seen("src/filter/mod.rs", "use wgpu::Buffer;");
    seen("src/sphere/mod.rs", "fn f(ui: &mut egui::Ui) {}");
    seen("src/reference/shade.rs", "use eframe::egui;");
    seen("src/gpu/frame.rs", "use egui::Color32;");
    seen("src/gpu/frame.rs", "use egui_wgpu::wgpu;");
    seen("src/app/panels/map.rs", "use eframe::egui_wgpu::CallbackTrait;");
    assert_unseen(knows_gpu_or_window_and_should_not, "src/app/viewport.rs", "use egui_wgpu::CallbackTrait;");
    assert_unseen(knows_gpu_or_window_and_should_not, "src/gpu/frame.rs", "use wgpu::Device; // not egui's");
}

#[test]
fn a_planted_thread_is_seen() {
    let seen = |code| assert_seen(starts_threads_and_should_not, "src/app/logic.rs", code, "only `jobs`");
    seen("fn f() { std::thread::spawn(|| {}); }");
    seen("use std::{fs, thread::{self, Builder}};");
    seen("fn f() { thread::Builder::new(); }");
    seen("fn f() { rayon::ThreadPoolBuilder::new(); }");
    seen("use rayon::spawn;");
    assert_unseen(starts_threads_and_should_not, "src/jobs.rs", "fn f() { std::thread::spawn(|| {}); }");
    assert_unseen(
        starts_threads_and_should_not,
        "src/session.rs",
        "fn f() { std::thread::sleep(x); items.par_iter(); }",
    );
}

#[test]
fn a_planted_folder_is_seen_unless_git_ignores_it() {
    let folders = |names: &[&str]| names.iter().map(ToString::to_string).collect();
    assert_eq!(folders_too_many(&folders(&["src", ".git", "target", "docs"]), "").len(), 1);
    assert_kept("ignored", &folders_too_many(&folders(&["tests", "out"]), "/target\n/out/\n"));
}

#[test]
fn a_planted_pass_without_a_shader_is_seen() {
    let names = |names: &[&str]| names.iter().map(ToString::to_string).collect();
    assert_eq!(without_a_twin(&names(&["surface", "sphere"]), &names(&["surface", "compare"])).len(), 2);
    assert_kept("twins", &without_a_twin(&names(&["surface"]), &names(&["surface"])));
}
