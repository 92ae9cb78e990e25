//! How far a picture is from the reference, over the pixels where the surface is seen. Sums run in f64: a million
//! small terms in f32 would lose the digits that are compared.

use super::Picture;

/// A colour of this length, linear, is black: half the first step of an 8-bit sRGB display. Next to nothing to divide by
/// would make one pixel at the edge of light outweigh all others.
pub const BLACK: f64 = 0.5 / 255.0 / 12.92;

/// The normalised colour error (Tan et al. 2005): the Euclidean distance of the colours over the length of the
/// reference's colour, averaged over the covered pixels whose reference is not [`BLACK`]. `None` where there is none.
pub fn normalised_color_error(picture: &Picture, reference: &Picture) -> Option<f64> {
    mean(covered(picture, reference).filter_map(|(color, truth)| {
        let length = truth.length();
        (length > BLACK).then(|| (color - truth).length() / length)
    }))
}

/// The root of the mean squared difference over the covered pixels and three channels. `None` where nothing is seen.
pub fn rmse(picture: &Picture, reference: &Picture) -> Option<f64> {
    mean(covered(picture, reference).map(|(color, truth)| (color - truth).length_squared() / 3.0)).map(f64::sqrt)
}

/// The standard error of a sampled picture, as a normalised colour error, from the picture that its first half of the
/// samples gave. `None` where nothing is seen.
///
/// Of `N` samples with mean `M`, the first half has mean `A` and the second `B = 2M - A`; two independent halves put
/// the variance of `M` at `((A - B) / 2)^2 = (A - M)^2`. Its root goes into the same average as the methods' errors.
/// The samples are a low-discrepancy sequence, whose halves are off by more than the whole, so the estimate errs to
/// the large side.
pub fn standard_error(half: &Picture, whole: &Picture) -> Option<f64> {
    normalised_color_error(half, whole)
}

/// As [`standard_error`], where the part is any number of the first samples: each picture with its samples per pixel.
///
/// Of `N` samples of variance `v`, the mean of the first `n` is off the mean of all with variance `v (1/n - 1/N)`, and
/// the mean of all is off the truth with `v / N`, which is `n / (N - n)` of that. `None` where the part is the whole.
pub fn standard_error_of((part, n): (&Picture, u32), (whole, all): (&Picture, u32)) -> Option<f64> {
    let rest = all.checked_sub(n).filter(|rest| *rest > 0)?;
    Some((f64::from(n) / f64::from(rest)).sqrt() * normalised_color_error(part, whole)?)
}

/// What changes from one frame to the next: the Euclidean distance of a pixel's two colours over the mean length of the
/// reference's two, averaged over the pixels that are covered in both and whose reference is not [`BLACK`] in the mean.
/// `None` where there is none.
pub fn temporal_change(frames: [&Picture; 2], reference: [&Picture; 2]) -> Option<f64> {
    let [before, after] = frames.map(|frame| frame.rgb.iter().map(|color| color.as_dvec3()));
    let [was, is] = reference.map(|frame| frame.rgb.iter().zip(&frame.covered));
    mean(before.zip(after).zip(was.zip(is)).filter_map(|((before, after), ((was, seen), (is, still_seen)))| {
        let length = 0.5 * (was.as_dvec3().length() + is.as_dvec3().length());
        (*seen && *still_seen && length > BLACK).then(|| (after - before).length() / length)
    }))
}

fn covered<'a>(picture: &'a Picture, reference: &'a Picture) -> impl Iterator<Item = (glam::DVec3, glam::DVec3)> + 'a {
    let pairs = picture.rgb.iter().zip(&reference.rgb).zip(&reference.covered);
    pairs.filter(|(_, covered)| **covered).map(|((color, truth), _)| (color.as_dvec3(), truth.as_dvec3()))
}

