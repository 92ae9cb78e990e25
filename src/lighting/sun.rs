//! The sun of a sky: what shines from so small a part of it that the few bands that lobes are shaded with would spread
//! it over a third of the sky, with rings around it. Specularly it is a far light of its own; only the rest of the sky
//! goes through the bands.

use glam::{DVec3, Vec3};

use super::environment::LatLong;
use crate::color::luminance;

/// A sun reaches no farther than this many degrees from its brightest point.
const RADIUS_DEG: f64 = 6.0;
/// The sky around it is what lies between that and this many degrees.
const RING_DEG: f64 = 9.0;
/// What is wider than this many degrees, in the root mean square, is no sun: bands show it well enough, and a light
/// would show it as a point.
const MOST_SPREAD_DEG: f64 = 3.0;
/// How many times the place that is looked at is moved to the middle of what shines there.
const CENTRINGS: usize = 3;
/// A sun gives this part of the sky's power at least.
const LEAST_SHARE: f64 = 0.01;

/// The sun of a sky.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sun {
    /// Unit vector towards it, in the sky's frame.
    pub direction_in_sky: Vec3,
    /// Linear RGB of the irradiance on a plane that faces it.
    pub irradiance: Vec3,
}

impl Sun {
    /// Takes the sun out of a sky, if it has one: what is brighter around the brightest spot than the ring around that is
    /// the sun's, and what stays is as bright as the ring.
    pub fn take(grid: LatLong, radiance: &mut [Vec3]) -> Option<Self> {
        let texels: Vec<Texel> = grid.texels().collect();
        let by_luminance = |a: &&Texel, b: &&Texel| luminance(radiance[a.2]).total_cmp(&luminance(radiance[b.2]));
        let brightest = texels.iter().max_by(by_luminance)?.0;
        // Of a disc that shines evenly that is a texel of its edge.
        let centred = (0..CENTRINGS).try_fold(Spot::around(brightest, &texels, radiance)?, |spot, _| {
            Spot::around(spot.towards.try_normalize()?, &texels, radiance)
        })?;

        let power: f64 = texels.iter().map(|texel| texel.1 * f64::from(luminance(radiance[texel.2]))).sum();
        // Of narrow spreads the mean direction falls short of 1 by half the mean square of the angle.
        let most_shortfall = 0.5 * MOST_SPREAD_DEG.to_radians().powi(2);
        if centred.power < LEAST_SHARE * power || centred.towards.length() < (1.0 - most_shortfall) * centred.power {
            return None;
        }
        for index in centred.disc {
            radiance[index] = radiance[index].min(centred.around);
        }
        let direction_in_sky = centred.towards.normalize().as_vec3();
        Some(Self { direction_in_sky, irradiance: centred.irradiance.as_vec3() })
    }
}

/// A texel's direction, solid angle and index.
type Texel = (DVec3, f64, usize);

/// What is brighter around a direction than the ring around that.
struct Spot {
    /// Texels it may reach.
    disc: Vec<usize>,
    /// The ring's mean radiance.
    around: Vec3,
    irradiance: DVec3,
    /// Its luminance over the sphere.
    power: f64,
    /// Its mean direction times that.
    towards: DVec3,
}

