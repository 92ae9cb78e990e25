//! Reading a fit. Every part, size and value is checked, for the file may be anyone's: the sizes before memory is
//! taken for them, the values once they are in place.

use std::path::Path;
use std::sync::Arc;

use glam::Vec3;

use super::base::Base;
use super::note::note_of;
use super::{COMPONENTS, FittedLobes, PLAIN, ReadLobesError, channel_name, parse_channel, part_name};
use crate::filter::vmf::{ColorLevel, LobePyramid, MixtureLevel};
use crate::image_io::exr_parts::{PartsReader, Place};
use crate::normal_map::pyramid::level_sizes;
use crate::normal_map::{MapOptions, MapSource, Warning};
use crate::sphere::StoredLobe;
use crate::sphere::mixture::MAX_LOBES;

/// How far weights may be from a sum of 1, and lengths beyond what they may be: other programs may have rounded.
pub(super) const TOLERANCE: f32 = 1e-3;

/// Reads a file of lobes; `None` where it holds none and is to be read as an image. The fit's own options count; where
/// `options` ask for others, a warning says so.
///
/// # Errors
/// One sentence that names the file and the cause.
pub fn read(path: &Path, options: &MapOptions) -> Result<Option<FittedLobes>, ReadLobesError> {
    match PartsReader::open(path)? {
        Some(reader) => read_parts(reader, MapSource::File(path.to_owned()), options),
        None => Ok(None),
    }
}

/// As [`read`], from the bytes of a file.
///
/// # Errors
/// One sentence that names the file and the cause.
pub fn read_bytes(
    bytes: &[u8],
    source: MapSource,
    options: &MapOptions,
) -> Result<Option<FittedLobes>, ReadLobesError> {
    match PartsReader::open_bytes(&source.to_string(), bytes)? {
        Some(reader) => read_parts(reader, source, options),
        None => Ok(None),
    }
}

fn read_parts(
    reader: PartsReader<'_>,
    source: MapSource,
    asked: &MapOptions,
) -> Result<Option<FittedLobes>, ReadLobesError> {
    let first = channel_name(0, 0);
    if !reader.parts().iter().any(|part| part.channels.contains(&first)) {
        return Ok(None);
    }
    let name = reader.name().to_owned();
    let plans = plan(&reader)?;
    let notes: Vec<_> = plans.iter().map(|plan| note_of(&reader.parts()[plan.part].notes)).collect();
    let mut base = Base::new(plans[0].size, plans[0].colored);
    let mut coarse: Vec<Level> = plans[1..].iter().map(Level::new).collect();
    let wanted: Vec<usize> = plans.iter().map(|plan| plan.part).collect();
    reader.read(&wanted, &mut |place, row| {
        let level = plans.iter().position(|plan| plan.part == place.part);
        let target = level.and_then(|level| Some((level, plans[level].channels[place.channel]?)));
        match target {
            Some((0, channel)) => base.store(place, channel, row),
            Some((level, channel)) => coarse[level - 1].store(place, channel, row),
            None => {}
        }
    })?;
    coarse.iter().enumerate().try_for_each(|(index, level)| level.check(&name, index + 1))?;
    let options = MapOptions { addressing: notes[0].1, ..MapOptions::default() };
    let (mut map, base) = base.finish(&name, source, options)?;
    let asked = MapOptions { color: None, ..asked.clone() };
    if asked != map.options && asked != MapOptions::default() {
        map.warnings.push(Warning::FitKeepsItsOptions);
    }
    let (coarse, colors) =
        coarse.into_iter().map(|level| (Some(Arc::new(level.mixtures)), level.colors.map(Arc::new))).unzip();
    let lobes = LobePyramid { map: Arc::new(map), base: Some(Arc::new(base)), coarse, colors };
    let stats = notes.iter().map(|(note, _)| note.level).collect();
    Ok(Some(FittedLobes { lobes: Arc::new(lobes), settings: notes[0].0.settings, stats }))
}

/// Where a level is in the file.
struct LevelPlan {
    part: usize,
    size: (usize, usize),
    slots: usize,
    colored: bool,
    /// Slot and component of each of the part's channels; `None` for one that is no lobe's.
    channels: Vec<Option<(usize, usize)>>,
}

/// Finds every level's part and checks what it claims.
fn plan(reader: &PartsReader<'_>) -> Result<Vec<LevelPlan>, ReadLobesError> {
    let base = find(reader, 0)?;
    reader.check(base)?;
    let (width, height) = reader.parts()[base].size;
    let sizes = level_sizes(width, height);
    let plans: Result<Vec<LevelPlan>, _> =
        sizes.iter().enumerate().map(|(level, &size)| plan_level(reader, level, size)).collect();
    let plans = plans?;
    match plans.iter().position(|plan| plan.colored != plans[0].colored) {
        None => Ok(plans),
        Some(level) => Err(wrong_channels(reader, level)),
    }
}

