//! The effective BRDF of the selected texel, in truth and by methods, worked out in a job once per change of what it
//! depends on.

use std::sync::Arc;

use super::ViewState;
use super::built_filters::{BuiltFilters, FilterSource};
use crate::brdf::{Brdf, Material};
use crate::comparison::Comparison;
use crate::filter::brdf_error::TexelTruth;
use crate::filter::brdf_shape::{Disc, Peak, Slice};
use crate::filter::footprint_brdf::FootprintBrdf;
use crate::filter::vmf::{Cancelled, Monitor, Rules};
use crate::filter::{EffectiveBrdf, Method};
use crate::jobs::Wake;
use crate::jobs::following::Following;
use crate::normal_map::pyramid::Texel;
use crate::session::Session;

/// Pixels across a picture of the hemisphere.
const DISC_SIDE: usize = 128;

/// The report on the selected texel's effective BRDF, kept up to date by [`BrdfReport::update`].
#[derive(Default)]
pub struct BrdfReport {
    following: Following<Key, Found>,
    filters: BuiltFilters,
    error: Option<f64>,
    shapes: Vec<BrdfShape>,
    discs: Option<Arc<BrdfDiscs>>,
}

/// What the figures depend on.
#[derive(Clone, Debug, PartialEq)]
struct Key {
    revisions: [u64; 2],
    texel: Texel,
    material: MaterialKey,
    asked: Asked,
}

/// What is to be worked out beside the error of the lobes.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Asked {
    /// The methods whose shape is wanted; with any of them, the truth's too.
    pub shapes: Vec<Method>,
    /// The method of which there is a picture beside the truth's.
    pub pictured: Option<Method>,
}

impl Asked {
    /// The judged method and those of the comparison, where they are looked at.
    pub fn new(view: &ViewState, comparison: &Comparison) -> Self {
        if !view.show_brdf {
            return Self::default();
        }
        let judged = ViewState::judged_of(comparison, view.judged);
        let mut shapes = vec![judged];
        for method in comparison.methods() {
            if method != Method::Truth && !shapes.contains(&method) {
                shapes.push(method);
            }
        }
        Self { shapes, pictured: Some(judged) }
    }
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
        Self { brdf: material.brdf(), rules: Rules { convolution: material.convolution, ..Rules::default() } }
    }
}

/// A method's effective BRDF in figures.
#[derive(Clone, Debug, PartialEq)]
pub struct BrdfShape {
    /// The method.
    pub method: Method,
    /// Where it is highest.
    pub peak: Peak,
    /// The relative L2 error; none of the truth, and none where that lies below the horizon.
    pub error: Option<f64>,
    /// Signed angle from the pole in degrees and value per steradian, along the half circle through the truth's peak.
    pub slice: Vec<[f64; 2]>,
}

/// The truth and a method over the hemisphere.
#[derive(Clone, Debug, PartialEq)]
pub struct BrdfDiscs {
    /// The method.
    pub method: Method,
    /// The truth's values, then the method's.
    pub discs: [Disc; 2],
    /// The highest value of both, which their common scale ends at.
    pub highest: f32,
}

enum Found {
    Error(Option<f64>),
    Shapes(Vec<BrdfShape>),
    Discs(BrdfDiscs),
}

impl BrdfReport {
    /// A report whose filters are kept in `filters`.
    pub fn new(filters: BuiltFilters) -> Self {
        Self { filters, ..Self::default() }
    }

    /// The relative L2 error of the lobes' effective BRDF; `None` while it is not known.
    pub fn error(&self) -> Option<f64> {
        self.error
    }

    /// The truth's shape, then those of the methods that were asked for.
    pub fn shapes(&self) -> &[BrdfShape] {
        &self.shapes
    }

    /// The pictures, where some were asked for.
    pub fn discs(&self) -> Option<&Arc<BrdfDiscs>> {
        self.discs.as_ref()
    }