fn mean(values: impl Iterator<Item = f64>) -> Option<f64> {
    let (sum, count) = values.fold((0.0, 0_u32), |(sum, count), value| (sum + value, count + 1));
    (count > 0).then(|| sum / f64::from(count))
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    fn picture(rgb: [Vec3; 3]) -> Picture {
        Picture { size: [3, 1], rgb: rgb.to_vec(), covered: vec![true, true, false] }
    }

    #[test]
    fn errors_follow_their_definitions_and_skip_what_is_not_seen() {
        let reference = picture([Vec3::new(0.0, 3.0, 4.0), Vec3::ZERO, Vec3::ONE]);
        let other = picture([Vec3::new(1.0, 3.0, 4.0), Vec3::new(0.0, 2.0, 0.0), Vec3::ZERO]);
        // The black pixel has no length to divide by; the third is not covered.
        assert_eq!(normalised_color_error(&other, &reference), Some(0.2));
        let nearly_black = picture([Vec3::new(0.0, 3.0, 4.0), Vec3::splat(1e-5), Vec3::ONE]);
        assert_eq!(normalised_color_error(&other, &nearly_black), Some(0.2));
        assert!(rmse(&other, &reference).is_some_and(|e| (e - (5.0_f64 / 6.0).sqrt()).abs() < 1e-12));
        assert_eq!(rmse(&reference, &reference), Some(0.0));
    }

    #[test]
    fn change_is_over_the_reference_and_only_where_both_frames_are_covered() {
        let [was, mut is] = [0.5, 1.5].map(|grey| picture([Vec3::X * grey, Vec3::ZERO, Vec3::ONE]));
        let other = picture([Vec3::new(0.5, 0.25, 0.0), Vec3::ONE, Vec3::ONE]);
        assert_eq!(temporal_change([&was, &is], [&was, &is]), Some(1.0));
        assert_eq!(temporal_change([&was, &was], [&was, &is]), Some(0.0));
        assert_eq!(temporal_change([&was, &other], [&was, &is]), Some(0.25));
        is.covered = vec![false; 3];
        assert_eq!(temporal_change([&was, &other], [&was, &is]), None);
    }

    /// Independent samples of 1/2 to 3/2, by a multiplicative generator (Lehmer 1951, the constants of Park and Miller
    /// 1988).
    #[test]
    fn any_part_of_the_samples_tells_the_error_of_them_all() {
        let (pixels, all, mut state) = (2000, 60, 1_u64);
        let mut next = || {
            state = state * 48_271 % 0x7fff_ffff;
            0.5 + state as f32 / 0x7fff_ffff_u64 as f32
        };
        let samples: Vec<Vec<f32>> = (0..pixels).map(|_| (0..all).map(|_| next()).collect()).collect();
        let mean = |count: usize| {
            let grey = |samples: &Vec<f32>| Vec3::splat(samples[..count].iter().sum::<f32>() / count as f32);
            Picture { size: [pixels, 1], rgb: samples.iter().map(grey).collect(), covered: vec![true; pixels as usize] }
        };
        let whole = mean(all);
        let truth = Picture { rgb: vec![Vec3::ONE; pixels as usize], ..whole.clone() };
        let off = normalised_color_error(&whole, &truth).expect("seen");
        for n in [15, 30, 45] {
            let stated = standard_error_of((&mean(n), n as u32), (&whole, all as u32)).expect("a part");
            // The mean over 2000 pixels scatters by 2 %.
            assert!((stated / off - 1.0).abs() < 0.08, "{n} of {all}: {stated}, and it is {off}");
        }
        assert_eq!(standard_error_of((&whole, 60), (&whole, 60)), None);
        let half = mean(30);
        assert_eq!(standard_error_of((&half, 30), (&whole, 60)), standard_error(&half, &whole));
    }

    #[test]
    fn a_picture_of_nothing_has_no_error() {
        let nothing = Picture { size: [1, 1], rgb: vec![Vec3::ZERO], covered: vec![false] };
        assert_eq!(normalised_color_error(&nothing, &nothing), None);
        assert_eq!(rmse(&nothing, &nothing), None);
    }
}
