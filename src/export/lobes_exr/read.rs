//! Reading a fit. Every part, size and value is checked, for the file may be anyone's: the sizes before memory is
//! taken for them, the values once they are in place.

use std::path::Path;
use std::sync::Arc;

use glam::Vec3;

use super::note::note_of;
use super::{COMPONENTS, FittedLobes, ReadLobesError, channel_name, parse_channel, part_name};
use crate::filter::vmf::{BaseSlots, LobePyramid, MixtureLevel};
use crate::image_io::exr_parts::{PartsReader, Place};
use crate::normal_map::pyramid::level_sizes;
use crate::normal_map::{MapOptions, MapSource, NormalMap, Warning};
use crate::sphere::StoredLobe;
use crate::sphere::mixture::MAX_LOBES;

/// How far weights may be from a sum of 1, and lengths beyond what they may be: other programs may have rounded.
const TOLERANCE: f32 = 1e-3;

/// A base normal further than this from unit length is normalised; f32 normals as they are written are closer.
const UNIT_TOLERANCE: f32 = 1e-6;

/// The slot of a base texel that has no lobe yet.
const NO_SLOT: u8 = u8::MAX;

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
    let mut base = Base::new(plans[0].size);
    let mut coarse: Vec<MixtureLevel> =
        plans[1..].iter().map(|plan| MixtureLevel::empty(plan.size, plan.slots)).collect();
    let wanted: Vec<usize> = plans.iter().map(|plan| plan.part).collect();
    reader.read(&wanted, &mut |place, row| {
        let level = plans.iter().position(|plan| plan.part == place.part);
        let target = level.and_then(|level| Some((level, plans[level].channels[place.channel]?)));
        match target {
            Some((0, channel)) => base.store(place, channel, row),
            Some((level, channel)) => store(&mut coarse[level - 1], place, channel, row),
            None => {}
        }
    })?;
    coarse.iter().enumerate().try_for_each(|(index, mixtures)| check_level(&name, index + 1, mixtures))?;
    let options = MapOptions { addressing: notes[0].1, ..MapOptions::default() };
    let (mut map, base) = base.finish(&name, source, options)?;
    if *asked != map.options && *asked != MapOptions::default() {
        map.warnings.push(Warning::FitKeepsItsOptions);
    }
    let lobes = LobePyramid {
        map: Arc::new(map),
        base: Some(Arc::new(base)),
        coarse: coarse.into_iter().map(|mixtures| Some(Arc::new(mixtures))).collect(),
    };
    let stats = notes.iter().map(|(note, _)| note.level).collect();
    Ok(Some(FittedLobes { lobes: Arc::new(lobes), settings: notes[0].0.settings, stats }))
}

/// Where a level is in the file.
struct LevelPlan {
    part: usize,
    size: (usize, usize),
    slots: usize,
    /// Slot and component of each of the part's channels; `None` for one that is no lobe's.
    channels: Vec<Option<(usize, usize)>>,
}

/// Finds every level's part and checks what it claims.
fn plan(reader: &PartsReader<'_>) -> Result<Vec<LevelPlan>, ReadLobesError> {
    let base = find(reader, 0)?;
    reader.check(base)?;
    let (width, height) = reader.parts()[base].size;
    let sizes = level_sizes(width, height);
    sizes.iter().enumerate().map(|(level, &size)| plan_level(reader, level, size)).collect()
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
    let complete = (0..slots * COMPONENTS.len())
        .all(|index| channels.contains(&Some((index / COMPONENTS.len(), index % COMPONENTS.len()))));
    if !(1..=MAX_LOBES).contains(&slots) || !complete {
        return Err(ReadLobesError::WrongChannels { name: name(), part: part_name(level) });
    }
    Ok(LevelPlan { part, size, slots, channels })
}

/// Stores a run of one component of one slot of a level above the base.
fn store(mixtures: &mut MixtureLevel, place: Place, (slot, component): (usize, usize), row: &[f32]) {
    let first = place.y * mixtures.width + place.x;
    let slots = mixtures.lobes;
    let texels = mixtures.stored.chunks_mut(slots).skip(first);
    texels.zip(row).for_each(|(stored, &value)| stored[slot][component] = value);
}

