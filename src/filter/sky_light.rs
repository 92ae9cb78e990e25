//! The sky at a surface point: what a lobe of normals reflects of it, and what samples of it come to.
//!
//! A light of radiance 1 is reflected as [`reflect`] has it, which leaves the Lambertian's `1/pi` out; of the whole sky
//! that is `1/pi int L reflect dw`, so that a white surface under a white sky is white.
//!
//! Methods are shaded by lobes: whatever a method keeps of the NDF stands for von Mises-Fisher lobes, whose zonal
//! multipliers `A_l` multiply the BRDF's (see [`sky_harmonics`](crate::lighting::sky_harmonics)). Fresnel's factor and g
//! of the half vector that is the lobe's direction stand for those of all. The truth draws a
//! direction for each of its samples, by turns from the sky's brightness and from the material about the sample's
//! normal, and divides by the mean of both densities (the balance heuristic of Veach and Guibas 1995).

use std::f32::consts::PI;

use glam::{DVec3, Mat3, Vec3};

use super::reflect;
use super::truth::{number, pixel_seeds};
use crate::brdf::blinn_phong::blinn_phong;
use crate::brdf::{Brdf, ConvolutionRule, Material};
use crate::lighting::sky_harmonics::{DIFFUSE_BAND, MOST_BANDS, half_way};
use crate::lighting::{Environment, Sky};
use crate::sphere::harmonics::{each_harmonic, vmf_zonal_low};
use crate::sphere::vmf::KAPPA_DELTA;

/// `2^32 / p^3` and `2^32 / p^4` for the p with `p^5 = p + 1` (see [`sky_samples`](crate::lighting::sky_samples)).
const STEP: [u32; 2] = [2_700_274_806, 2_313_257_605];

/// The least cosine between half vector and eye that is told from none.
const LEAST_COSINE: f32 = 1e-4;

/// The sky as it lights one surface point.
#[derive(Clone, Debug)]
pub struct LocalSky<'a> {
    environment: &'a Environment,
    material: &'a Material,
    intensity: f32,
    /// Takes the map's normals to the sky's frame, up to their length.
    sky_from_map: Mat3,
    to_eye_in_sky: Vec3,
    diffuse: Vec<DVec3>,
    specular: Vec<DVec3>,
}

/// Normals that point about alike, as a method keeps them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NdfLobe {
    /// Its share of the NDF.
    pub weight: f32,
    /// Unit vector in tangent space.
    pub mean_direction: Vec3,
    /// Concentration kappa.
    pub concentration: f64,
}

impl NdfLobe {
    /// All normals alike; a vector that is no unit vector counts by its length.
    pub fn normal(normal: Vec3) -> Self {
        let weight = normal.length();
        Self { weight, mean_direction: normal / weight.max(1e-12), concentration: KAPPA_DELTA }
    }
}

impl<'a> LocalSky<'a> {
    /// The sky, if there is one, at a point that is seen along `to_eye`, for this material; the matrix takes the map's
    /// normals to the surface's.
    pub fn new(sky: &'a Sky, material: &'a Material, world_from_map: Mat3, to_eye_in_world: Vec3) -> Option<Self> {
        let environment = sky.environment.as_deref()?;
        let sky_from_world = sky.sky_from_world();
        let to_eye_in_sky = sky_from_world * to_eye_in_world;
        let [diffuse, specular] = bands(sky, material);
        Some(Self {
            environment,
            material,
            intensity: sky.intensity,
            sky_from_map: sky_from_world * world_from_map,
            to_eye_in_sky,
            diffuse: reflected(&environment.harmonics.diffuse, &diffuse),
            specular: reflected(&sky.views(environment).towards(to_eye_in_sky), &specular),
        })
    }

    /// A normal of the map in the sky's frame, a unit vector again; zero for none.
    fn in_sky(&self, normal: Vec3) -> Vec3 {
        (self.sky_from_map * normal).normalize_or_zero()
    }

    /// What a lobe of normals reflects, linear RGB (Han et al. 2007, eq. 25 and 26).
    pub fn shade(&self, lobe: &NdfLobe) -> Vec3 {
        let mu = self.in_sky(lobe.mean_direction).as_dvec3();
        let zonal = vmf_zonal_low(lobe.concentration, MOST_BANDS + 1);
        let half_way_mu = half_way(self.to_eye_in_sky.as_dvec3(), mu);
        let diffuse = series(&self.diffuse, DIFFUSE_BAND, &zonal, mu);
        let specular = series(&self.specular, MOST_BANDS, &zonal, half_way_mu);
        let unfiltered = self.material.unfiltered(mu.as_vec3().dot(self.to_eye_in_sky)).as_dvec3();
        let sum = diffuse + unfiltered * specular;
        self.intensity * lobe.weight * sum.as_vec3()
    }