fn find(reader: &PartsReader<'_>, level: usize) -> Result<usize, ReadLobesError> {
    let part = part_name(level);
    let found = reader.parts().iter().position(|known| known.name == part);
    found.ok_or_else(|| ReadLobesError::MissingPart { name: reader.name().to_owned(), part })
}

fn plan_level(reader: &PartsReader<'_>, level: usize, size: (usize, usize)) -> Result<LevelPlan, ReadLobesError> {
    let part = find(reader, level)?;
    reader.check(part)?;
    let known = &reader.parts()[part];
    let name = || reader.name().to_owned();
    if known.size != size {
        let part = part_name(level);
        return Err(ReadLobesError::WrongSize { name: name(), part, found: known.size, wanted: size });
    }
    let channels: Vec<Option<(usize, usize)>> = known.channels.iter().map(|channel| parse_channel(channel)).collect();
    let slots = channels.iter().flatten().map(|(slot, _)| slot + 1).max().unwrap_or(0);
    let colored = channels.iter().flatten().any(|&(_, component)| component >= PLAIN);
    let components = if colored { COMPONENTS.len() } else { PLAIN };
    let complete =
        (0..slots * components).all(|index| channels.contains(&Some((index / components, index % components))));
    if !(1..=MAX_LOBES).contains(&slots) || !complete {
        return Err(wrong_channels(reader, level));
    }
    Ok(LevelPlan { part, size, slots, colored, channels })
}

fn wrong_channels(reader: &PartsReader<'_>, level: usize) -> ReadLobesError {
    ReadLobesError::WrongChannels { name: reader.name().to_owned(), part: part_name(level) }
}

/// A level above the base while it is read.
struct Level {
    mixtures: MixtureLevel,
    colors: Option<ColorLevel>,
}

impl Level {
    fn new(plan: &LevelPlan) -> Self {
        let mixtures = MixtureLevel::empty(plan.size, plan.slots);
        let colors = plan.colored.then(|| ColorLevel { stored: vec![[0.0; 3]; mixtures.stored.len()] });
        Self { mixtures, colors }
    }

    /// Stores a run of one component of one slot.
    fn store(&mut self, place: Place, (slot, component): (usize, usize), row: &[f32]) {
        let (width, slots) = (self.mixtures.width, self.mixtures.lobes);
        let first = (place.y * width + place.x) * slots + slot;
        match (component.checked_sub(PLAIN), &mut self.colors) {
            (None, _) => {
                let targets = self.mixtures.stored.iter_mut().skip(first).step_by(slots);
                targets.zip(row).for_each(|(stored, &value)| stored[component] = value);
            }
            (Some(channel), Some(colors)) => {
                let targets = colors.stored.iter_mut().skip(first).step_by(slots);
                targets.zip(row).for_each(|(stored, &value)| stored[channel] = value);
            }
            (Some(_), None) => {}
        }
    }

    /// Checks that every texel holds a mixture.
    fn check(&self, name: &str, level: usize) -> Result<(), ReadLobesError> {
        let mixtures = &self.mixtures;
        let colors = self.colors.iter().flat_map(|colors| colors.stored.as_flattened());
        if !mixtures.stored.as_flattened().iter().chain(colors).all(|value| value.is_finite()) {
            return Err(not_finite(name, level));
        }
        match mixtures.stored.chunks(mixtures.lobes).position(|stored| !is_mixture(stored)) {
            None => Ok(()),
            Some(texel) => Err(no_mixture(name, level, texel, mixtures.width)),
        }
    }
}

/// True for weights from 0 that sum to 1, and resultants no longer than their weights.
fn is_mixture(stored: &[StoredLobe]) -> bool {
    let total: f32 = stored.iter().map(|lobe| lobe[0]).sum();
    let fits = |&[alpha, x, y, z]: &StoredLobe| alpha >= 0.0 && Vec3::new(x, y, z).length() <= alpha + TOLERANCE;
    (total - 1.0).abs() <= TOLERANCE && stored.iter().all(fits)
}

pub(super) fn not_finite(name: &str, level: usize) -> ReadLobesError {
    ReadLobesError::NotFinite { name: name.to_owned(), part: part_name(level) }
}

pub(super) fn no_mixture(name: &str, level: usize, texel: usize, width: usize) -> ReadLobesError {
    let (x, y) = (texel % width, texel / width);
    ReadLobesError::NoMixture { name: name.to_owned(), part: part_name(level), x, y }
}