impl Spot {
    fn around(middle: DVec3, texels: &[Texel], radiance: &[Vec3]) -> Option<Self> {
        let [disc_cosine, ring_cosine] = [RADIUS_DEG, RING_DEG].map(|degrees| degrees.to_radians().cos());
        let near = texels.iter().filter(|texel| texel.0.dot(middle) >= ring_cosine);
        let (disc, ring): (Vec<&Texel>, Vec<&Texel>) = near.partition(|texel| texel.0.dot(middle) >= disc_cosine);
        let ring_angle: f64 = ring.iter().map(|texel| texel.1).sum();
        if ring_angle == 0.0 {
            return None;
        }
        let ring: DVec3 = ring.iter().map(|texel| texel.1 * radiance[texel.2].as_dvec3()).sum();
        let around = (ring / ring_angle).as_vec3();
        let mut spot = Self { disc: Vec::new(), around, irradiance: DVec3::ZERO, power: 0.0, towards: DVec3::ZERO };
        for &&(direction, solid_angle, index) in &disc {
            let excess = (radiance[index] - around).max(Vec3::ZERO);
            spot.irradiance += solid_angle * excess.as_dvec3();
            let power = solid_angle * f64::from(luminance(excess));
            spot.power += power;
            spot.towards += power * direction;
            spot.disc.push(index);
        }
        Some(spot)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lighting::ProceduralSky;

    const GRID: LatLong = LatLong { width: ProceduralSky::WIDTH, height: ProceduralSky::WIDTH / 2 };

    fn power(radiance: &[Vec3]) -> DVec3 {
        GRID.texels().map(|(_, solid_angle, index)| solid_angle * radiance[index].as_dvec3()).sum()
    }

    #[test]
    fn the_clear_sky_has_the_sun_that_it_was_made_with_and_loses_no_power() {
        let whole = ProceduralSky::Clear.radiance();
        let mut rest = whole.clone();
        let sun = Sun::take(GRID, &mut rest).expect("a sun");
        let (azimuth, elevation) = (155.0_f32.to_radians(), 42.0_f32.to_radians());
        let (sin, cos) = (elevation.sin(), elevation.cos());
        let placed = Vec3::new(cos * azimuth.cos(), cos * azimuth.sin(), sin);
        assert!(sun.direction_in_sky.angle_between(placed) < 1e-3, "{}", sun.direction_in_sky);
        // As bright as a directional light of 1.5, with what glows next to it.
        let light = sun.irradiance / std::f32::consts::PI;
        assert!(light.max_element() > 1.45 && light.max_element() < 1.7, "{light}");
        let kept = power(&rest) + sun.irradiance.as_dvec3();
        assert!((kept - power(&whole)).length() < 1e-5 * power(&whole).length(), "{kept}");
        assert!(rest.iter().zip(&whole).all(|(rest, whole)| rest.cmple(*whole).all()));
    }

    #[test]
    fn skies_of_wide_lights_have_none() {
        for made in [ProceduralSky::Overcast, ProceduralSky::Studio] {
            let whole = made.radiance();
            let mut rest = whole.clone();
            assert_eq!(Sun::take(GRID, &mut rest), None, "{}", made.name());
            assert_eq!(rest, whole);
        }
        assert_eq!(Sun::take(GRID, &mut vec![Vec3::splat(0.3); GRID.width * GRID.height]), None, "a constant sky");
        let coarse = LatLong { width: 8, height: 4 };
        let mut one_bright = vec![Vec3::ONE; 32];
        one_bright[12] = Vec3::splat(1e3);
        assert_eq!(Sun::take(coarse, &mut one_bright), None, "a texel of 45 degrees is wide");
    }

    #[test]
    fn a_spot_is_a_sun_wherever_it_stands_until_it_is_wide_or_weak() {
        let spot = |x: f64, y: f64, radius_deg: f64, radiance: f32| {
            let middle = GRID.direction(x, y);
            let shines = |direction: DVec3| direction.dot(middle) > radius_deg.to_radians().cos();
            let sky = GRID.texels().map(|(d, ..)| if shines(d) { Vec3::splat(radiance) } else { Vec3::ONE });
            Sun::take(GRID, &mut sky.collect::<Vec<Vec3>>()).map(|sun| sun.direction_in_sky.as_dvec3().dot(middle))
        };
        for (x, y) in [(0.0, 128.0), (511.5, 40.0), (77.0, 1.0), (300.0, 255.5)] {
            let cosine = spot(x, y, 2.0, 1e4).expect("a sun");
            assert!(cosine > 0.5_f64.to_radians().cos(), "{x}, {y}: {cosine}");
        }
        assert_eq!(spot(256.0, 60.0, 8.0, 1e4), None, "as wide as the ring");
        assert_eq!(spot(256.0, 60.0, 5.5, 1e4), None, "wider than a sun");
        assert_eq!(spot(256.0, 60.0, 2.0, 20.0), None, "too weak to matter");
    }
}
