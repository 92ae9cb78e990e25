//! A fit goes to OpenEXR and comes back bit for bit; a hostile file gets one sentence.

use std::path::Path;
use std::sync::Arc;
use std::time::{Duration, Instant};

use exr::prelude::*;
use ndf_inspector::export::lobes_exr::{FittedLobes, read, read_bytes, write};
use ndf_inspector::filter::vmf::{Alignment, Coherence, FitSettings, LevelStats, LobePyramid};
use ndf_inspector::image_io::decode_bytes;
use ndf_inspector::normal_map::{Addressing, MapOptions, MapSource, NormalMap, Warning};
use ndf_inspector::session::{MapRequest, OpenedMap, Session, opening};
use tempfile::TempDir;

use crate::fit::fitted;
use crate::gpu::maps::{mixtures, rough};

fn fit_of(lobes: LobePyramid) -> FittedLobes {
    let level = |level: usize| {
        // The time a level took is not written.
        let mean_log_likelihood = 7.420_049_234_100_341_5 / (1.0 + level as f64);
        let coherence = Coherence { coherence_deg: 1.0 / 3.0, interpolation_error: 0.02, trilinear_error: None };
        (level > 0).then_some(LevelStats {
            mean_log_likelihood,
            mean_lobes: 1.5 + level as f64,
            mean_iterations: 9.25,
            seconds: 0.0,
            log_likelihood_lost: 0.1,
            coherence: (level > 1).then_some(coherence),
        })
    };
    let settings = FitSettings { lobes: 5, align: Alignment::Paper { c: 0.25 }, ..FitSettings::default() };
    FittedLobes { stats: (0..lobes.levels()).map(level).collect(), lobes: Arc::new(lobes), settings }
}

fn folder() -> TempDir {
    tempfile::tempdir().expect("a folder")
}

fn written(fit: &FittedLobes) -> Vec<u8> {
    let folder = folder();
    let path = folder.path().join("lobes.exr");
    write(&path, fit).expect("written");
    std::fs::read(&path).expect("there")
}

fn read_back(bytes: &[u8]) -> FittedLobes {
    let source = MapSource::File("lobes.exr".into());
    read_bytes(bytes, source, &MapOptions::default()).expect("whole").expect("lobes")
}

fn refusal(bytes: &[u8]) -> String {
    let start = Instant::now();
    let source = MapSource::File("bad.exr".into());
    let sentence = read_bytes(bytes, source, &MapOptions::default()).expect_err("refused").to_string();
    assert!(start.elapsed() < Duration::from_secs(5), "{sentence}");
    assert!(sentence.contains("'bad.exr'") && !sentence.contains('\n'), "{sentence}");
    sentence
}

fn bits(values: &[f32]) -> Vec<u32> {
    values.iter().map(|value| value.to_bits()).collect()
}

fn assert_same_normals(a: &NormalMap, b: &NormalMap) {
    assert_eq!((a.width, a.height, a.invalid), (b.width, b.height, b.invalid));
    assert_eq!([bits(&a.x), bits(&a.y), bits(&a.z)], [bits(&b.x), bits(&b.y), bits(&b.z)]);
}

fn assert_same_lobes(a: &LobePyramid, b: &LobePyramid) {
    assert_same_normals(&a.map, &b.map);
    assert_eq!(a.levels(), b.levels());
    for level in 1..a.levels() {
        let (a, b) = (a.level(level).expect("fitted"), b.level(level).expect("read"));
        assert_eq!((a.width, a.height, a.lobes), (b.width, b.height, b.lobes));
        assert_eq!(bits(a.stored.as_flattened()), bits(b.stored.as_flattened()), "level {level}");
    }
    // An invalid texel has no lobe, hence no slot.
    for index in (0..a.map.len()).filter(|&index| a.map.normal(index).is_some()) {
        assert_eq!(a.base_slot(index), b.base_slot(index), "base texel {index}");
    }
}

