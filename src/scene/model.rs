//! A mesh that was read from a file, ready to be drawn.

use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

use glam::Vec3;

use super::import::{self, ImportError};
use super::mesh::Mesh;
use super::soup::Soup;
use super::tangent_frame::FrameRule;

/// A mesh, and what its file says of its material.
#[derive(Clone, Debug)]
pub struct Model {
    /// Where it was read from.
    pub path: PathBuf,
    /// Its triangles, within the unit sphere, z up.
    pub soup: Arc<Soup>,
    /// The mesh last asked for.
    framed: Arc<Mutex<Framed>>,
    /// Linear RGB that the file gives the whole surface.
    pub base_color: Option<Vec3>,
    /// True where the file brings a normal texture, which is then the map.
    pub has_normal_map: bool,
    /// What was odd about the file, each a sentence without a full stop.
    pub warnings: Vec<String>,
}

/// The triangles with a rule's frames.
#[derive(Clone, Debug)]
struct Framed {
    rule: FrameRule,
    mesh: Arc<Mesh>,
    splits: usize,
}

impl Framed {
    fn new(soup: &Soup, rule: FrameRule) -> Self {
        let mesh = rule.mesh(soup);
        Self { rule, splits: mesh.splits(), mesh: Arc::new(mesh) }
    }
}

/// Two models are the same where they are one and the same: comparing half a million vertices is not worth it.
impl PartialEq for Model {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.soup, &other.soup)
    }
}

impl Model {
    /// Reads an OBJ, glTF or GLB file.
    ///
    /// # Errors
    /// One sentence that names the file and the cause.
    pub fn read(path: &Path) -> Result<Self, ImportError> {
        let imported = import::read(path)?;
        let mut warnings = Vec::new();
        if imported.soup.dropped > 0 {
            let (dropped, all) = (imported.soup.dropped, imported.soup.dropped + imported.soup.triangles.len());
            warnings.push(format!("{dropped} of {all} triangles have no area and were left out"));
        }
        let framed = Framed::new(&imported.soup, FrameRule::default());
        Ok(Self {
            path: path.to_owned(),
            soup: Arc::new(imported.soup),
            framed: Arc::new(Mutex::new(framed)),
            base_color: imported.base_color,
            has_normal_map: imported.has_normal_map,
            warnings,
        })
    }

    /// The triangles with a rule's frames.
    pub fn mesh(&self, rule: FrameRule) -> Arc<Mesh> {
        self.framed(rule).mesh
    }

    /// Vertices that differ from another in their frame alone, under a rule.
    pub fn splits(&self, rule: FrameRule) -> usize {
        self.framed(rule).splits
    }

    /// Those of the rule asked for last are kept.
    fn framed(&self, rule: FrameRule) -> Framed {
        let mut kept = self.framed.lock().unwrap_or_else(PoisonError::into_inner);
        if kept.rule != rule {
            *kept = Framed::new(&self.soup, rule);
        }
        kept.clone()
    }

    /// The file's name.
    pub fn name(&self) -> String {
        self.path
            .file_name()
            .map_or_else(|| self.path.display().to_string(), |name| name.to_string_lossy().into_owned())
    }
}
