//! Damaged files through the real readers: maps of every format, files of lobes, sessions. None may panic beyond its
//! reader, take long, or take memory that its map does not need.
//!
//! A binary of its own because a global allocator counts, and one law in it, for tests side by side would count each
//! other's. `MUTATED_FILES=10000 cargo test --test mutations` reads more files than usual.

use std::alloc::System;
use std::io::Cursor;
use std::path::Path;
use std::sync::Arc;
use std::sync::mpsc;
use std::time::{Duration, Instant};

use image::{DynamicImage, ImageFormat};
use ndf_inspector::export::lobes_exr;
use ndf_inspector::filter::vmf::{FitSettings, Objective};
use ndf_inspector::image_io::{RasterImage, Samples, exr_parts};
use ndf_inspector::normal_map::diagnose::Diagnosis;
use ndf_inspector::normal_map::{MapOptions, MapSource, NormalMap, procedural};
use ndf_inspector::session::Session;
use ndf_inspector::session::file::SessionFile;
use stats_alloc::{INSTRUMENTED_SYSTEM, Region, StatsAlloc};

#[global_allocator]
static ALLOCATOR: &StatsAlloc<System> = &INSTRUMENTED_SYSTEM;

/// Files that are read unless the environment says otherwise.
const FILES: usize = 3000;

/// No file may take longer.
const LONGEST: Duration = Duration::from_secs(5);

/// Bytes that a file may take beyond what its map needs, all that was given back counted too.
const MOST_BYTES: usize = 1 << 30;

/// Bytes that a texel needs while it is read: samples, planes, and what the doctor looks at.
const BYTES_PER_TEXEL: usize = 64;

/// A small generator of numbers, the same everywhere: D. Knuth's linear congruence, its upper half.
struct Numbers(u64);

impl Numbers {
    fn next(&mut self) -> usize {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) as usize
    }

    fn below(&mut self, bound: usize) -> usize {
        self.next() % bound.max(1)
    }
}

/// A whole file, and its name.
struct Original {
    name: &'static str,
    bytes: Vec<u8>,
}

fn originals() -> Vec<Original> {
    let image = procedural::find("bricks").expect("a bundled map").image(20);
    let Samples::U8(samples) = &image.samples else { panic!("8 bits") };
    let rgb8 = image::RgbImage::from_raw(20, 20, samples.clone()).expect("as many samples");
    let rgb8 = DynamicImage::ImageRgb8(rgb8);
    let deep = DynamicImage::ImageRgba16(rgb8.to_rgba16());
    let float = DynamicImage::ImageRgb32F(rgb8.to_rgb32f());
    let original = |name, image: &DynamicImage, format| {
        let mut bytes = Cursor::new(Vec::new());
        image.write_to(&mut bytes, format).expect("an image");
        Original { name, bytes: bytes.into_inner() }
    };
    vec![
        original("a.png", &rgb8, ImageFormat::Png),
        original("b.png", &deep, ImageFormat::Png),
        original("a.tga", &rgb8, ImageFormat::Tga),
        original("a.bmp", &rgb8, ImageFormat::Bmp),
        original("a.tif", &rgb8, ImageFormat::Tiff),
        original("b.tif", &deep, ImageFormat::Tiff),
        original("a.jpg", &rgb8, ImageFormat::Jpeg),
        original("a.webp", &rgb8, ImageFormat::WebP),
        original("a.hdr", &float, ImageFormat::Hdr),
        Original { name: "a.exr", bytes: floats(&image) },
        Original { name: "lobes.exr", bytes: lobes() },
        Original { name: "a.ndfi.json", bytes: session() },
    ]
}

fn small_map(side: usize) -> NormalMap {
    procedural::find("bricks").expect("a bundled map").make(side)
}

/// What a writer of files leaves in one.
fn written(name: &str, write: impl FnOnce(&Path)) -> Vec<u8> {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join(name);
    write(&path);
    std::fs::read(path).expect("there")
}

fn floats(image: &RasterImage) -> Vec<u8> {
    let part = exr_parts::Part {
        name: "map".to_owned(),
        size: (image.width, image.height),
        channels: ["B", "G", "R"].map(str::to_owned).to_vec(),
        notes: exr_parts::Notes::default(),
    };
    written("a.exr", |path| {
        let fill = |place: exr_parts::Place, row: &mut [f32]| {
            for (x, value) in (place.x..).zip(row) {
                *value = (image.sample(x, place.y, 2 - place.channel) / 127.5 - 1.0) as f32;
            }
        };
        exr_parts::write_parts(path, &[part], &fill).expect("written");
    })
}

fn fitted() -> Session {
    let mut session = Session::with_map(small_map(12), Arc::new(|| {}));
    session.begin(FitSettings { lobes: 2, objective: Objective::Em, iterations: 4, ..FitSettings::default() });
    session.wait_for_fit(&mut |_| {}).expect("a fit");
    session
}

