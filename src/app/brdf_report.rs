//! The effective BRDF of the selected texel: how far its lobes are from the truth, worked out in a job once per change
//! of what that depends on.

use std::sync::Arc;

use crate::brdf::{BlinnPhong, Brdf, Material};
use crate::filter::VmfFilter;
use crate::filter::brdf_error::texel_error;
use crate::filter::vmf::Rules;
use crate::jobs::Wake;
use crate::jobs::following::Following;
use crate::normal_map::pyramid::Texel;
use crate::session::Session;

/// The report on the selected texel's effective BRDF, kept up to date by [`BrdfReport::update`].
#[derive(Default)]
pub struct BrdfReport {
    following: Following<Key, Option<f64>>,
    error: Option<f64>,
}

/// What the figures depend on.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Key {
    revisions: [u64; 2],
    texel: Texel,
    material: MaterialKey,
}

/// What an effective BRDF depends on of the material: the BRDF that highlights have, and how it is convolved.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MaterialKey {
    /// The BRDF, which each method convolves with its normals.
    pub brdf: Brdf,
    /// How, where there is a choice.
    pub rules: Rules,
}

impl From<&Material> for MaterialKey {
    fn from(material: &Material) -> Self {
        let brdf = Brdf::BlinnPhong(BlinnPhong { shininess: f64::from(material.shininess) });
        Self { brdf, rules: Rules { convolution: material.convolution, ..Rules::default() } }
    }
}

impl BrdfReport {
    /// The relative L2 error of the lobes' effective BRDF; `None` while it is not known.
    pub fn error(&self) -> Option<f64> {
        self.error
    }

    /// True while figures are worked out, those at hand being of what was there before.
    pub fn is_running(&self) -> bool {
        self.following.is_running()
    }

    /// Follows the session. Call once per frame.
    pub fn update(&mut self, session: &Session, wake: &Wake) {
        let key = Key {
            revisions: [session.map_revision(), session.fitting().revision()],
            texel: session.selected(),
            material: (&session.surface.material).into(),
        };
        if self.following.is_due(&key) {
            self.start(session, key, wake);
        }
        while let Some(error) = self.following.next() {
            self.error = error;
        }
    }

    fn start(&mut self, session: &Session, key: Key, wake: &Wake) {
        let Key { texel, material: MaterialKey { brdf, rules }, .. } = key;
        let lobes = Arc::clone(session.lobes());
        let is_fitted = texel.level == 0 || lobes.level(texel.level).is_some();
        let filter = VmfFilter { lobes, fold: session.fitting().fold(), rules };
        self.following.start("effective-brdf", (key, Vec::new()), wake, move |send, _| {
            send(if is_fitted { texel_error(&filter.lobes.map, &filter, texel, brdf) } else { None });
            Ok(())
        });
    }
}
