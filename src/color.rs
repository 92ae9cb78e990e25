//! Colour: sRGB encoding, the lobes' fixed colours, and the scales of heat and difference.

use glam::Vec3;

/// Luminance of linear sRGB (IEC 61966-2-1, ITU-R BT.709).
pub fn luminance(rgb: Vec3) -> f32 {
    Vec3::new(0.2126, 0.7152, 0.0722).dot(rgb)
}

/// sRGB code value of linear `value` (IEC 61966-2-1), both in `0..=1`; the shaders' twin.
pub fn srgb_from_linear(value: f32) -> f32 {
    let value = value.clamp(0.0, 1.0);
    if value <= 0.003_130_8 { 12.92 * value } else { 1.055 * value.powf(1.0 / 2.4) - 0.055 }
}

/// Linear value of sRGB code `value`, both in `0..=1`.
pub fn linear_from_srgb(value: f32) -> f32 {
    if value <= 0.040_45 { value / 12.92 } else { ((value + 0.055) / 1.055).powf(2.4) }
}

/// Eight-bit sRGB of linear RGB.
pub fn srgb8_from_linear(rgb: Vec3) -> [u8; 3] {
    rgb.to_array().map(|v| (255.0 * srgb_from_linear(v) + 0.5) as u8)
}

/// The colour of a lobe by its slot: Okabe and Ito's colour-blind-safe set (2008) with black replaced by grey for
/// dark backgrounds, then the same eight lightened.
pub const LOBE_COLORS: [[u8; 3]; 16] = [
    [230, 159, 0],
    [86, 180, 233],
    [0, 158, 115],
    [240, 228, 66],
    [0, 114, 178],
    [213, 94, 0],
    [204, 121, 167],
    [153, 153, 153],
    [242, 207, 128],
    [170, 217, 244],
    [128, 206, 185],
    [247, 241, 160],
    [128, 184, 216],
    [234, 174, 128],
    [229, 188, 211],
    [204, 204, 204],
];

/// A perceptual sequential map from dark to bright for `t` in `0..=1`: nine stops of the map *inferno*
/// (Smith and van der Walt 2015), sRGB.
pub fn heat(t: f32) -> [u8; 3] {
    const STOPS: [[f32; 3]; COLOR_STOPS] = [
        [0.0, 0.0, 4.0],
        [31.0, 12.0, 72.0],
        [85.0, 15.0, 109.0],
        [136.0, 34.0, 106.0],
        [186.0, 54.0, 85.0],
        [227.0, 89.0, 51.0],
        [249.0, 140.0, 10.0],
        [249.0, 201.0, 50.0],
        [252.0, 255.0, 164.0],
    ];
    between(&STOPS, t)
}

/// A diverging map from blue over light grey to red for `t` in `0..=1`: nine stops of the *smooth cool-warm* map
/// (Moreland 2009), sRGB.
pub fn diverging(t: f32) -> [u8; 3] {
    const STOPS: [[f32; 3]; COLOR_STOPS] = [
        [59.0, 76.0, 192.0],
        [98.0, 130.0, 234.0],
        [141.0, 176.0, 254.0],
        [184.0, 208.0, 249.0],
        [221.0, 221.0, 221.0],
        [245.0, 196.0, 173.0],
        [244.0, 154.0, 123.0],
        [222.0, 96.0, 77.0],
        [180.0, 4.0, 38.0],
    ];
    between(&STOPS, t)
}

/// Stops of a colour map, evenly spaced from 0 to 1.
pub const COLOR_STOPS: usize = 9;

/// The stops of a colour map as the shaders take them: sRGB in `0..=1`, and opaque.
pub fn color_stops(map: impl Fn(f32) -> [u8; 3]) -> [[f32; 4]; COLOR_STOPS] {
    std::array::from_fn(|stop| {
        let [r, g, b] = map(stop as f32 / (COLOR_STOPS - 1) as f32).map(|code| f32::from(code) / 255.0);
        [r, g, b, 1.0]
    })
}

fn between(stops: &[[f32; 3]; COLOR_STOPS], t: f32) -> [u8; 3] {
    let scaled = t.clamp(0.0, 1.0) * (COLOR_STOPS - 1) as f32;
    let index = (scaled as usize).min(COLOR_STOPS - 2);
    let blend = scaled - index as f32;
    std::array::from_fn(|c| (stops[index][c] * (1.0 - blend) + stops[index + 1][c] * blend).round() as u8)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn srgb_decodes_what_it_encodes() {
        for i in 0..=1000 {
            let value = i as f32 / 1000.0;
            assert!((linear_from_srgb(srgb_from_linear(value)) - value).abs() < 1e-5);
        }
    }

    #[test]
    fn the_diverging_map_is_brightest_and_grey_in_the_middle() {
        let luma = |t: f32| diverging(t).iter().map(|&c| u32::from(c)).sum::<u32>();
        assert!((0..4).all(|i| luma(i as f32 / 8.0) < luma((i + 1) as f32 / 8.0)));
        assert!((4..8).all(|i| luma(i as f32 / 8.0) > luma((i + 1) as f32 / 8.0)));
        let [r, g, b] = diverging(0.5);
        assert!(r == g && g == b);
    }

    #[test]
    fn heat_runs_from_dark_to_bright() {
        let luma = |t: f32| heat(t).iter().map(|&c| u32::from(c)).sum::<u32>();
        assert!((0..10).all(|i| luma(i as f32 / 10.0) < luma((i + 1) as f32 / 10.0)));
    }
}