#[test]
fn lobes_come_back_bit_for_bit() {
    for (width, height, lobes) in [(1, 1, 1), (1, 7, 2), (37, 1, 16), (5, 3, 5), (64, 48, 6), (33, 70, 3)] {
        let fit = fit_of(mixtures(&rough(width, height, Addressing::Clamp), lobes));
        let read = read_back(&written(&fit));
        assert_same_lobes(&fit.lobes, &read.lobes);
        assert_eq!((&fit.settings, &fit.stats), (&read.settings, &read.stats), "{width}x{height}");
        assert_eq!(read.lobes.map.options.addressing, Addressing::Clamp);
    }
}

#[test]
fn the_same_fit_gives_the_same_bytes() {
    let fit = fit_of(mixtures(&rough(20, 9, Addressing::Wrap), 4));
    assert_eq!(written(&fit), written(&fit));
}

#[test]
fn a_file_of_lobes_opens_as_a_finished_fit() {
    let map = rough(24, 17, Addressing::Wrap);
    let settings = FitSettings { lobes: 3, ..FitSettings::default() };
    let fit = FittedLobes { lobes: Arc::new(fitted(&map, &settings)), settings, stats: Vec::new() };
    let folder = folder();
    let path = folder.path().join("lobes.exr");
    write(&path, &fit).expect("written");

    let opened = opening::read(&MapRequest::File { path: path.clone(), options: MapOptions::default() });
    let mut session = Session::with_opened(opened.expect("opened"), Arc::new(|| {}));
    assert!(session.fitting().is_complete());
    assert_eq!(*session.fit_settings(), settings);
    session.begin(settings);
    assert!(!session.fitting().is_running(), "nothing is left to fit");
    assert_same_lobes(&fit.lobes, session.lobes());

    let again = folder.path().join("again.exr");
    write(&again, &session.fitting().finished().expect("finished")).expect("written");
    assert_same_lobes(session.lobes(), &read(&again, &MapOptions::default()).expect("whole").expect("lobes").lobes);

    session.begin(FitSettings { lobes: 2, ..settings });
    assert!(session.fitting().is_running(), "other settings fit anew");
}

#[test]
fn an_image_is_no_file_of_lobes_and_lobes_are_no_image() {
    let image = crate::opening::files::exr_with(&["R", "G", "B"], false);
    let source = || MapSource::File("a.exr".into());
    assert!(read_bytes(&image, source(), &MapOptions::default()).expect("an image").is_none());
    assert!(read_bytes(b"\x89PNG\r\n", source(), &MapOptions::default()).expect("no OpenEXR").is_none());
    let lobes = written(&fit_of(mixtures(&rough(4, 4, Addressing::Wrap), 2)));
    assert!(decode_bytes("a.exr", &lobes).is_err());
}

#[test]
fn options_that_a_fit_cannot_follow_are_answered_by_a_warning() {
    let bytes = written(&fit_of(mixtures(&rough(4, 4, Addressing::Wrap), 2)));
    let request =
        |options: MapOptions| MapRequest::Bytes { name: "a.exr".into(), bytes: bytes.as_slice().into(), options };
    let warnings = |options| -> Vec<Warning> {
        let OpenedMap { map, .. } = opening::read(&request(options)).expect("opened");
        map.warnings.clone()
    };
    let clamp = MapOptions { addressing: Addressing::Clamp, ..MapOptions::default() };
    assert!(!warnings(MapOptions::default()).contains(&Warning::FitKeepsItsOptions));
    assert!(warnings(clamp).contains(&Warning::FitKeepsItsOptions));
}

