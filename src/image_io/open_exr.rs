//! OpenEXR, half and float, by the `exr` crate.
//!
//! The first layer that holds colour is read, at its full resolution and over its data window. A layer holds colour
//! when its channels are named R, G, B or X, Y, Z (with an optional A), or R, G or X, Y alone (a normal without its
//! third component), or Y alone (luminance); a prefix as in `normal.R` does not count, nor does the case.

use std::io::Cursor;

use exr::block::reader::ChunksReader;
use exr::block::{UncompressedBlock, samples::FromNativeSample};
use exr::error::Error;
use exr::meta::MetaData;
use exr::meta::attribute::SampleType;
use exr::meta::header::Header;
use half::f16;

use super::read::check_size;
use super::{RasterImage, ReadImageError, SampleDepth, Samples};

pub(super) const FORMAT: &str = "OpenEXR";

/// Sets of channels that are read as colour, the fullest first.
const COLOR_SETS: [&[&str]; 5] = [&["R", "G", "B"], &["X", "Y", "Z"], &["R", "G"], &["X", "Y"], &["Y"]];

/// Refuses no file for breaking a rule that does not matter for reading it.
pub(super) const PEDANTIC: bool = false;

/// What is read from a file: a layer, and the indices of its channels in the order they are stored in.
struct Selection {
    layer: usize,
    channels: Vec<usize>,
    has_alpha: bool,
}

/// Decodes `bytes`; the size is checked before memory is taken. Blocks are decoded one after another on the
/// caller's thread: a panic of a decoder on a thread of its own could not be caught.
pub(super) fn decode(name: &str, bytes: &[u8]) -> Result<RasterImage, ReadImageError> {
    let plain = |error: Error| plain_error(name, &error);
    // Read once without validation, which has no words of its own for a size that is merely too large.
    let headers = MetaData::read_from_buffered(bytes, PEDANTIC).map_err(plain)?.headers;
    let selection = select(name, &headers)?;
    let header = headers[selection.layer].clone();
    let (width, height) = checked_size(name, &header)?;
    check_sampling(name, &header, &selection)?;
    let reader = exr::block::read(Cursor::new(bytes), PEDANTIC).map_err(plain)?;
    let mut values = vec![0.0_f32; width * height * selection.channels.len()];
    let mut blocks = reader
        .filter_chunks(PEDANTIC, |_, tile, block| block.layer == selection.layer && tile.is_largest_resolution_level())
        .map_err(plain)?
        .sequential_decompressor(PEDANTIC);
    while let Some(block) = blocks.decompress_next_block() {
        store_block(&block.map_err(plain)?, &header, &selection, width, &mut values).map_err(plain)?;
    }
    Ok(RasterImage {
        width,
        height,
        channels: selection.channels.len(),
        has_alpha: selection.has_alpha,
        samples: Samples::F32(values),
        depth: depth_of(&header, &selection),
        format: FORMAT,
        tagged_srgb: false,
    })
}

pub(super) fn checked_size(name: &str, header: &Header) -> Result<(usize, usize), ReadImageError> {
    let size = header.layer_size;
    check_size(name, FORMAT, size.width() as u64, size.height() as u64)
}

/// Copies the chosen channels of a block to their places.
fn store_block(
    block: &UncompressedBlock,
    header: &Header,
    selection: &Selection,
    width: usize,
    values: &mut [f32],
) -> Result<(), Error> {
    let stride = selection.channels.len();
    for line in block.lines(&header.channels) {
        let Some(slot) = selection.channels.iter().position(|&index| index == line.location.channel) else {
            continue;
        };
        let start = line.location.position.y() * width + line.location.position.x();
        let targets = values.iter_mut().skip(start * stride + slot).step_by(stride);
        match header.channels.list[line.location.channel].sample_type {
            SampleType::F16 => store(targets, line.read_samples::<f16>(), f32::from_f16)?,
            SampleType::F32 => store(targets, line.read_samples::<f32>(), f32::from_f32)?,
            SampleType::U32 => store(targets, line.read_samples::<u32>(), f32::from_u32)?,
        }
    }
    Ok(())
}

fn store<'a, T>(
    targets: impl Iterator<Item = &'a mut f32>,
    samples: impl Iterator<Item = Result<T, Error>>,
    convert: impl Fn(T) -> f32,
) -> Result<(), Error> {
    // The samples lead: a pull from them past the line's end would be an error, one from the targets is none.
    for (sample, target) in samples.zip(targets) {
        *target = convert(sample?);
    }
    Ok(())
}