/// Checks that every texel of a level holds a mixture.
fn check_level(name: &str, level: usize, mixtures: &MixtureLevel) -> Result<(), ReadLobesError> {
    if mixtures.stored.iter().flatten().any(|value| !value.is_finite()) {
        return Err(not_finite(name, level));
    }
    match mixtures.stored.chunks(mixtures.lobes).position(|stored| !is_mixture(stored)) {
        None => Ok(()),
        Some(texel) => Err(no_mixture(name, level, texel, mixtures.width)),
    }
}

/// True for weights from 0 that sum to 1, and resultants no longer than their weights.
fn is_mixture(stored: &[StoredLobe]) -> bool {
    let total: f32 = stored.iter().map(|lobe| lobe[0]).sum();
    let fits = |&[alpha, x, y, z]: &StoredLobe| alpha >= 0.0 && Vec3::new(x, y, z).length() <= alpha + TOLERANCE;
    (total - 1.0).abs() <= TOLERANCE && stored.iter().all(fits)
}

fn not_finite(name: &str, level: usize) -> ReadLobesError {
    ReadLobesError::NotFinite { name: name.to_owned(), part: part_name(level) }
}

fn no_mixture(name: &str, level: usize, texel: usize, width: usize) -> ReadLobesError {
    let (x, y) = (texel % width, texel / width);
    ReadLobesError::NoMixture { name: name.to_owned(), part: part_name(level), x, y }
}

/// The base level while it is read: one normal a texel, and the slot it was found in.
struct Base {
    size: (usize, usize),
    slots: Vec<u8>,
    normals: [Vec<f32>; 3],
    /// A texel with lobes in two slots, or with a weight other than 1.
    odd: Option<usize>,
    finite: bool,
}

impl Base {
    fn new(size: (usize, usize)) -> Self {
        let texels = size.0 * size.1;
        let normals = std::array::from_fn(|_| vec![0.0; texels]);
        Self { size, slots: vec![NO_SLOT; texels], normals, odd: None, finite: true }
    }

    /// Stores a run of one component of one slot. The format keeps channels in the alphabet's order, so a lobe's
    /// weight comes before its direction; what comes in another order finds no slot.
    fn store(&mut self, place: Place, (slot, component): (usize, usize), row: &[f32]) {
        let first = place.y * self.size.0 + place.x;
        self.finite &= row.iter().all(|value| value.is_finite());
        for (index, &value) in (first..self.slots.len()).zip(row) {
            if component > 0 && usize::from(self.slots[index]) == slot {
                self.normals[component - 1][index] = value;
            } else if value != 0.0 {
                let fits = component == 0 && self.slots[index] == NO_SLOT && (value - 1.0).abs() <= TOLERANCE;
                self.odd = self.odd.or((!fits).then_some(index));
                self.slots[index] = slot as u8;
            }
        }
    }

    /// The map and the slots, once every texel is known to hold one unit normal or none.
    fn finish(
        mut self,
        name: &str,
        source: MapSource,
        options: MapOptions,
    ) -> Result<(NormalMap, BaseSlots), ReadLobesError> {
        if !self.finite {
            return Err(not_finite(name, 0));
        }
        if let Some(texel) = self.odd.or_else(|| self.normalise()) {
            return Err(no_mixture(name, 0, texel, self.size.0));
        }
        for slot in self.slots.iter_mut().filter(|slot| **slot == NO_SLOT) {
            *slot = 0;
        }
        let map = NormalMap::from_unit_normals(self.size, self.normals, source, options);
        if map.invalid == map.len() {
            return Err(ReadLobesError::NoNormals { name: name.to_owned() });
        }
        Ok((map, BaseSlots { slots: self.slots }))
    }

    /// Brings normals that another program rounded back to unit length; the first texel of another length, if any.
    fn normalise(&mut self) -> Option<usize> {
        let [x, y, z] = &mut self.normals;
        (0..x.len()).find(|&index| {
            let normal = Vec3::new(x[index], y[index], z[index]);
            let off = (normal.length() - 1.0).abs();
            if self.slots[index] == NO_SLOT || off <= UNIT_TOLERANCE {
                return false;
            }
            [x[index], y[index], z[index]] = normal.normalize_or_zero().to_array();
            off > 2.0 * TOLERANCE
        })
    }
}