fn lobes() -> Vec<u8> {
    let fit = fitted().fitting().finished().expect("finished");
    written("lobes.exr", |path| lobes_exr::write(path, &fit).expect("written"))
}

fn session() -> Vec<u8> {
    serde_json::to_vec_pretty(&fitted().to_file()).expect("JSON")
}

/// A file with a few of its bytes changed, moved, lost or doubled; or cut; or with a number made huge.
fn mutate(bytes: &[u8], numbers: &mut Numbers) -> Vec<u8> {
    let mut mutated = bytes.to_vec();
    for _ in 0..=numbers.below(6) {
        // Headers are short and decide most.
        let reach = if numbers.below(2) == 0 { mutated.len().min(200) } else { mutated.len() };
        let at = numbers.below(reach);
        let run = at..(at + 1 + numbers.below(16)).min(mutated.len());
        match numbers.below(8) {
            0 => mutated.truncate(at),
            1 => drop(mutated.drain(run)),
            2 => {
                let again = mutated[run].to_vec();
                let to = numbers.below(mutated.len());
                mutated.splice(to..to, again);
            }
            3 => mutated[run].iter_mut().for_each(|byte| *byte = [0x00, 0x7f, 0x80, 0xff][usize::from(*byte) % 4]),
            4 => mutated[run].iter_mut().for_each(|byte| *byte = numbers.next() as u8),
            _ if mutated.is_empty() => {}
            _ => mutated[at] ^= 1 << numbers.below(8),
        }
        if mutated.is_empty() {
            break;
        }
    }
    mutated
}

/// Puts the checksums of a PNG's chunks right again, so that the decoders behind them see the damage.
fn mend_checksums(png: &mut [u8]) {
    let mut at = 8;
    while let Some(length) = png.get(at..at + 4).and_then(|bytes| bytes.try_into().ok()).map(u32::from_be_bytes) {
        let end = at + 8 + length as usize;
        if end + 4 > png.len() {
            break;
        }
        let sum = crc32fast::hash(&png[at + 4..end]);
        png[end..end + 4].copy_from_slice(&sum.to_be_bytes());
        at = end + 4;
    }
}

/// Reads a file as the program does, as heights or as normals; the texels of what came of it.
fn read(name: &str, bytes: &[u8], as_heights: bool) -> usize {
    if name.ends_with(".json") {
        if let Ok(file) = SessionFile::parse(name, bytes) {
            let mut session = Session::with_map(small_map(8), Arc::new(|| {}));
            session.apply(&file);
            assert!((1..=16).contains(&session.fit_settings().lobes));
        }
        return 0;
    }
    let options = MapOptions { height_scale: as_heights.then_some(1.0), ..MapOptions::default() };
    if name.starts_with("lobes") {
        let fit = lobes_exr::read_bytes(bytes, MapSource::File(name.into()), &options);
        return fit.ok().flatten().map_or(0, |fit| fit.lobes.map.len());
    }
    NormalMap::read_bytes(name, bytes, &options).map_or(0, |map| {
        assert!(!Diagnosis::new(&map.stored, &map.options).findings.is_empty());
        map.len()
    })
}

/// Reads every file, and says which before each.
fn read_all(files: usize, began: &mpsc::Sender<String>) {
    let originals = originals();
    let mut whole = 0;
    for index in 0..files {
        let original = &originals[index % originals.len()];
        let mut bytes = mutate(&original.bytes, &mut Numbers((index as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15)));
        // One round of the formats after the other.
        let round = index / originals.len();
        if original.name.ends_with(".png") && !round.is_multiple_of(4) {
            mend_checksums(&mut bytes);
        }
        let what = format!("{}, mutation {index}", original.name);
        began.send(what.clone()).expect("somebody listens");
        let (start, region) = (Instant::now(), Region::new(ALLOCATOR));
        let texels = read(original.name, &bytes, round.is_multiple_of(2));
        whole += usize::from(texels > 0);
        let taken = region.change().bytes_allocated;
        assert!(start.elapsed() < LONGEST, "{what} took {:?}", start.elapsed());
        assert!(taken < MOST_BYTES + BYTES_PER_TEXEL * texels, "{what} took {taken} bytes for {texels} texels");
    }
    // Most damage is to be noticed; where all of it is, none of it went deep.
    assert!(whole * 20 > files && whole * 2 < files, "{whole} of {files} files were read");
}

#[test]
fn no_damaged_file_panics_hangs_or_takes_more_memory_than_its_map() {
    let files = std::env::var("MUTATED_FILES").ok().and_then(|text| text.parse().ok()).unwrap_or(FILES);
    let (began, news) = mpsc::channel();
    let reader = std::thread::spawn(move || read_all(files, &began));
    let mut latest = String::new();
    loop {
        match news.recv_timeout(2 * LONGEST) {
            Ok(what) => latest = what,
            Err(mpsc::RecvTimeoutError::Timeout) => panic!("{latest} hangs"),
            Err(mpsc::RecvTimeoutError::Disconnected) => break,
        }
    }
    assert!(reader.join().is_ok(), "{latest} panicked");
}
