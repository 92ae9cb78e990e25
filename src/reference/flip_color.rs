//! The colour spaces of [`flip`](super::flip::flip), and the distance between two colours in them.
//!
//! YCxCz is L*a*b* without its cube root (Flohr et al. 1993): `Y = 116 Y/Yn - 16`, `Cx = 500 (X/Xn - Y/Yn)`,
//! `Cz = 200 (Y/Yn - Z/Zn)`. Filters that are linear in it are linear in light.

use std::sync::LazyLock;

use glam::{DMat3, DVec3};

/// XYZ from linear sRGB (IEC 61966-2-1 and its white D65), by columns, to the digits of the published program.
const XYZ_FROM_LINEAR: DMat3 = DMat3::from_cols_array(&[
    10_135_552.0 / 24_577_794.0,
    2_613_072.0 / 12_288_897.0,
    1_425_312.0 / 73_733_382.0,
    8_788_810.0 / 24_577_794.0,
    8_788_810.0 / 12_288_897.0,
    8_788_810.0 / 73_733_382.0,
    4_435_075.0 / 24_577_794.0,
    887_015.0 / 12_288_897.0,
    70_074_185.0 / 73_733_382.0,
]);

/// The exponent of the distance (section 4.1).
const QC: f64 = 0.7;
/// The share of the largest distance that is mapped to [`PT`].
const PC: f64 = 0.4;
/// Where the lower part of the distances ends.
const PT: f64 = 0.95;

/// The largest distance of displayed colours, green to blue, raised to `QC`.
static LARGEST: LazyLock<f64> = LazyLock::new(|| hyab(hunt(DVec3::Y), hunt(DVec3::Z)).powf(QC));

/// XYZ over that of white.
fn relative_xyz(linear: DVec3) -> DVec3 {
    XYZ_FROM_LINEAR * linear / (XYZ_FROM_LINEAR * DVec3::ONE)
}

/// YCxCz of linear sRGB.
pub fn opponent_from_linear(linear: DVec3) -> DVec3 {
    let xyz = relative_xyz(linear);
    DVec3::new(116.0 * xyz.y - 16.0, 500.0 * (xyz.x - xyz.y), 200.0 * (xyz.y - xyz.z))
}

/// Linear sRGB of YCxCz, beyond `0..=1` where no display shows it.
pub fn linear_from_opponent(opponent: DVec3) -> DVec3 {
    let y = (opponent.x + 16.0) / 116.0;
    let xyz = DVec3::new(y + opponent.y / 500.0, y, y - opponent.z / 200.0);
    XYZ_FROM_LINEAR.inverse() * (xyz * (XYZ_FROM_LINEAR * DVec3::ONE))
}

/// L*a*b* (CIE 1976) of linear sRGB, the chroma scaled by a hundredth of L*: the Hunt effect.
fn hunt(linear: DVec3) -> DVec3 {
    const DELTA: f64 = 6.0 / 29.0;
    let root = |t: f64| if t > DELTA.powi(3) { t.cbrt() } else { t / (3.0 * DELTA * DELTA) + 4.0 / 29.0 };
    let xyz = relative_xyz(linear);
    let [x, y, z] = xyz.to_array().map(root);
    let lightness = 116.0 * y - 16.0;
    DVec3::new(lightness, 5.0 * lightness * (x - y), 2.0 * lightness * (y - z))
}

/// The city-block distance of lightness plus the Euclidean one of chroma (Abasi et al. 2020).
fn hyab(a: DVec3, b: DVec3) -> f64 {
    let difference = a - b;
    difference.x.abs() + difference.y.hypot(difference.z)
}

/// The colour error of two linear colours, `0..=1` (section 4.1).
pub fn color_difference(a: DVec3, b: DVec3) -> f64 {
    let (power, largest) = (hyab(hunt(a), hunt(b)).powf(QC), *LARGEST);
    let knee = PC * largest;
    if power < knee { PT / knee * power } else { PT + (power - knee) / (largest - knee) * (1.0 - PT) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn white_is_100_without_chroma_in_both_spaces() {
        assert!(opponent_from_linear(DVec3::ONE).abs_diff_eq(DVec3::new(100.0, 0.0, 0.0), 1e-9));
        assert!(hunt(DVec3::ONE).abs_diff_eq(DVec3::new(100.0, 0.0, 0.0), 1e-9));
        assert!(hunt(DVec3::ZERO).abs_diff_eq(DVec3::ZERO, 1e-9));
    }

    #[test]
    fn opponent_colours_come_back() {
        let color = DVec3::new(0.1, 0.7, 0.4);
        assert!(linear_from_opponent(opponent_from_linear(color)).abs_diff_eq(color, 1e-12));
    }

    #[test]
    fn red_is_where_the_cie_put_it() {
        // L*a*b* of sRGB red under D65: 53.24, 80.09, 67.20; chroma times 0.5324.
        let red = hunt(DVec3::X);
        assert!(red.abs_diff_eq(DVec3::new(53.24, 0.5324 * 80.09, 0.5324 * 67.20), 0.05), "{red}");
    }
}
