//! The error of a method's effective BRDF in every texel of every level, worked out in a job while somebody looks: the
//! coarsest level first, each kept until map, method, lobes or material change.

use super::brdf_report::MaterialKey;
use super::built_filters::{BuiltFilters, FilterSource};
use crate::filter::Method;
use crate::filter::brdf_error::level_errors;
use crate::filter::worst_texels::{self, WorstTexel};
use crate::jobs::Wake;
use crate::jobs::following::Following;
use crate::normal_map::pyramid::Texel;
use crate::session::Session;

/// The errors, kept up to date by [`ErrorReport::update`].
#[derive(Default)]
pub struct ErrorReport {
    following: Following<Key, LevelErrors>,
    filters: BuiltFilters,
    /// By level, row by row; NaN where there is none.
    levels: Vec<Option<Vec<f32>>>,
    worst: Vec<WorstTexel>,
    waits: bool,
    revision: u64,
}

/// What the errors depend on.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Key {
    map_revision: u64,
    /// That of the lobes, where the method shows them.
    lobes_revision: Option<u64>,
    method: Method,
    material: MaterialKey,
}

/// A level that is done.
struct LevelErrors {
    level: usize,
    errors: Vec<f32>,
}

impl ErrorReport {
    /// A report whose filters are kept in `filters`.
    pub fn new(filters: BuiltFilters) -> Self {
        Self { filters, ..Self::default() }
    }

    /// The relative L2 error of a texel, NaN where it has none; `None` while it is not known.
    pub fn error(&self, session: &Session, texel: Texel) -> Option<f32> {
        let errors = self.levels.get(texel.level)?.as_ref()?;
        errors.get(texel.y * session.map().level_size(texel.level).0 + texel.x).copied()
    }

    /// The texels of the levels that are done whose error is highest, the worst first.
    pub fn worst(&self) -> &[WorstTexel] {
        &self.worst
    }

    /// Grows with every change of the errors at hand.
    pub fn revision(&self) -> u64 {
        self.revision
    }

    /// True while errors are worked out.
    pub fn is_running(&self) -> bool {
        self.following.is_running()
    }

    /// What is still under way, in words.
    pub fn progress(&self) -> Option<String> {
        if self.waits {
            return Some("waits for the fit".to_owned());
        }
        let monitor = self.following.progress()?;
        let level = self.levels.iter().rposition(Option::is_none).unwrap_or(0);
        Some(format!("level {level}: {:.0} %", 100.0 * monitor.level_fraction(level)))
    }

    /// Follows the session and the method while they are `shown`. Call once per frame.
    pub fn update(&mut self, session: &Session, method: Method, shown: bool, wake: &Wake) {
        if !shown {
            if self.is_running() {
                self.clear();
                self.following = Following::default();
            }
            return;
        }
        let lobes_revision = method.shows_lobes().then(|| session.fitting().revision());
        let material = (&session.surface.material).into();
        let key = Key { map_revision: session.map_revision(), lobes_revision, method, material };
        self.waits = method.shows_lobes() && session.fitting().is_running();
        if !self.following.is_of(&key) {
            self.clear();
        }
        if self.following.is_due(&key) && !self.waits {
            self.levels = vec![None; session.map().level_sizes().len()];
            self.start(session, key, wake);
        }
        while let Some(found) = self.following.take() {
            self.take(session, found);
        }
    }

    fn clear(&mut self) {
        if !self.levels.is_empty() {
            self.levels.clear();
            self.worst.clear();
            self.revision += 1;
        }
    }

    fn take(&mut self, session: &Session, LevelErrors { level, errors }: LevelErrors) {
        worst_texels::add_level(&mut self.worst, level, session.map().level_size(level).0, &errors);
        self.levels[level] = Some(errors);
        self.revision += 1;
    }

    fn start(&mut self, session: &Session, key: Key, wake: &Wake) {
        let Key { method, material: MaterialKey { brdf, rules }, .. } = key;
        let (source, filters) = (FilterSource::new(session, rules), self.filters.clone());
        let texels = session.map().level_sizes().iter().map(|(width, height)| (width * height) as u64).collect();
        self.following.start("map-errors", (key, texels), wake, move |send, monitor| {
            let filter = filters.get(&source, method, monitor)?;
            let map = &source.mip.map;
            for level in (0..map.level_sizes().len()).rev().filter(|&level| source.has(method, level)) {
                let errors = filters.install(|| level_errors(map, &*filter, level, brdf, monitor))?;
                send(LevelErrors { level, errors });
            }
            Ok(())
        });
    }
}