    /// Sample `index` of a pixel of what one normal reflects, linear RGB; zero for no normal.
    pub fn sample(&self, normal: Vec3, pixel: [u32; 2], index: u32) -> Vec3 {
        let normal = self.in_sky(normal);
        let [.., across, down, first] = pixel_seeds(pixel);
        let nth = index / 2;
        if index.is_multiple_of(2) {
            let samples = &self.environment.samples;
            return self.estimate(normal, samples[(first.wrapping_add(nth) as usize) % samples.len()]);
        }
        let half = self.half_vector(normal, [number(across, STEP[0], nth), number(down, STEP[1], nth)]);
        let cosine = half.dot(self.to_eye_in_sky);
        if cosine < LEAST_COSINE { Vec3::ZERO } else { self.estimate(normal, 2.0 * cosine * half - self.to_eye_in_sky) }
    }

    /// A half vector about `normal` with the density of the Blinn-Phong as wide as the material.
    fn half_vector(&self, normal: Vec3, [across, down]: [f32; 2]) -> Vec3 {
        let cosine = ((1.0 - across).ln() / (self.material.exponent() + 1.0)).exp();
        let sine = (1.0 - cosine * cosine).max(0.0).sqrt();
        let (sin, cos) = (2.0 * PI * down).sin_cos();
        let [x, y] = basis(normal);
        sine * (cos * x + sin * y) + cosine * normal
    }

    /// `L reflect / pi` of one direction over the density with which it is drawn.
    fn estimate(&self, normal: Vec3, direction: Vec3) -> Vec3 {
        let half = (direction + self.to_eye_in_sky).normalize_or_zero();
        let texel = self.environment.grid().texel(direction);
        let by_material = blinn_phong(self.material.exponent(), half.dot(normal))
            / (4.0 * half.dot(self.to_eye_in_sky).max(LEAST_COSINE));
        let density = 0.5 * (self.environment.density[texel] + by_material);
        if density <= 0.0 {
            return Vec3::ZERO;
        }
        let reflected = self.reflect(normal, half, direction);
        self.intensity / (PI * density) * self.environment.radiance[texel] * reflected
    }

    /// What one normal reflects of a light of radiance 1 from a direction.
    fn reflect(&self, normal: Vec3, half: Vec3, direction: Vec3) -> Vec3 {
        let material = self.material.towards(half.dot(self.to_eye_in_sky));
        reflect(&material, material.specular_at(half.dot(normal)), normal.dot(direction))
    }

    /// What one normal reflects of every texel of the sky, without samples.
    pub fn exact(&self, normal: Vec3) -> Vec3 {
        let normal = self.in_sky(normal);
        let of_texel = |(direction, solid_angle, index): (DVec3, f64, usize)| {
            let direction = direction.as_vec3();
            let half = (direction + self.to_eye_in_sky).normalize_or_zero();
            let reflected = self.reflect(normal, half, direction);
            solid_angle * (self.environment.radiance[index] * reflected).as_dvec3()
        };
        let sum: DVec3 = self.environment.grid().texels().map(of_texel).sum();
        (f64::from(self.intensity / PI) * sum).as_vec3()
    }
}

/// What each band of the diffuse and of the specular light becomes: the material's exact multiplier times its colour,
/// nothing beyond the last band in use.
pub fn bands(sky: &Sky, material: &Material) -> [Vec<DVec3>; 2] {
    let exact = Material { convolution: ConvolutionRule::Exact, ..*material };
    let lambertian = Brdf::Lambert.multipliers(exact.convolution, DIFFUSE_BAND + 1).into_iter().map(DVec3::splat);
    let mut own = exact.multipliers(sky.last_band() + 1);
    own.resize(MOST_BANDS + 1, DVec3::ZERO);
    let colored = |multipliers: Vec<DVec3>, color: Vec3| {
        multipliers.into_iter().map(|multiplier| multiplier * color.as_dvec3()).collect()
    };
    let specular_color = material.specular_strength() / PI * material.specular_color;
    [colored(lambertian.collect(), material.diffuse * material.diffuse_color), colored(own, specular_color)]
}

