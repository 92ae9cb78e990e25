//! Writing parts, block by block: a batch is compressed in parallel, then written in order.

use std::io::ErrorKind;
use std::path::Path;

use exr::block::writer::{ChunkWriter, ChunksWriter};
use exr::block::{BlockIndex, UncompressedBlock, enumerate_ordered_header_block_indices};
use exr::error::{Error, UnitResult};
use exr::math::Vec2;
use exr::meta::attribute::{
    AttributeValue, ChannelDescription, Compression, IntegerBounds, LineOrder, SampleType, Text,
};
use exr::meta::header::{Header, LayerAttributes};
use exr::meta::{BlockDescription, MetaData};
use rayon::prelude::*;

use super::{Notes, Part, Place};
use crate::image_io::WriteImageError;
use crate::image_io::write::{WriteAnywhere, write_atomically};

/// Blocks in memory at a time, per thread.
const BLOCKS_PER_THREAD: usize = 2;

/// Writes parts whose rows `fill` gives; the whole file or nothing. `-` is standard output. The file's window on the
/// display is the first part's.
///
/// # Errors
/// One sentence that names the target and the cause; see [`WriteImageError`].
pub fn write_parts(
    path: &Path,
    parts: &[Part],
    fill: &(dyn Fn(Place, &mut [f32]) + Sync),
) -> Result<(), WriteImageError> {
    let window = parts.first().map_or((1, 1), |part| part.size);
    let headers = parts.iter().map(|part| header_of(part, window)).collect();
    write_atomically(path, |target| {
        exr::block::write(target, headers, true, |meta, writer| write_blocks(&meta, writer, fill)).map_err(plain_error)
    })
}

fn write_blocks(
    meta: &MetaData,
    writer: &mut ChunkWriter<&mut dyn WriteAnywhere>,
    fill: &(dyn Fn(Place, &mut [f32]) + Sync),
) -> UnitResult {
    let blocks: Vec<(usize, BlockIndex)> = enumerate_ordered_header_block_indices(&meta.headers).collect();
    for batch in blocks.chunks(BLOCKS_PER_THREAD * rayon::current_num_threads()) {
        let compress = |&(index, block): &(usize, BlockIndex)| {
            filled(block, &meta.headers[block.layer], fill).compress_to_chunk(&meta.headers).map(|chunk| (index, chunk))
        };
        let compressed: Vec<_> = batch.par_iter().map(compress).collect();
        for chunk in compressed {
            let (index, chunk) = chunk?;
            writer.write_chunk(index, chunk)?;
        }
    }
    Ok(())
}

/// A block with its samples: row by row, the channels of a row one after another.
fn filled(block: BlockIndex, header: &Header, fill: &(dyn Fn(Place, &mut [f32]) + Sync)) -> UncompressedBlock {
    let (width, channels) = (block.pixel_size.width(), header.channels.list.len());
    let mut samples = vec![0.0_f32; block.pixel_size.area() * channels];
    for (line, row) in samples.chunks_mut(width).enumerate() {
        let y = block.pixel_position.y() + line / channels;
        fill(Place { part: block.layer, channel: line % channels, x: block.pixel_position.x(), y }, row);
    }
    UncompressedBlock { index: block, data: bytemuck::cast_slice(&samples).to_vec() }
}

fn header_of(part: &Part, window: (usize, usize)) -> Header {
    let channels =
        part.channels.iter().map(|name| ChannelDescription::new(text(name), SampleType::F32, true)).collect();
    Header::new(text(&part.name), part.size, channels)
        .with_encoding(Compression::ZIP16, BlockDescription::ScanLines, LineOrder::Increasing)
        .with_attributes(attributes_of(&part.name, &part.notes))
        .with_display_window(IntegerBounds::from_dimensions(Vec2(window.0, window.1)))
}

fn attributes_of(name: &str, notes: &Notes) -> LayerAttributes {
    let given = |value: &String| (!value.is_empty()).then(|| text(value));
    let mut attributes = LayerAttributes::named(text(name));
    attributes.software_name = given(&notes.software);
    attributes.wrap_mode_name = given(&notes.wrap_mode);
    let own = notes.own.iter().map(|(name, value)| (text(name), AttributeValue::Text(text(value))));
    attributes.other.extend(own);
    attributes
}

/// ASCII text; anything else becomes a question mark, for the format has no word on encodings.
fn text(value: &str) -> Text {
    let ascii = |c: char| if c.is_ascii() && c != '\0' { c as u8 } else { b'?' };
    Text::from_bytes_unchecked(value.chars().map(ascii).collect())
}

/// A failure of the system as it is; anything else is one of encoding, and its text goes to the log.
fn plain_error(error: Error) -> std::io::Error {
    match error {
        Error::Io(error) => error,
        other => {
            log::debug!("OpenEXR: {other}");
            ErrorKind::InvalidData.into()
        }
    }
}
