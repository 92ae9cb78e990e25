//! The import doctor, on every bundled map and on variants made from each as files come in the wild.

use glam::DVec3;
use ndf_inspector::color::srgb_from_linear;
use ndf_inspector::image_io::{RasterImage, Samples};
use ndf_inspector::normal_map::decode::Decoder;
use ndf_inspector::normal_map::diagnose::{Confidence, Diagnosis, Subject};
use ndf_inspector::normal_map::procedural::{self, SAMPLES, Sample};
use ndf_inspector::normal_map::{Addressing, MapOptions, MapSource, NormalMap};
use serde_json::Value;

use crate::cli::{folder, json, run, sample};

/// Texels along a side.
const SIDE: usize = 96;

/// Maps whose texels are made one by one and are of no one surface, or vary along one direction only: nothing tells the
/// sign of y.
const WITHOUT_SIGN: [&str; 2] = ["v-groove", "flakes"];

/// A way to store a normal at a place from 0 to 1, as red, green and blue from 0 to 1.
type Store = fn(DVec3, [f64; 2]) -> DVec3;

/// A variant: its name, how it stores a normal, and the answers that are right.
struct Variant {
    name: &'static str,
    store: Store,
    answers: &'static [(Subject, &'static str)],
}

fn half(vector: DVec3) -> DVec3 {
    (vector + 1.0) / 2.0
}

/// A number from 0 to 1 that differs from texel to texel.
fn noise([u, v]: [f64; 2]) -> f64 {
    (((u * 12.9898 + v * 78.233) * SIDE as f64).sin() * 43758.5453).rem_euclid(1.0)
}

/// The normal on a sphere, whose map runs around its axis and from pole to pole.
fn on_a_sphere(normal: DVec3, [u, v]: [f64; 2]) -> DVec3 {
    let (longitude, colatitude) = (u * std::f64::consts::TAU, v * std::f64::consts::PI);
    let out = DVec3::new(colatitude.sin() * longitude.cos(), colatitude.cos(), colatitude.sin() * longitude.sin());
    let right = DVec3::new(-longitude.sin(), 0.0, longitude.cos());
    normal.x * right + normal.y * right.cross(out) + normal.z * out
}

const TANGENT: (Subject, &str) = (Subject::Space, "tangent");
const LINEAR: (Subject, &str) = (Subject::Encoding, "linear");
const NORMALS: (Subject, &str) = (Subject::Content, "normals");
const SIGNED: (Subject, &str) = (Subject::Z, "from -1 to 1");
const ABSENT: (Subject, &str) = (Subject::Z, "absent");
const UP: (Subject, &str) = (Subject::Green, "+Y up");
const UNIT: (Subject, &str) = (Subject::Lengths, "unit");

const VARIANTS: [Variant; 10] = [
    Variant {
        name: "as it is",
        store: |normal, _| half(normal),
        answers: &[NORMALS, LINEAR, SIGNED, TANGENT, UP, UNIT],
    },
    Variant {
        name: "green flipped",
        store: |normal, _| half(normal * DVec3::new(1.0, -1.0, 1.0)),
        answers: &[NORMALS, LINEAR, SIGNED, TANGENT, (Subject::Green, "+Y down"), UNIT],
    },
    Variant {
        name: "two-channel, blue 0",
        store: |normal, _| half(normal).with_z(0.0),
        answers: &[NORMALS, LINEAR, ABSENT, TANGENT, UP, UNIT],
    },
    Variant {
        name: "two-channel, blue 255",
        store: |normal, _| half(normal).with_z(1.0),
        answers: &[NORMALS, LINEAR, ABSENT, TANGENT, UP, UNIT],
    },
    Variant {
        name: "sRGB-encoded",
        store: |normal, _| half(normal).to_array().map(|value| f64::from(srgb_from_linear(value as f32))).into(),
        answers: &[NORMALS, (Subject::Encoding, "sRGB-encoded"), SIGNED, TANGENT, UP, UNIT],
    },
    Variant {
        name: "z from 0 to 1",
        store: |normal, _| half(normal).with_z(normal.z),
        answers: &[NORMALS, LINEAR, (Subject::Z, "from 0 to 1"), TANGENT, UP, UNIT],
    },
    Variant {
        name: "height",
        store: |normal, _| DVec3::splat(half(normal).dot(DVec3::splat(1.0 / 3.0))),
        answers: &[(Subject::Content, "heights")],
    },
    Variant {
        name: "object space, a sphere",
        store: |normal, place| half(on_a_sphere(normal, place)),
        answers: &[NORMALS, LINEAR, SIGNED, (Subject::Space, "object"), UNIT],
    },
    Variant {
        name: "object space, a wall",
        store: |normal, _| half(DVec3::new(normal.x, normal.z, -normal.y)),
        answers: &[NORMALS, LINEAR, SIGNED, (Subject::Space, "object"), UNIT],
    },
    Variant {
        name: "unnormalised",
        store: |normal, place| half(normal * (0.5 + 0.5 * noise(place))),
        answers: &[NORMALS, LINEAR, SIGNED, TANGENT, UP, (Subject::Lengths, "off unit")],
    },
];