#[test]
fn a_target_that_cannot_be_written_is_named_and_left_whole() {
    let fit = fit_of(mixtures(&rough(8, 8, Addressing::Wrap), 2));
    let sentence = |path: &Path| write(path, &fit).expect_err("refused").to_string();
    let folder = folder();
    assert!(sentence(&folder.path().join("no/such.exr")).ends_with("its folder does not exist"));
    assert!(sentence(folder.path()).ends_with("it is a folder"));
    #[cfg(target_os = "linux")]
    assert_eq!(sentence(Path::new("/dev/full")), "'/dev/full' cannot be written: the disk is full");
    let path = folder.path().join("kept.exr");
    std::fs::write(&path, b"old").expect("written");
    let mut permissions = std::fs::metadata(&path).expect("there").permissions();
    permissions.set_readonly(true);
    std::fs::set_permissions(&path, permissions).expect("set");
    assert!(sentence(&path).contains("kept.exr"));
    assert_eq!(std::fs::read(&path).expect("there"), b"old");
    assert_eq!(std::fs::read_dir(folder.path()).expect("there").count(), 1, "nothing is left beside the file");
}

/// A part as another program may write it: its name, its size, and the value of each channel.
type ForeignPart<'a> = (&'a str, (usize, usize), &'a [(&'a str, f32)]);

/// A file of lobes of another program.
fn foreign(parts: &[ForeignPart<'_>]) -> Vec<u8> {
    let layer = |&(name, size, channels): &ForeignPart<'_>| {
        let channel =
            |&(name, value): &(&str, f32)| AnyChannel::new(name, FlatSamples::F32(vec![value; size.0 * size.1]));
        let channels = AnyChannels::sort(channels.iter().map(channel).collect());
        Layer::new(size, LayerAttributes::named(name), Encoding::SMALL_FAST_LOSSLESS, channels)
    };
    let mut bytes = std::io::Cursor::new(Vec::new());
    let attributes = ImageAttributes::with_size(parts[0].1);
    let layers: Layers<_> = parts.iter().map(layer).collect();
    Image { attributes, layer_data: layers }.write().non_parallel().to_buffered(&mut bytes).expect("encoded");
    bytes.into_inner()
}

const UP: &[(&str, f32)] = &[("lobe.00.alpha", 1.0), ("lobe.00.rx", 0.0), ("lobe.00.ry", 0.0), ("lobe.00.rz", 1.0)];

