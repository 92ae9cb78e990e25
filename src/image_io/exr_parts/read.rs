//! Reading parts, block by block, from files that may be hostile.

use std::fs::File;
use std::io::{BufReader, Cursor, Read, Seek};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;

use exr::block::UncompressedBlock;
use exr::block::reader::{ChunksReader, Reader};
use exr::error::{Error, Result as ExrResult};
use exr::meta::MetaData;
use exr::meta::attribute::SampleType;
use exr::meta::header::Header;

use super::{Notes, Part, Place};
use crate::image_io::ReadImageError;
use crate::image_io::open_exr::{FORMAT, PEDANTIC, checked_size, plain_error, unsupported};

/// What bytes are read from.
pub trait Source: Read + Seek {}

impl<T: Read + Seek> Source for T {}

/// The first bytes of an OpenEXR file.
const MAGIC: [u8; 4] = [0x76, 0x2f, 0x31, 0x01];

/// An OpenEXR file whose headers are read and whose samples are not yet.
pub struct PartsReader<'a> {
    name: String,
    source: Box<dyn Source + 'a>,
    headers: Vec<Header>,
    parts: Vec<Part>,
}

impl<'a> PartsReader<'a> {
    /// Opens a regular file; `None` for anything that is no OpenEXR file, and for a file that cannot be opened.
    ///
    /// # Errors
    /// One sentence that names the file and the cause.
    pub fn open(path: &Path) -> Result<Option<Self>, ReadImageError> {
        let is_file = std::fs::metadata(path).is_ok_and(|metadata| metadata.is_file());
        match File::open(path) {
            Ok(file) if is_file => Self::new(path.display().to_string(), Box::new(BufReader::new(file))),
            _ => Ok(None),
        }
    }

    /// Opens a file that is in memory; `None` for anything that is no OpenEXR file.
    ///
    /// # Errors
    /// One sentence that names the file and the cause.
    pub fn open_bytes(name: &str, bytes: &'a [u8]) -> Result<Option<Self>, ReadImageError> {
        Self::new(name.to_owned(), Box::new(Cursor::new(bytes)))
    }

    fn new(name: String, mut source: Box<dyn Source + 'a>) -> Result<Option<Self>, ReadImageError> {
        let mut magic = [0; 4];
        if source.read_exact(&mut magic).is_err() || magic != MAGIC {
            return Ok(None);
        }
        let headers = guarded(&name, || {
            source.rewind()?;
            // Not validated yet: validation has no words of its own for a size that is merely too large.
            Ok(MetaData::read_from_buffered(&mut source, PEDANTIC)?.headers)
        })?;
        let parts = headers.iter().map(part_of).collect();
        Ok(Some(Self { name, source, headers: headers.into_iter().collect(), parts }))
    }

    /// What messages call the file.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The parts, in the file's order.
    pub fn parts(&self) -> &[Part] {
        &self.parts
    }

    /// Checks that a part is flat, of a supported size, and all of 32-bit floats.
    ///
    /// # Errors
    /// One sentence that names the file and the cause.
    pub fn check(&self, part: usize) -> Result<(), ReadImageError> {
        let header = &self.headers[part];
        checked_size(&self.name, header)?;
        if header.deep {
            return Err(unsupported(&self.name, "deep data"));
        }
        let plain = header.channels.list.iter().all(|channel| {
            channel.sample_type == SampleType::F32 && (channel.sampling.x(), channel.sampling.y()) == (1, 1)
        });
        if plain { Ok(()) } else { Err(unsupported(&self.name, "channels other than whole 32-bit floats")) }
    }

    /// Hands every run of samples of the `wanted` parts to `store`; call [`check`](Self::check) on each of them
    /// first.
    ///
    /// # Errors
    /// One sentence that names the file and the cause.
    pub fn read(self, wanted: &[usize], store: &mut dyn FnMut(Place, &[f32])) -> Result<(), ReadImageError> {
        let Self { name, mut source, .. } = self;
        guarded(&name, || {
            source.rewind()?;
            let reader = exr::block::read(source, PEDANTIC)?;
            read_blocks(reader, wanted, store)
        })
    }
}

fn read_blocks<R: Read + Seek>(
    reader: Reader<R>,
    wanted: &[usize],
    store: &mut dyn FnMut(Place, &[f32]),
) -> ExrResult<()> {
    let headers = reader.headers().to_vec();
    let mut blocks = reader
        .filter_chunks(PEDANTIC, |_, tile, block| wanted.contains(&block.layer) && tile.is_largest_resolution_level())?
        .sequential_decompressor(PEDANTIC);
    let mut row = Vec::new();
    while let Some(block) = blocks.decompress_next_block() {
        let block = block?;
        store_block(&block, &headers[block.index.layer], &mut row, store)?;
    }
    Ok(())
}

fn store_block(
    block: &UncompressedBlock,
    header: &Header,
    row: &mut Vec<f32>,
    store: &mut dyn FnMut(Place, &[f32]),
) -> ExrResult<()> {
    for line in block.lines(&header.channels) {
        row.resize(line.location.sample_count, 0.0);
        line.read_samples_into_slice(row)?;
        let (channel, position) = (line.location.channel, line.location.position);
        store(Place { part: block.index.layer, channel, x: position.x(), y: position.y() }, row);
    }
    Ok(())
}

/// Runs a decoder that promises not to panic, and is other people's code all the same.
fn guarded<T>(name: &str, decode: impl FnOnce() -> ExrResult<T>) -> Result<T, ReadImageError> {
    match catch_unwind(AssertUnwindSafe(decode)) {
        Ok(Ok(value)) => Ok(value),
        Ok(Err(Error::Io(error))) => Err(ReadImageError::from_io(name, error.kind())),
        Ok(Err(error)) => Err(plain_error(name, &error)),
        Err(_) => Err(ReadImageError::Damaged { name: name.to_owned(), format: FORMAT }),
    }
}

fn part_of(header: &Header) -> Part {
    use exr::meta::attribute::AttributeValue::Text;
    let own = &header.own_attributes;
    let note = |text: &Option<exr::meta::attribute::Text>| text.as_ref().map_or_else(String::new, ToString::to_string);
    let texts = own.other.iter().filter_map(|(name, value)| match value {
        Text(text) => Some((name.to_string(), text.to_string())),
        _ => None,
    });
    Part {
        name: note(&own.layer_name),
        size: (header.layer_size.width(), header.layer_size.height()),
        channels: header.channels.list.iter().map(|channel| channel.name.to_string()).collect(),
        notes: Notes { software: note(&own.software_name), wrap_mode: note(&own.wrap_mode_name), own: texts.collect() },
    }
}