/// A map of `side` texels, stored another way in 8 bits.
fn stored(map: &Sample, side: usize, store: Store) -> RasterImage {
    let mut image = map.image(side);
    let decoder = Decoder::new(&image, &MapOptions::default());
    let texel = |texel: usize| {
        let place = [texel % side, texel / side].map(|at| (at as f64 + 0.5) / side as f64);
        let normal = decoder.normal(&image, texel).expect("a normal");
        store(normal, place).to_array().map(|value| (value.clamp(0.0, 1.0) * 255.0).round() as u8)
    };
    image.samples = Samples::U8((0..side * side).flat_map(texel).collect());
    image
}

fn answer(diagnosis: &Diagnosis, subject: Subject) -> (&str, Confidence) {
    diagnosis.on(subject).map_or(("none", Confidence::Unknown), |finding| (&finding.answer, finding.confidence))
}

#[test]
fn the_doctor_is_right_on_nearly_all_variants_and_never_sure_and_wrong() {
    let (mut right, mut asked, mut missed) = (0, 0, Vec::new());
    for (map, variant) in SAMPLES.iter().flat_map(|map| VARIANTS.iter().map(move |variant| (map, variant))) {
        let diagnosis = Diagnosis::new(&stored(map, SIDE, variant.store), &MapOptions::default());
        for &(subject, expected) in variant.answers {
            let no_sign = subject == Subject::Green && WITHOUT_SIGN.contains(&map.name);
            let expected = if no_sign { "cannot tell" } else { expected };
            let (answer, confidence) = answer(&diagnosis, subject);
            asked += 1;
            right += usize::from(answer == expected);
            if answer != expected {
                let what = format!("{}, {}: {subject:?} is {answer}, {confidence}", map.name, variant.name);
                assert_ne!(confidence, Confidence::Certain, "{what}");
                missed.push(what);
            }
        }
    }
    assert!(right * 100 >= asked * 95, "{right} of {asked} right: {missed:#?}");
}

#[test]
fn what_the_doctor_advises_brings_the_map_back() {
    // Rounding the samples anew, on a curve or without z, moves a normal by a few steps of 8 bits.
    const ROUNDING: f32 = 0.06;
    let map = procedural::find("bricks").expect("a bundled map");
    let original = map.make(SIDE);
    for variant in &VARIANTS[..6] {
        let image = stored(map, SIDE, variant.store);
        let diagnosis = Diagnosis::new(&image, &MapOptions::default());
        let advised = diagnosis.findings.iter().filter(|finding| finding.doubtful).filter_map(|finding| finding.advice);
        let options = advised.fold(MapOptions::default(), |options, advice| advice.apply(&options));
        let read = NormalMap::from_image(image, MapSource::Bundled("test"), &options).expect("a normal map");
        let far = |texel: &usize| {
            (read.normal(*texel).expect("a normal") - original.normal(*texel).expect("a normal")).length() > ROUNDING
        };
        let count = (0..read.len()).filter(far).count();
        assert!(count * 100 < read.len(), "{}: {count} normals are elsewhere", variant.name);
        assert_eq!(options == MapOptions::default(), variant.name == "as it is", "{}", variant.name);
    }
}

