//! Writing a fit: rows are read from the pyramid as the file asks for them.

use std::path::Path;

use super::note::notes_of;
use super::{COMPONENTS, FittedLobes, PLAIN, channel_name, part_name};
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
        channels: channels(lobes, level).into_iter().map(|(name, ..)| name).collect(),
        notes: notes_of(fit, level),
    };
    let parts: Vec<Part> = sizes.iter().enumerate().map(part).collect();
    let channels: Vec<Vec<Channel>> = (0..sizes.len()).map(|level| channels(lobes, level)).collect();
    write_parts(path, &parts, &|place, row| {
        let (_, slot, component) = channels[place.part][place.channel];
        fill(lobes, place, (slot, component), row);
    })
}

/// A channel's name, the slot and the component it holds.
type Channel = (String, usize, usize);

/// A part's channels in the alphabet's order, as the format asks; the base has as many slots as any level above it.
fn channels(lobes: &LobePyramid, level: usize) -> Vec<Channel> {
    let slots = lobes.level(level).map_or_else(|| lobes.lobes(), |mixtures| mixtures.lobes);
    let components = if lobes.map.albedo.is_some() { COMPONENTS.len() } else { PLAIN };
    let channel =
        |index: usize| (channel_name(index / components, index % components), index / components, index % components);
    let mut channels: Vec<Channel> = (0..slots * components).map(channel).collect();
    channels.sort();
    channels
}

/// One channel of one row; nothing where the level is not fitted.
fn fill(lobes: &LobePyramid, place: Place, (slot, component): (usize, usize), row: &mut [f32]) {
    let first = |width: usize| place.y * width + place.x;
    if place.part == 0 {
        for (index, value) in (first(lobes.map.width)..).zip(row) {
            *value = if lobes.base_slot(index) == slot { base_value(lobes, index, component) } else { 0.0 };
        }
    } else if let Some(mixtures) = lobes.level(place.part) {
        for (texel, value) in (first(mixtures.width)..).zip(row) {
            let index = texel * mixtures.lobes + slot;
            *value = match component.checked_sub(PLAIN) {
                None => mixtures.stored[index][component],
                Some(channel) => lobes.color(place.part, index)[channel],
            };
        }
    }
}

/// A component of a base texel's only lobe; its weight is 1, or 0 where the texel is invalid.
fn base_value(lobes: &LobePyramid, index: usize, component: usize) -> f32 {
    let stored = lobes.base_lobe(index);
    match component.checked_sub(PLAIN) {
        None => stored[component],
        Some(_) if stored[0] == 0.0 => 0.0,
        Some(channel) => lobes.map.color(index)[channel],
    }
}