    /// True while figures are worked out, those at hand being of what was there before.
    pub fn is_running(&self) -> bool {
        self.following.is_running()
    }

    /// Follows the session. Call once per frame.
    pub fn update(&mut self, session: &Session, asked: Asked, wake: &Wake) {
        let key = Key {
            revisions: [session.map_revision(), session.fitting().revision()],
            texel: session.selected(),
            material: (&session.surface.material).into(),
            asked,
        };
        if self.following.is_due(&key) {
            self.start(session, key, wake);
        }
        while let Some(found) = self.following.take() {
            match found {
                Found::Error(error) => self.error = error,
                Found::Shapes(shapes) => self.shapes = shapes,
                Found::Discs(discs) => self.discs = Some(Arc::new(discs)),
            }
        }
    }

    fn start(&mut self, session: &Session, key: Key, wake: &Wake) {
        let work = Work {
            source: FilterSource::new(session, key.material.rules),
            filters: self.filters.clone(),
            texel: key.texel,
            brdf: key.material.brdf,
            asked: key.asked.clone(),
        };
        if key.asked == Asked::default() {
            (self.shapes, self.discs) = (Vec::new(), None);
        }
        self.following.start("effective-brdf", (key, Vec::new()), wake, move |send, monitor| work.run(send, monitor));
    }
}

/// What the job takes along.
struct Work {
    source: FilterSource,
    filters: BuiltFilters,
    texel: Texel,
    brdf: Brdf,
    asked: Asked,
}

impl Work {
    /// The quick before the slow.
    fn run(&self, send: &dyn Fn(Found), monitor: &Monitor) -> Result<(), Cancelled> {
        let sum = FootprintBrdf::new(&self.source.mip.map, self.texel, self.brdf);
        let places = TexelTruth::new(&sum);
        monitor.check()?;
        let error = self.with(Method::Vmf, monitor, |lobes| places.error(lobes))?;
        send(Found::Error(error.flatten()));
        if self.asked.shapes.is_empty() {
            return Ok(());
        }
        let truth: EffectiveBrdf<'_> = Box::new(|omega| sum.at(omega));
        let directions = || places.directions().map(|(omega, _)| omega);
        let Some(peak) = Peak::new(&truth, directions()) else { return Ok(()) };
        let slice = Slice::through(peak.direction);
        let mut shapes = vec![BrdfShape { method: Method::Truth, peak, error: None, slice: slice.values(&truth) }];
        for &method in &self.asked.shapes {
            let shape = self.with(method, monitor, |brdf| {
                let peak = Peak::new(brdf, directions())?;
                Some(BrdfShape { method, peak, error: places.error(brdf), slice: slice.values(brdf) })
            })?;
            shapes.extend(shape.flatten());
        }
        send(Found::Shapes(shapes));
        let Some(method) = self.asked.pictured else { return Ok(()) };
        let truth = Disc::new(&truth, DISC_SIDE, monitor)?;
        if let Some(disc) = self.with(method, monitor, |brdf| Disc::new(brdf, DISC_SIDE, monitor))? {
            send(Found::Discs(BrdfDiscs::new(method, [truth, disc?])));
        }
        Ok(())
    }

    /// What `figure` finds of a method; `None` where the method has nothing to show of the texel.
    fn with<T>(
        &self,
        method: Method,
        monitor: &Monitor,
        figure: impl FnOnce(&EffectiveBrdf<'_>) -> T,
    ) -> Result<Option<T>, Cancelled> {
        monitor.check()?;
        if !self.source.has(method, self.texel.level) {
            return Ok(None);
        }
        let filter = self.filters.get(&self.source, method, monitor)?;
        Ok(Some(figure(&filter.effective_brdf_of(self.texel, self.brdf))))
    }
}

impl BrdfDiscs {
    fn new(method: Method, discs: [Disc; 2]) -> Self {
        let highest = discs.iter().flat_map(|disc| &disc.values).copied().fold(f32::MIN_POSITIVE, f32::max);
        Self { method, discs, highest }
    }
}