/// Finds the first layer with colour, or says which channels there are.
fn select(name: &str, headers: &[Header]) -> Result<Selection, ReadImageError> {
    let selection = headers
        .iter()
        .enumerate()
        .filter(|(_, header)| !header.deep)
        .find_map(|(layer, header)| select_in(layer, &channel_names(header)));
    selection.ok_or_else(|| no_color(name, headers))
}

fn select_in(layer: usize, names: &[String]) -> Option<Selection> {
    let index_of = |prefix: &str, wanted: &str| {
        let full = format!("{prefix}{wanted}");
        names.iter().position(|name| name.eq_ignore_ascii_case(&full))
    };
    let prefixes: Vec<&str> = names.iter().map(|name| prefix_of(name)).collect();
    COLOR_SETS.iter().find_map(|set| {
        prefixes.iter().find_map(|prefix| {
            let color: Option<Vec<usize>> = set.iter().map(|wanted| index_of(prefix, wanted)).collect();
            let (mut channels, alpha) = (color?, index_of(prefix, "A"));
            channels.extend(alpha);
            let has_alpha = alpha.is_some();
            Some(Selection { layer, channels, has_alpha })
        })
    })
}

/// The part of a channel's name up to and with the last full stop.
fn prefix_of(name: &str) -> &str {
    name.rfind('.').map_or("", |stop| &name[..=stop])
}

fn channel_names(header: &Header) -> Vec<String> {
    header.channels.list.iter().map(|channel| channel.name.to_string()).collect()
}

fn no_color(name: &str, headers: &[Header]) -> ReadImageError {
    if !headers.is_empty() && headers.iter().all(|header| header.deep) {
        return unsupported(name, "deep data");
    }
    let mut names: Vec<String> = headers.iter().flat_map(channel_names).collect();
    let rest = names.len().saturating_sub(8);
    names.truncate(8);
    let mut found = if names.is_empty() { "no channels".to_owned() } else { names.join(", ") };
    if rest > 0 {
        found += &format!(" and {rest} more");
    }
    ReadImageError::NoColor { name: name.to_owned(), found }
}

fn check_sampling(name: &str, header: &Header, selection: &Selection) -> Result<(), ReadImageError> {
    // Subsampled channels shift the bytes of all that follow them, so one anywhere in the layer counts.
    let whole = header.channels.list.iter().all(|channel| (channel.sampling.x(), channel.sampling.y()) == (1, 1));
    if whole && selection.channels.len() <= 4 { Ok(()) } else { Err(unsupported(name, "subsampled channels")) }
}

fn depth_of(header: &Header, selection: &Selection) -> SampleDepth {
    let half = |&index: &usize| header.channels.list[index].sample_type == SampleType::F16;
    if selection.channels.iter().all(half) { SampleDepth::Half } else { SampleDepth::Float }
}

pub(super) fn unsupported(name: &str, feature: &'static str) -> ReadImageError {
    ReadImageError::UnsupportedKind { name: name.to_owned(), format: FORMAT, feature }
}

/// Puts the decoder's failure into plain words; its own text goes to the log.
pub(super) fn plain_error(name: &str, error: &Error) -> ReadImageError {
    log::debug!("{name}: {error}");
    let format = FORMAT;
    match error {
        Error::NotSupported(_) => unsupported(name, "its compression or layout"),
        // The crate turns an unexpected end of file into this very text, and keeps no other trace of it.
        Error::Invalid(text) if text == "reference to missing bytes" => {
            ReadImageError::Truncated { name: name.to_owned(), format }
        }
        _ => ReadImageError::Damaged { name: name.to_owned(), format },
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn selected(names: &[&str]) -> Option<(Vec<usize>, bool)> {
        let names: Vec<String> = names.iter().map(|&name| name.to_owned()).collect();
        select_in(0, &names).map(|selection| (selection.channels, selection.has_alpha))
    }

    #[test]
    fn channels_are_found_by_name_in_any_order_and_layer() {
        assert_eq!(selected(&["A", "B", "G", "R"]), Some((vec![3, 2, 1, 0], true)));
        assert_eq!(selected(&["depth.Z", "n.x", "n.y", "n.z"]), Some((vec![1, 2, 3], false)));
        assert_eq!(selected(&["G", "R"]), Some((vec![1, 0], false)));
        assert_eq!(selected(&["Y"]), Some((vec![0], false)));
        assert_eq!(selected(&["Z", "id"]), None);
    }
}
