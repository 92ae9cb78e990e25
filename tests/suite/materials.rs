//! What holds of every reflectance model: it is a density over the sphere, reciprocal, and gives back no more than it
//! gets; and lobes filter it about as well as Blinn-Phong.

use std::f64::consts::PI;
use std::sync::Arc;

use glam::DVec3;
use ndf_inspector::brdf::fresnel::fresnel;
use ndf_inspector::brdf::projection::FEW;
use ndf_inspector::brdf::{BlinnPhong, Brdf, ConvolutionRule, Ggx, TorranceSparrow};
use ndf_inspector::filter::brdf_error::texel_error;
use ndf_inspector::filter::vmf::{Fold, Rules, VmfFilter};
use ndf_inspector::normal_map::NormalMap;
use ndf_inspector::normal_map::procedural;
use ndf_inspector::normal_map::pyramid::Texel;

use super::fit::fitted;

/// Every model, narrow and wide.
fn models() -> Vec<Brdf> {
    let names = "lambert blinn-phong:4 blinn-phong:400 torrance-sparrow:0.03 torrance-sparrow:0.2 torrance-sparrow:0.5 \
                 ggx:0.02 ggx:0.1 ggx:0.4 ggx:1";
    names.split_whitespace().map(|name| name.parse().expect("a BRDF")).collect()
}

/// Angles from the normal by the midpoint rule in the square root, closest where lobes are sharp, with the solid angle
/// of each ring.
fn rings(count: usize) -> impl Iterator<Item = (f64, f64)> {
    let edge = move |i: usize| PI * (i as f64 / count as f64).powi(2);
    (0..count).map(move |i| {
        let angle = 0.5 * (edge(i) + edge(i + 1));
        (angle, 2.0 * PI * angle.sin() * (edge(i + 1) - edge(i)))
    })
}

#[test]
fn every_model_integrates_to_one_and_is_nowhere_negative() {
    for model in models() {
        let sum: f64 = rings(200_000).map(|(angle, ring)| ring * model.zonal(angle.cos())).sum();
        // The Torrance-Sparrow form's norm is a fit, to 5e-6.
        assert!((sum - 1.0).abs() < 1e-5, "{model}: {sum}");
        assert!((-100..=100).all(|i| model.zonal(f64::from(i) / 100.0) >= 0.0), "{model}");
    }
}

#[test]
fn multipliers_are_the_integrals_against_legendre_polynomials() {
    for model in models() {
        let mut integrals = [0.0; FEW];
        for (angle, ring) in rings(300_000) {
            let (u, share) = (angle.cos(), ring * model.zonal(angle.cos()));
            let (mut previous, mut current) = (0.0, 1.0);
            for (l, integral) in integrals.iter_mut().enumerate() {
                *integral += share * current;
                let l = l as f64;
                (previous, current) = (current, ((2.0 * l + 1.0) * u * current - l * previous) / (l + 1.0));
            }
        }
        let multipliers = model.multipliers(ConvolutionRule::Exact, FEW);
        for (l, (found, integral)) in multipliers.iter().zip(integrals).enumerate() {
            assert!((found - integral).abs() < 1e-6, "{model}, l {l}: {found} against {integral}");
        }
    }
}

/// The BRDF's value: f of the half vector with the Fresnel factor.
fn value(model: Brdf, to_light: DVec3, to_eye: DVec3) -> f64 {
    let half = (to_light + to_eye).normalize();
    model.zonal(half.z) * f64::from(fresnel(0.9, half.dot(to_light) as f32))
}

#[test]
fn light_and_eye_may_change_places() {
    let direction = |theta: f64, phi: f64| DVec3::new(theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos());
    for model in models() {
        for (a, b) in [((0.1, 0.0), (0.4, 3.0)), ((1.2, 1.0), (0.3, 2.0)), ((0.9, 0.0), (1.5, 0.4))] {
            let (a, b) = (direction(a.0, a.1), direction(b.0, b.1));
            let (there, back) = (value(model, a, b), value(model, b, a));
            // The Fresnel factor is of f32.
            assert!((there - back).abs() <= 1e-6 * there, "{model}: {there} and {back}");
        }
    }
}

/// What a material of Ks = 1/4 gives back towards an eye `theta` off the normal, of light from everywhere: over half
/// vectors, whose solid angle is the light's over `4 (h.v)`.
fn albedo(model: Brdf, strength: f32, theta: f64) -> f64 {
    let eye = DVec3::new(theta.sin(), 0.0, theta.cos());
    let turns = 64;
    let mut sum = 0.0;
    for (angle, ring) in rings(3000) {
        for turn in 0..turns {
            let azimuth = (f64::from(turn) + 0.5) * 2.0 * PI / f64::from(turns);
            let half = DVec3::new(angle.sin() * azimuth.cos(), angle.sin() * azimuth.sin(), angle.cos());
            let cosine = half.dot(eye);
            let light = 2.0 * cosine * half - eye;
            if cosine > 0.0 && light.z > 0.0 {
                let factor = f64::from(fresnel(strength, cosine as f32));
                sum += ring / f64::from(turns) * model.zonal(half.z) * factor * cosine * light.z;
            }
        }
    }
    sum
}

