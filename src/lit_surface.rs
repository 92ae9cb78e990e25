//! The lit surface as values: what is drawn, from where, under which light. The GPU frame and the CPU twin read the
//! same ones.

use glam::{Vec2, Vec3};

use crate::brdf::Material;
use crate::filter::{Filter, LocalLight, Lookup, PixelFootprint};
use crate::lighting::DirectionalLight;
use crate::scene::{Camera, Shape};

/// Which MIP level a pixel reads.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum LevelChoice {
    /// The level whose texels are as large as the pixel, between two levels by trilinear interpolation.
    #[default]
    Auto,
    /// This level, everywhere.
    Fixed(f32),
}

/// Everything the picture of the surface depends on, save the map and the method.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(default)]
pub struct LitSurface {
    /// The shape that wears the map.
    pub shape: Shape,
    /// Where it is seen from.
    pub camera: Camera,
    /// The light.
    pub light: DirectionalLight,
    /// The material.
    pub material: Material,
    /// Which level is read.
    pub level: LevelChoice,
    /// Exposure in stops.
    pub exposure_stops: f32,
}

impl LitSurface {
    /// The factor that exposure puts on linear colour.
    pub fn exposure(&self) -> f32 {
        self.exposure_stops.exp2()
    }
}

/// A surface point under one pixel, in world space; the frame is orthonormal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfacePoint {
    /// Position.
    pub position_in_world: Vec3,
    /// Unit tangent, along growing u.
    pub tangent_in_world: Vec3,
    /// Unit bitangent, up the image, along falling v.
    pub bitangent_in_world: Vec3,
    /// Unit geometric normal.
    pub normal_in_world: Vec3,
    /// Texture coordinates, tiling applied.
    pub uv: Vec2,
    /// Change of `uv` over one pixel to the right, taken as a GPU takes it, between two pixels.
    pub uv_dx: Vec2,
    /// Change of `uv` over one pixel down, likewise.
    pub uv_dy: Vec2,
    /// How `uv` runs over the pixel, exactly.
    pub footprint: PixelFootprint,
}

/// The level of detail of a footprint: log2 of its longer side in base texels, within `range`.
pub fn level_of_detail(choice: LevelChoice, uv_dx: Vec2, uv_dy: Vec2, base: (usize, usize), range: [f32; 2]) -> f32 {
    let size = Vec2::new(base.0 as f32, base.1 as f32);
    let lod = match choice {
        LevelChoice::Auto => (uv_dx * size).length().max((uv_dy * size).length()).max(1e-12).log2(),
        LevelChoice::Fixed(level) => level,
    };
    lod.clamp(range[0], range[1])
}

/// Linear RGB of one surface point seen through `filter`: the CPU twin of the surface shader.
pub fn shade_point(surface: &LitSurface, filter: &dyn Filter, point: &SurfacePoint, lookup: &Lookup) -> Vec3 {
    let to_eye = (surface.camera.eye_in_world() - point.position_in_world).normalize();
    let to_light = surface.light.direction_in_world();
    let half = (to_eye + to_light).normalize_or(point.normal_in_world);
    let tangent_from_world = |v: Vec3| {
        Vec3::new(v.dot(point.tangent_in_world), v.dot(point.bitangent_in_world), v.dot(point.normal_in_world))
    };
    let light =
        LocalLight { light_in_tangent: tangent_from_world(to_light), half_in_tangent: tangent_from_world(half) };
    surface.exposure() * surface.light.radiance() * filter.shade(lookup, &light, &surface.material)
}