/// The light's harmonics times what their bands become.
fn reflected(light: &[Vec3], bands: &[DVec3]) -> Vec<DVec3> {
    let (mut all, mut next) = (Vec::with_capacity(light.len()), light.iter());
    each_harmonic(DVec3::Z, bands.len() - 1, |l, _| all.extend(next.next().map(|light| bands[l] * light.as_dvec3())));
    all
}

/// `sum_lm zonal_l light_lm Y_lm(direction)`.
fn series(light: &[DVec3], last_band: usize, zonal: &[f64], direction: DVec3) -> DVec3 {
    let (mut sum, mut next) = (DVec3::ZERO, light.iter());
    each_harmonic(direction, last_band, |l, value| {
        sum += next.next().map_or(DVec3::ZERO, |light| zonal[l] * value * *light);
    });
    sum
}

/// Two unit vectors at right angles to a third and each other (Duff et al. 2017).
fn basis(normal: Vec3) -> [Vec3; 2] {
    let sign = if normal.z >= 0.0 { 1.0 } else { -1.0 };
    let a = -1.0 / (sign + normal.z);
    let b = normal.x * normal.y * a;
    let x = Vec3::new(1.0 + sign * normal.x * normal.x * a, sign * b, -sign * normal.x);
    [x, Vec3::new(b, sign + normal.y * normal.y * a, -normal.y)]
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use rayon::prelude::*;

    use super::*;
    use crate::lighting::environment::{LatLong, reduced};
    use crate::lighting::{ProceduralSky, SkySource};

    /// A bundled sky of 128 columns: few enough for sums over all of it. Its sun is in the bands.
    fn sky(made: ProceduralSky) -> Sky {
        let radiance = reduced(made.radiance(), ProceduralSky::WIDTH, ProceduralSky::WIDTH / 128);
        let environment = Environment::new(SkySource::Bundled(made), 128, radiance).expect("a sky");
        Sky { environment: Some(Arc::new(environment)), is_sun_apart: false, ..Sky::default() }
    }

    fn to_eye() -> Vec3 {
        Vec3::new(0.3, -0.6, 0.8).normalize()
    }

    /// Upward normals that the eye sees.
    fn normals() -> impl Iterator<Item = Vec3> {
        let grid = LatLong { width: 20, height: 10 };
        grid.texels().map(|(normal, ..)| normal.as_vec3()).filter(|normal| normal.z > 0.1 && normal.dot(to_eye()) > 0.2)
    }

    /// Unit vectors spread as a lobe is, each as likely.
    fn spread(lobe: &NdfLobe) -> Vec<Vec3> {
        if lobe.concentration >= KAPPA_DELTA {
            return vec![lobe.mean_direction];
        }
        let axis = lobe.mean_direction.as_dvec3();
        let count = 48;
        let along = |index: usize| {
            let share = (index as f64 + 0.5) / count as f64;
            let cosine = 1.0 + (share + (1.0 - share) * (-2.0 * lobe.concentration).exp()).ln() / lobe.concentration;
            let turn = index as f64 * 2.399_963_229_728_653;
            let [x, y] = basis(lobe.mean_direction).map(Vec3::as_dvec3);
            let sine = (1.0 - cosine * cosine).max(0.0).sqrt();
            (cosine * axis + sine * (turn.cos() * x + turn.sin() * y)).as_vec3()
        };
        (0..count).map(along).collect()
    }

    fn local<'a>(sky: &'a Sky, material: &'a Material) -> LocalSky<'a> {
        LocalSky::new(sky, material, Mat3::IDENTITY, to_eye()).expect("a sky")
    }

    /// Lobes of this concentration, each with what it reflects by sums over the whole sky.
    fn exact(sky: &Sky, material: &Material, concentration: f64) -> Vec<(NdfLobe, Vec3)> {
        let local = local(sky, material);
        let of_lobe = |mean_direction: Vec3| {
            let lobe = NdfLobe { weight: 1.0, mean_direction, concentration };
            let spread = spread(&lobe);
            (lobe, spread.iter().map(|normal| local.exact(*normal)).sum::<Vec3>() / spread.len() as f32)
        };
        normals().collect::<Vec<_>>().into_par_iter().map(of_lobe).collect()
    }

    /// How far lobes are off that, relative, in the mean square.
    fn error(sky: &Sky, material: &Material, exact: &[(NdfLobe, Vec3)]) -> f64 {
        let local = local(sky, material);
        let off: f64 = exact.iter().map(|(lobe, exact)| f64::from((local.shade(lobe) - exact).length_squared())).sum();
        let whole: f64 = exact.iter().map(|(_, exact)| f64::from(exact.length_squared())).sum();
        (off / whole).sqrt()
    }

    /// Measured: 0.9 % under the clear sky, whose sun has every band, and less under the others.
    #[test]
    fn diffuse_light_by_harmonics_is_within_a_percent_of_the_truth() {
        let material = Material { specular: 0.0, ..Material::DEFAULT };
        for made in ProceduralSky::ALL {
            let sky = sky(made);
            let error = error(&sky, &material, &exact(&sky, &material, KAPPA_DELTA));
            println!("{}: {:.2} %", made.name(), 100.0 * error);
            assert!(error < 0.01, "{}: {error}", made.name());
        }
    }

    /// At s = 64. What is left at the last band is the cosine, which is taken for that of the facet that mirrors.
    #[test]
    fn the_error_of_specular_light_falls_as_bands_are_added() {
        let material = Material { diffuse: 0.0, ..Material::DEFAULT };
        println!("l* =              2      4      6      8     10     12");
        for made in ProceduralSky::ALL {
            let mut sky = sky(made);
            for concentration in [KAPPA_DELTA, 60.0] {
                let exact = exact(&sky, &material, concentration);
                let errors = [2, 4, 6, 8, 10, 12].map(|last_band| {
                    sky.last_band = last_band;
                    error(&sky, &material, &exact)
                });
                println!("{:>8} {concentration:>8} {errors:.3?}", made.name());
                assert!(errors.windows(2).all(|pair| pair[1] < pair[0] + 2e-3), "{}: {errors:?}", made.name());
                assert!(errors[5] < 0.5 * errors[0], "{}: {errors:?}", made.name());
            }
        }
    }

    #[test]
    fn samples_come_to_the_sum_over_the_whole_sky() {
        for made in ProceduralSky::ALL {
            let (sky, material) = (sky(made), Material::DEFAULT);
            let local = local(&sky, &material);
            for normal in normals().step_by(7) {
                let count = 16384;
                let sum: DVec3 = (0..count).map(|index| local.sample(normal, [5, 9], index).as_dvec3()).sum();
                let (mean, exact) = (sum / f64::from(count), local.exact(normal).as_dvec3());
                let error = (mean - exact).length() / exact.length();
                assert!(error < 0.02, "{} at {normal}: {mean} for {exact}", made.name());
            }
        }
    }

    #[test]
    fn half_vectors_are_drawn_with_the_materials_density() {
        let (sky, material) = (sky(ProceduralSky::Overcast), Material::DEFAULT);
        let local = local(&sky, &material);
        let normal = Vec3::new(-0.3, 0.2, -0.7).normalize();
        let count = 4096;
        let halves: Vec<Vec3> = (0..count)
            .map(|index| local.half_vector(normal, [number(7, STEP[0], index), number(9, STEP[1], index)]))
            .collect();
        let mean = halves.iter().map(|half| half.dot(normal)).sum::<f32>() / count as f32;
        let across = halves.iter().map(|half| *half - half.dot(normal) * normal).sum::<Vec3>() / count as f32;
        // E[u] = (s + 1) / (s + 2).
        assert!((mean - 65.0 / 66.0).abs() < 1e-3 && across.length() < 5e-3, "{mean}, {across}");
    }

    #[test]
    fn the_uniform_lobe_reflects_the_mean_over_all_normals() {
        let (sky, material) = (sky(ProceduralSky::Clear), Material { specular: 0.0, ..Material::DEFAULT });
        let local = local(&sky, &material);
        let of_normal = |(normal, solid_angle, _): (DVec3, f64, usize)| {
            solid_angle / (4.0 * std::f64::consts::PI) * local.shade(&NdfLobe::normal(normal.as_vec3())).as_dvec3()
        };
        let mean: DVec3 = LatLong { width: 48, height: 24 }.texels().map(of_normal).sum();
        let uniform = local.shade(&NdfLobe { weight: 1.0, mean_direction: Vec3::Z, concentration: 0.0 }).as_dvec3();
        assert!((mean - uniform).length() < 2e-3 * uniform.length(), "{mean} {uniform}");
    }
}