#[test]
fn a_quarter_of_every_model_gives_back_no_more_than_it_gets() {
    for model in models() {
        for theta in [0.0, 0.5, 1.0, 1.4] {
            let (whole, part) = (albedo(model, 0.0, theta), albedo(model, 0.96, theta));
            assert!(0.0 < part && part < whole && whole < 1.001, "{model} from {theta}: {part}, {whole}");
        }
    }
}

#[test]
fn in_a_white_furnace_a_mirror_and_a_lambertian_vanish() {
    // Nothing is lost of a sharp lobe seen from above; GGX's tail sends some below the horizon.
    for (name, most) in [("blinn-phong:4000", 0.002), ("torrance-sparrow:0.01", 0.002), ("ggx:0.02", 0.01)] {
        let lost = 1.0 - albedo(name.parse().expect("a BRDF"), 0.0, 0.0);
        assert!((0.0..most).contains(&lost), "{name} loses {lost}");
    }
    // f of the light itself, times its cosine over the Lambertian's own: all of it.
    let sum: f64 = rings(100_000).map(|(angle, ring)| ring * Brdf::Lambert.zonal(angle.cos())).sum();
    assert!((sum - 1.0).abs() < 1e-6, "{sum}");
}

#[test]
fn eight_lobes_stand_for_ggx_within_its_stated_error() {
    for alpha in [0.02, 0.05, 0.1, 0.2, 0.3, 0.45, 0.6, 0.8, 1.0] {
        let model = Brdf::Ggx(Ggx { alpha });
        let lobes = model.lobes();
        let (mut squares, mut energy) = (0.0, 0.0);
        for (angle, ring) in rings(20_000) {
            let u = angle.cos();
            let of_lobe =
                |lobe: &ndf_inspector::brdf::PowerLobe| lobe.weight * BlinnPhong { shininess: lobe.shininess }.zonal(u);
            let off = lobes.iter().map(of_lobe).sum::<f64>() - model.zonal(u);
            (squares, energy) = (squares + ring * off * off, energy + ring * model.zonal(u).powi(2));
        }
        let (error, weights) = ((squares / energy).sqrt(), lobes.iter().map(|lobe| lobe.weight).sum::<f64>());
        println!("alpha {alpha}: {:.2} % of its power", 100.0 * error);
        assert!(error < 0.01 && (weights - 1.0).abs() < 1e-9, "alpha {alpha}: {error}");
    }
}

/// The models as wide as Blinn-Phong of exponent s.
fn of_width(s: f64) -> [Brdf; 3] {
    [
        Brdf::BlinnPhong(BlinnPhong { shininess: s }),
        Brdf::TorranceSparrow(TorranceSparrow::of_exponent(s)),
        Brdf::Ggx(Ggx::of_exponent(s)),
    ]
}

/// The mean error of the effective BRDF over texels of some bundled maps, of every model of one width.
fn errors(filters: &[(Arc<NormalMap>, VmfFilter)], s: f64, rule: ConvolutionRule) -> [f64; 3] {
    of_width(s).map(|brdf| {
        let texels = (2..6).flat_map(|level| (0..64 >> level).map(move |x| Texel { level, x, y: x }));
        let of_map = |(map, filter): &(Arc<NormalMap>, VmfFilter)| -> Vec<f64> {
            let rules = Rules { convolution: rule, ..filter.rules };
            let filter = VmfFilter { rules, ..filter.clone() };
            texels.clone().filter_map(|texel| texel_error(map, &filter, texel, brdf)).collect()
        };
        let all: Vec<f64> = filters.iter().flat_map(of_map).collect();
        all.iter().sum::<f64>() / all.len() as f64
    })
}

#[test]
fn lobes_filter_no_model_much_worse_than_blinn_phong_of_the_same_width() {
    let filters = ["bricks", "scales", "flakes"].map(|name| {
        let map = Arc::new(procedural::find(name).expect("bundled").make(64));
        let lobes = Arc::new(fitted(&map, &Default::default()));
        (map, VmfFilter { lobes, fold: Fold::default(), rules: Rules::default() })
    });
    let widths = [8.0, 32.0, 128.0, 512.0];
    let all = [ConvolutionRule::ShiftedExponent, ConvolutionRule::Exact].map(|rule| {
        widths.map(|s| {
            let errors = errors(&filters, s, rule);
            println!("{}, s = {s}: Blinn-Phong, Torrance-Sparrow, GGX {errors:.4?}", rule.label());
            (s, errors)
        })
    });
    for (s, errors) in all.into_iter().flatten() {
        assert!(errors.iter().all(|&error| error < 1.5 * errors[0]), "s {s}: {errors:?}");
    }
}