#[test]
fn x_in_alpha_is_found_and_brings_the_map_back() {
    type Pack = fn([u8; 3]) -> Vec<u8>;
    let layouts: [(&str, Pack, &str, Confidence); 3] = [
        ("red full", |[x, y, _]| vec![255, y, 255, x], "x", Confidence::Likely),
        ("grey", |[x, y, _]| vec![y, y, y, x], "carries something", Confidence::Certain),
        ("one colour", |[x, y, _]| vec![y, x], "carries something", Confidence::Certain),
    ];
    let map = procedural::find("scales").expect("a bundled map");
    let (original, plain) = (map.make(SIDE), map.image(SIDE));
    for (name, pack, expected, confidence) in layouts {
        let Samples::U8(rgb) = &plain.samples else { panic!("8 bits") };
        let samples: Vec<u8> = rgb.chunks_exact(3).flat_map(|rgb| pack([rgb[0], rgb[1], rgb[2]])).collect();
        let channels = samples.len() / (SIDE * SIDE);
        let image = RasterImage { channels, has_alpha: true, samples: Samples::U8(samples), ..plain.clone() };
        let diagnosis = Diagnosis::new(&image, &MapOptions::default());
        assert_eq!(answer(&diagnosis, Subject::Alpha), (expected, confidence), "{name}");
        assert_ne!(answer(&diagnosis, Subject::Content), ("heights", Confidence::Certain), "{name}: it may be y");
        if expected == "x" {
            let others = [ABSENT, UP, TANGENT, UNIT].map(|(subject, right)| answer(&diagnosis, subject).0 == right);
            assert_eq!(others, [true; 4], "{name}: {:#?}", diagnosis.findings);
        }
        let options = MapOptions { x_in_alpha: true, ..MapOptions::default() };
        let read = NormalMap::from_image(image.clone(), MapSource::Bundled("test"), &options).expect("a normal map");
        let far = (0..read.len()).filter(|&texel| {
            let [read, original] = [&read, &original].map(|map| map.normal(texel).expect("a normal"));
            (read - original).length() > 0.06
        });
        assert!(far.count() * 100 < read.len(), "{name}");
        assert!(!read.warnings.iter().any(|warning| warning.to_string().contains("alpha")), "{name}: it is used");
        let alpha = Diagnosis::new(&image, &options);
        assert_eq!(alpha.on(Subject::Alpha).map(|finding| finding.doubtful), Some(false), "{name}");
    }
    let options = MapOptions { x_in_alpha: true, ..MapOptions::default() };
    let refused = NormalMap::from_image(plain, MapSource::Bundled("scales"), &options).expect_err("no alpha");
    assert_eq!(refused.to_string(), "'scales' has no alpha channel that could hold x");
}

#[test]
fn a_row_a_texel_and_a_tiny_map_tell_nothing_by_their_statistics() {
    let statistical = [
        Subject::Content,
        Subject::Encoding,
        Subject::Z,
        Subject::Space,
        Subject::Green,
        Subject::Lengths,
        Subject::Tiling,
    ];
    let whole = procedural::find("bricks").expect("a bundled map").image(SIDE);
    for (width, height) in [(1, 1), (37, 1), (7, 5), (1, 63)] {
        let Samples::U8(samples) = &whole.samples else { panic!("8 bits") };
        let samples = Samples::U8(samples[..width * height * 3].to_vec());
        let image = RasterImage { width, height, samples, ..whole.clone() };
        let diagnosis = Diagnosis::new(&image, &MapOptions::default());
        for subject in statistical {
            assert_eq!(
                answer(&diagnosis, subject),
                ("cannot tell", Confidence::Unknown),
                "{width} x {height}: {subject:?}"
            );
        }
        assert!(!diagnosis.is_doubtful());
    }
}

#[test]
fn an_edge_that_does_not_meet_its_opposite_is_a_seam() {
    let whole = procedural::find("waves").expect("a bundled map").image(2 * SIDE);
    let tiling = |image: &RasterImage| {
        let diagnosis = Diagnosis::new(image, &MapOptions::default());
        (answer(&diagnosis, Subject::Tiling).0.to_owned(), diagnosis.is_doubtful())
    };
    assert_eq!(tiling(&whole), ("no seam".to_owned(), false));
    let texel = |index: usize| [0, 1, 2].map(|channel| whole.sample(index % SIDE + 5, index / SIDE, channel) as u8);
    let cut = RasterImage {
        width: SIDE,
        height: SIDE,
        samples: Samples::U8((0..SIDE * SIDE).flat_map(texel).collect()),
        ..whole.clone()
    };
    assert_eq!(tiling(&cut), ("seams".to_owned(), true));
    let clamped = MapOptions { addressing: Addressing::Clamp, ..MapOptions::default() };
    assert!(!Diagnosis::new(&cut, &clamped).is_doubtful());
}

#[test]
fn the_command_says_by_its_exit_status_whether_anything_is_doubtful() {
    let folder = folder();
    sample(&folder, "bricks");
    let report = json(&run(&folder, &["doctor", "bricks.png", "--json"]));
    assert_eq!((&report["schema"], &report["doubtful"]), (&Value::from(1), &Value::from(false)));
    assert_eq!(report["map"]["width"], 64);
    let total: u64 = report["lengths"]["counts"].as_array().expect("counts").iter().filter_map(Value::as_u64).sum();
    assert_eq!(total, 64 * 64);

    let down = run(&folder, &["doctor", "bricks.png", "--y", "down"]);
    assert_eq!(down.status.code(), Some(3));
    let text = String::from_utf8_lossy(&down.stdout).into_owned();
    let doubts: Vec<&str> = text.lines().filter(|line| line.starts_with('!')).collect();
    assert!(matches!(doubts[..], [line] if line.contains("+Y up") && line.ends_with("settled by --y up")), "{text}");

    assert_eq!(run(&folder, &["doctor"]).status.code(), Some(2));
    crate::cli::assert_refused(&run(&folder, &["doctor", "gone.png"]), "gone.png");
}