fn lobe(alpha: f32, z: f32) -> [(&'static str, f32); 4] {
    [("lobe.00.alpha", alpha), ("lobe.00.rx", 0.0), ("lobe.00.ry", 0.0), ("lobe.00.rz", z)]
}

#[test]
fn a_file_of_another_program_is_read() {
    let fit =
        read_back(&foreign(&[("level.01", (1, 1), UP), ("level.00", (2, 2), UP), ("other", (1, 1), &[("R", 0.5)])]));
    assert_eq!(fit.lobes.map.z, [1.0; 4]);
    assert_eq!(fit.lobes.level(1).map(|level| level.stored.clone()), Some(vec![[1.0, 0.0, 0.0, 1.0]]));
}

#[test]
fn a_part_that_is_missing_or_of_the_wrong_size_is_named() {
    let sentence = refusal(&foreign(&[("level.00", (4, 2), UP), ("level.01", (2, 1), UP)]));
    assert!(sentence.ends_with("holds lobes but lacks the part 'level.02'"), "{sentence}");
    let sentence = refusal(&foreign(&[("level.01", (2, 1), UP)]));
    assert!(sentence.ends_with("lacks the part 'level.00'"), "{sentence}");
    let sentence = refusal(&foreign(&[("level.00", (4, 2), UP), ("level.01", (2, 2), UP), ("level.02", (1, 1), UP)]));
    assert!(sentence.ends_with("its part 'level.01' is 2 x 2 texels, not 2 x 1"), "{sentence}");
}

#[test]
fn channels_that_make_no_lobe_are_refused() {
    let sentence = refusal(&foreign(&[("level.00", (1, 1), &UP[..3])]));
    assert!(
        sentence.ends_with(
            "its part 'level.00' does not hold 1 to 16 lobes of four channels each, or of seven with colour"
        ),
        "{sentence}"
    );
    let far: Vec<(&str, f32)> = UP.iter().copied().chain([("lobe.16.alpha", 0.0)]).collect();
    assert!(refusal(&foreign(&[("level.00", (1, 1), &far)])).contains("1 to 16 lobes"));
    let half_coloured: Vec<(&str, f32)> = UP.iter().copied().chain([("lobe.00.cr", 1.0)]).collect();
    assert!(refusal(&foreign(&[("level.00", (1, 1), &half_coloured)])).contains("1 to 16 lobes"));
    let coloured: Vec<(&str, f32)> =
        half_coloured.iter().copied().chain([("lobe.00.cg", 1.0), ("lobe.00.cb", 1.0)]).collect();
    let sentence = refusal(&foreign(&[("level.00", (2, 1), &coloured), ("level.01", (1, 1), UP)]));
    assert!(sentence.contains("its part 'level.01' does not hold"), "{sentence}");
}

#[test]
fn values_that_are_no_mixture_are_refused() {
    let above = |lobe: &[(&str, f32)]| refusal(&foreign(&[("level.00", (2, 1), UP), ("level.01", (1, 1), lobe)]));
    assert!(above(&lobe(f32::NAN, 1.0)).ends_with("its part 'level.01' holds values that are not numbers"));
    assert!(above(&lobe(1.0, f32::INFINITY)).contains("not numbers"));
    let sentence = above(&lobe(0.5, 0.2));
    assert!(sentence.ends_with("in its part 'level.01' the lobes of texel (0, 0) are no mixture"), "{sentence}");
    assert!(above(&lobe(1.0, 1.1)).contains("no mixture"));
    assert!(above(&lobe(-1.0, 0.0)).contains("no mixture"));
    let base = |lobe: &[(&str, f32)]| refusal(&foreign(&[("level.00", (1, 1), lobe)]));
    assert!(base(&lobe(f32::NAN, 1.0)).contains("not numbers"));
    assert!(base(&lobe(0.5, 0.5)).contains("part 'level.00' the lobes of texel (0, 0)"));
    assert!(base(&lobe(1.0, 0.5)).contains("no mixture"));
    assert!(base(&lobe(0.0, 0.0)).ends_with("holds lobes but no normal at all"));
}

#[test]
fn a_file_cut_anywhere_or_damaged_is_refused_or_read_and_never_more() {
    let bytes = written(&fit_of(mixtures(&rough(40, 21, Addressing::Wrap), 2)));
    for keep in (5..bytes.len()).step_by(bytes.len() / 60) {
        let sentence = refusal(&bytes[..keep]);
        assert!(sentence.contains("cut short") || sentence.contains("damaged"), "{keep}: {sentence}");
    }
    for at in (8..bytes.len()).step_by(7) {
        let mut bad = bytes.clone();
        bad[at] ^= 0xff;
        let start = Instant::now();
        let result = read_bytes(&bad, MapSource::File("bad.exr".into()), &MapOptions::default());
        assert!(start.elapsed() < Duration::from_secs(5), "byte {at}");
        let sentence = result.err().map_or_else(String::new, |error| error.to_string());
        assert!(!sentence.contains('\n'), "{sentence}");
    }
}

#[test]
fn a_claim_of_too_many_texels_is_refused_before_memory_is_taken() {
    let mut bytes = written(&fit_of(mixtures(&rough(1, 1, Addressing::Wrap), 1)));
    let start = bytes.windows(11).position(|window| window == b"dataWindow\0").expect("there");
    // The name, the type `box2i`, four bytes of length, then x and y of the two corners.
    let corner = start + 11 + 6 + 4 + 8;
    bytes[corner..corner + 8].copy_from_slice(&[0x9f, 0x86, 1, 0, 0x9f, 0x86, 1, 0]);
    assert!(refusal(&bytes).contains("100000x100000"));
}
