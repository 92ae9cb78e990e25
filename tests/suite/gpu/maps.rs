//! Maps and lobes made for the tests: anything goes, as long as it is the same every time.

use std::sync::Arc;

use glam::{DVec3, Vec3};
use ndf_inspector::filter::vmf::{BaseSlots, ColorLevel, LobePyramid, MixtureLevel};
use ndf_inspector::image_io::{RasterImage, SampleDepth, Samples};
use ndf_inspector::normal_map::albedo::Albedo;
use ndf_inspector::normal_map::{Addressing, MapOptions, MapSource, NormalMap};
use ndf_inspector::sphere::Lobe;

/// A map of `width` by `height` texels whose normals `normal` gives (normalised here; zero for an invalid texel).
pub fn map(
    width: usize,
    height: usize,
    addressing: Addressing,
    normal: impl Fn(usize, usize) -> Vec3,
) -> Arc<NormalMap> {
    let normals: Vec<Vec3> = (0..width * height).map(|i| normal(i % width, i / width).normalize_or_zero()).collect();
    let samples = Samples::F32(normals.iter().flat_map(Vec3::to_array).collect());
    let depth = SampleDepth::Float;
    let stored = RasterImage {
        width,
        height,
        channels: 3,
        has_alpha: false,
        samples,
        depth,
        format: "none",
        tagged_srgb: false,
    };
    Arc::new(NormalMap {
        width,
        height,
        x: normals.iter().map(|n| n.x).collect(),
        y: normals.iter().map(|n| n.y).collect(),
        z: normals.iter().map(|n| n.z).collect(),
        invalid: normals.iter().filter(|n| **n == Vec3::ZERO).count(),
        options: MapOptions { addressing, ..MapOptions::default() },
        source: MapSource::Bundled("test"),
        stored: Arc::new(stored),
        warnings: Vec::new(),
        decoder: None,
        albedo: None,
    })
}

/// A number in `0..1` that looks random.
pub fn noise(seed: usize) -> f32 {
    let mut state = seed as u32;
    for multiplier in [0x7FEB_352D_u32, 0x846C_A68B] {
        state = (state ^ (state >> 16)).wrapping_mul(multiplier);
    }
    ((state ^ (state >> 16)) >> 8) as f32 / 16_777_216.0
}

/// Waves with noise on them, an invalid texel here and there.
pub fn rough(width: usize, height: usize, addressing: Addressing) -> Arc<NormalMap> {
    map(width, height, addressing, |x, y| {
        let seed = 3 * (y * width + x);
        if noise(seed + 7) < 0.002 {
            return Vec3::ZERO;
        }
        let wave = 0.4 * (x as f32 * 0.3).sin() + 0.3 * (noise(seed) - 0.5);
        Vec3::new(wave, 0.5 * (y as f32 * 0.2).cos() + 0.3 * (noise(seed + 1) - 0.5), 1.0)
    })
}

/// The same map with a colour for every texel.
pub fn with_color(map: Arc<NormalMap>, color: impl Fn(usize) -> Vec3) -> Arc<NormalMap> {
    let mut map = Arc::unwrap_or_clone(map);
    map.albedo = Some(Arc::new(Albedo { rgb: (0..map.len()).map(|index| color(index).to_array()).collect() }));
    Arc::new(map)
}

/// A colour that looks random, of channels from 0 to 1.5: a colour may exceed 1.
pub fn any_color(seed: usize) -> Vec3 {
    1.5 * Vec3::new(noise(7 * seed), noise(7 * seed + 1), noise(7 * seed + 2))
}

/// A square bump in the middle of a flat map, which rises towards its centre.
pub fn bump() -> Arc<NormalMap> {
    map(64, 64, Addressing::Wrap, |x, y| {
        let (dx, dy) = (x as f32 - 31.5, 31.5 - y as f32);
        let radius = dx.hypot(dy);
        if radius < 22.0 { Vec3::new(dx / 22.0, dy / 22.0, 1.0) } else { Vec3::Z }
    })
}

/// Lobes of every level, of widths from a delta to nearly uniform; a slot in five is empty. Colours of their own where
/// the map has colour.
pub fn mixtures(map: &Arc<NormalMap>, lobes: usize) -> LobePyramid {
    let level = |(width, height): (usize, usize), level: usize| {
        let mut mixtures = MixtureLevel::empty((width, height), lobes);
        for texel in 0..width * height {
            let seed = |what: usize, slot: usize| noise(what + 8 * (slot + 16 * (texel + 100_000 * level)));
            let weights: Vec<f32> = (0..lobes)
                .map(|slot| if slot > 0 && seed(0, slot) < 0.2 { 0.0 } else { 0.1 + seed(1, slot) })
                .collect();
            let total: f32 = weights.iter().sum();
            for (slot, weight) in weights.iter().enumerate() {
                let (tilt, turn) = (0.7 * seed(2, slot), slot as f32 + 0.5 * seed(3, slot));
                let lobe = Lobe {
                    weight: f64::from(weight / total),
                    mean_direction: DVec3::new(f64::from(tilt * turn.cos()), f64::from(tilt * turn.sin()), 1.0)
                        .normalize(),
                    concentration: 10.0_f64.powf(f64::from(6.0 * seed(4, slot) - 1.0)),
                };
                mixtures.stored[texel * lobes + slot] = lobe.to_stored();
            }
        }
        Some(Arc::new(mixtures))
    };
    let colors = |mixtures: &Arc<MixtureLevel>, level: usize| {
        let color = |(at, stored): (usize, &[f32; 4])| (stored[0] * any_color(at + 1_000_000 * level)).to_array();
        Arc::new(ColorLevel { stored: mixtures.stored.iter().enumerate().map(color).collect() })
    };
    let sizes = map.level_sizes();
    // A map of one texel has no coarser level, hence one slot.
    let lobes = if sizes.len() == 1 { 1 } else { lobes };
    let slots = (0..map.len()).map(|i| (noise(i + 99) * lobes as f32) as u8).collect();
    let coarse: Vec<_> = sizes[1..].iter().enumerate().map(|(k, &size)| level(size, k)).collect();
    let colored = coarse.iter().enumerate().map(|(k, level)| level.as_ref().map(|level| colors(level, k)));
    LobePyramid {
        map: map.clone(),
        base: Some(Arc::new(BaseSlots { slots })),
        colors: if map.albedo.is_some() { colored.collect() } else { vec![None; sizes.len() - 1] },
        coarse,
    }
}
