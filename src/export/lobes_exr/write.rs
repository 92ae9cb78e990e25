//! Writing a fit: rows are read from the pyramid as the file asks for them.

use std::path::Path;

use super::note::notes_of;
use super::{COMPONENTS, FittedLobes, channel_name, part_name};
use crate::filter::vmf::LobePyramid;
use crate::image_io::WriteImageError;
use crate::image_io::exr_parts::{Part, Place, write_parts};

/// Writes a finished fit; `-` is standard output. A failure leaves the old file whole.
///
/// # Errors
/// One sentence that names the target and the cause; see [`WriteImageError`].
pub fn write(path: &Path, fit: &FittedLobes) -> Result<(), WriteImageError> {
    let lobes = fit.lobes.as_ref();
    let sizes = lobes.map.level_sizes();
    let part = |(level, &size): (usize, &(usize, usize))| Part {
        name: part_name(level),
        size,
        channels: channels(slots_of(lobes, level)),
        notes: notes_of(fit, level),
    };
    let parts: Vec<Part> = sizes.iter().enumerate().map(part).collect();
    write_parts(path, &parts, &|place, row| fill(lobes, place, row))
}

/// Slots that a level's part has channels for; the base has as many as any level above it.
fn slots_of(lobes: &LobePyramid, level: usize) -> usize {
    lobes.level(level).map_or_else(|| lobes.lobes(), |mixtures| mixtures.lobes)
}

/// A part's channels; this order is the alphabet's, as the format asks.
fn channels(slots: usize) -> Vec<String> {
    (0..slots).flat_map(|slot| (0..COMPONENTS.len()).map(move |component| channel_name(slot, component))).collect()
}

/// One channel of one row; nothing where the level is not fitted.
fn fill(lobes: &LobePyramid, place: Place, row: &mut [f32]) {
    let (slot, component) = (place.channel / COMPONENTS.len(), place.channel % COMPONENTS.len());
    let start = |width: usize| place.y * width + place.x;
    if place.part == 0 {
        let first = start(lobes.map.width);
        for (index, value) in (first..).zip(row) {
            *value = if lobes.base_slot(index) == slot { lobes.base_lobe(index)[component] } else { 0.0 };
        }
    } else if let Some(mixtures) = lobes.level(place.part) {
        let texels = mixtures.stored.chunks(mixtures.lobes).skip(start(mixtures.width));
        row.iter_mut().zip(texels).for_each(|(value, stored)| *value = stored[slot][component]);
    }
}
