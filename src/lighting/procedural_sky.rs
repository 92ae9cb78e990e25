//! Skies that the program makes.

use glam::{DVec3, Vec3};

use super::environment::LatLong;

/// A sky by name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ProceduralSky {
    /// Blue with a sun.
    Clear,
    /// Clouds everywhere.
    Overcast,
    /// A dark room with three soft boxes.
    Studio,
}

/// A rectangle that shines, seen from its middle's direction.
struct SoftBox {
    azimuth_deg: f64,
    elevation_deg: f64,
    /// Half its width and height, as tangents.
    half_size: [f64; 2],
    radiance: Vec3,
}

const SOFT_BOXES: [SoftBox; 3] = [
    SoftBox { azimuth_deg: 140.0, elevation_deg: 45.0, half_size: [0.45, 0.3], radiance: Vec3::new(9.0, 8.6, 8.0) },
    SoftBox { azimuth_deg: 20.0, elevation_deg: 25.0, half_size: [0.2, 0.6], radiance: Vec3::new(3.2, 3.8, 4.6) },
    SoftBox { azimuth_deg: -80.0, elevation_deg: 70.0, half_size: [0.5, 0.2], radiance: Vec3::new(2.6, 2.5, 2.4) },
];

/// Half the angle of the sun's disc: five times the real one's, as wide as thin haze makes it.
const SUN_RADIUS_DEG: f64 = 1.35;
/// Where the sun stands.
const SUN_AZIMUTH_DEG: f64 = 155.0;
const SUN_ELEVATION_DEG: f64 = 42.0;
/// As bright as a directional light of intensity 1.5.
const SUN_RADIANCE: Vec3 = Vec3::new(2800.0, 2550.0, 2150.0);

/// Samples along each axis of a texel, for edges.
const FINE: usize = 4;

impl ProceduralSky {
    /// Every sky, in the order they are offered.
    pub const ALL: [Self; 3] = [Self::Clear, Self::Overcast, Self::Studio];

    /// Texels across.
    pub const WIDTH: usize = 512;

    /// The name on the command line and in the window.
    pub fn name(self) -> &'static str {
        match self {
            Self::Clear => "clear",
            Self::Overcast => "overcast",
            Self::Studio => "studio",
        }
    }

    /// Linear RGB of every texel, row by row from the top.
    pub fn radiance(self) -> Vec<Vec3> {
        let grid = LatLong { width: Self::WIDTH, height: Self::WIDTH / 2 };
        let offsets = (0..FINE * FINE).map(|i| [i % FINE, i / FINE].map(|k| (k as f64 + 0.5) / FINE as f64));
        let offsets: Vec<[f64; 2]> = offsets.collect();
        let texel = |index: usize| {
            let (x, y) = ((index % grid.width) as f64, (index / grid.width) as f64);
            let sum: Vec3 = offsets.iter().map(|[dx, dy]| self.at(grid.direction(x + dx, y + dy))).sum();
            sum / offsets.len() as f32
        };
        (0..grid.width * grid.height).map(texel).collect()
    }

    fn at(self, direction: DVec3) -> Vec3 {
        match self {
            Self::Clear => clear(direction),
            Self::Overcast => overcast(direction),
            Self::Studio => studio(direction),
        }
    }
}

fn from_angles(azimuth_deg: f64, elevation_deg: f64) -> DVec3 {
    let ((sin_a, cos_a), (sin_e, cos_e)) = (azimuth_deg.to_radians().sin_cos(), elevation_deg.to_radians().sin_cos());
    DVec3::new(cos_e * cos_a, cos_e * sin_a, sin_e)
}

/// Pale at the horizon, blue above, a glow around the sun; brown earth below.
fn clear(direction: DVec3) -> Vec3 {
    let to_sun = direction.dot(from_angles(SUN_AZIMUTH_DEG, SUN_ELEVATION_DEG));
    if to_sun > SUN_RADIUS_DEG.to_radians().cos() {
        return SUN_RADIANCE;
    }
    if direction.z < 0.0 {
        return Vec3::new(0.13, 0.115, 0.095);
    }
    let low = (1.0 - direction.z).powi(4) as f32;
    let glow = 0.5 * (12.0 * (to_sun - 1.0)).exp() as f32;
    Vec3::new(0.16, 0.3, 0.62).lerp(Vec3::new(0.62, 0.7, 0.78), low) + glow * Vec3::new(1.0, 0.92, 0.8)
}

/// Three times as bright at the zenith as at the horizon: `(1 + 2 sin elevation) / 3` (Moon and Spencer 1942).
fn overcast(direction: DVec3) -> Vec3 {
    if direction.z < 0.0 {
        return Vec3::new(0.16, 0.155, 0.15);
    }
    (1.0 + 2.0 * direction.z as f32) / 3.0 * Vec3::new(1.0, 1.02, 1.06)
}

fn studio(direction: DVec3) -> Vec3 {
    let shines = |soft_box: &&SoftBox| {
        let middle = from_angles(soft_box.azimuth_deg, soft_box.elevation_deg);
        let right = middle.cross(DVec3::Z).normalize();
        let forward = direction.dot(middle);
        let place = [direction.dot(right), direction.dot(right.cross(middle))].map(|along| (along / forward).abs());
        forward > 0.0 && place[0] < soft_box.half_size[0] && place[1] < soft_box.half_size[1]
    };
    let walls = Vec3::splat(0.03 + 0.03 * (1.0 - direction.z as f32));
    SOFT_BOXES.iter().find(shines).map_or(walls, |soft_box| soft_box.radiance)
}
