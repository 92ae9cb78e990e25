//! The lit surface as values: what is drawn, from where, under which light. The GPU frame and the CPU twin read the
//! same ones.

use std::sync::Arc;

use glam::{Mat3, Vec2, Vec3};

use crate::brdf::Material;
use crate::filter::probes::MOST_PROBES;
use crate::filter::sampling::Grid;
use crate::filter::{Filter, LevelChoice, LevelRule, LocalLight, LocalSky, Lookup, PixelFootprint, Probes};
use crate::lighting::{Incident, Lights, Sky};
use crate::normal_map::NormalMap;
use crate::scene::bump::Bumped;
use crate::scene::{Camera, Model, Shape};

/// Everything the picture of the surface depends on, save the map and the method.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(default)]
pub struct LitSurface {
    /// The shape that wears the map.
    pub shape: Shape,
    /// Where it is seen from.
    pub camera: Camera,
    /// The lights; sessions once had one.
    #[serde(alias = "light")]
    pub lights: Lights,
    /// The light from everywhere.
    pub sky: Sky,
    /// The material.
    pub material: Material,
    /// Which level is read.
    pub level: LevelChoice,
    /// Most probes along the long axis of a pixel's footprint, 1 to [`MOST_PROBES`].
    pub anisotropy: u32,
    /// Exposure in stops.
    pub exposure_stops: f32,
}

impl Default for LitSurface {
    fn default() -> Self {
        Self {
            shape: Shape::default(),
            camera: Camera::default(),
            lights: Lights::default(),
            sky: Sky::default(),
            material: Material::default(),
            level: LevelChoice::default(),
            anisotropy: 1,
            exposure_stops: 0.0,
        }
    }
}

impl LitSurface {
    /// How the levels are read.
    pub fn level_rule(&self) -> LevelRule {
        LevelRule { choice: self.level, most_probes: self.anisotropy.clamp(1, MOST_PROBES) }
    }

    /// Puts the map on a mesh once over, in the mesh's own colour where its file gives one.
    pub fn wear_on(&mut self, model: Arc<Model>) {
        self.material.diffuse_color = model.base_color.unwrap_or(self.material.diffuse_color);
        self.shape = Shape { tiling: [1.0, 1.0], ..Shape::of_model(model) };
    }

    /// The factor that exposure puts on linear colour.
    pub fn exposure(&self) -> f32 {
        self.exposure_stops.exp2()
    }
}

/// A surface point under one pixel, in world space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfacePoint {
    /// Position.
    pub position_in_world: Vec3,
    /// Unit tangent along growing u, unit bitangent up the image and unit outward normal; left-handed where the map is
    /// mirrored.
    pub world_from_tangent: Mat3,
    /// Takes the map's normals to that frame, up to their length; the identity but where derivatives are kept as they
    /// are (see [`Reconstruction`](crate::scene::Reconstruction)).
    pub tangent_from_map: Mat3,
    /// The surface under a relief, where its shape is to be bumped by one.
    pub bumped: Option<Bumped>,
    /// Texture coordinates, tiling applied.
    pub uv: Vec2,
    /// Change of `uv` over one pixel to the right, taken as a GPU takes it, between two pixels.
    pub uv_dx: Vec2,
    /// Change of `uv` over one pixel down, likewise.
    pub uv_dy: Vec2,
    /// How `uv` runs over the pixel, exactly.
    pub footprint: PixelFootprint,
}

impl SurfacePoint {
    /// The probes that read a map of `base` texels here, at levels within `lod_range`.
    pub fn probes(&self, rule: LevelRule, base: (usize, usize), lod_range: [f32; 2]) -> Probes {
        Probes::new(rule, self.uv_dx, self.uv_dy, base, lod_range)
    }

    /// Takes a map's normals to the frame, up to their length: those of heights as they bump the surface, where it is to
    /// be bumped. The height is read once, at the pixel's centre.
    fn tangent_from(&self, surface: &LitSurface, map: &NormalMap) -> Mat3 {
        let shape = &surface.shape;
        let scale = shape.bump_scale * shape.scale() as f32;
        let (Some(bumped), Some(rule), Some(rise)) = (self.bumped, shape.bump_rule(), map.rise(scale)) else {
            return self.tangent_from_map;
        };
        let grid = Grid { width: map.width, height: map.height, addressing: map.options.addressing };
        let taps = grid.bilinear(self.uv).into_iter();
        let height: f32 = taps.map(|(texel, weight)| weight * map.height_of(texel)).sum();
        let world_from_map = bumped.world_from_map((scale * height).into(), rise.as_dvec2(), rule);
        (self.world_from_tangent.as_dmat3().transpose() * world_from_map).as_mat3()
    }

    /// Light and view from their unit directions in world space.
    fn local_light(&self, to_light: Vec3, to_eye: Vec3) -> LocalLight {
        let half = (to_eye + to_light).normalize_or(self.world_from_tangent.z_axis);
        let tangent_from_world = self.world_from_tangent.transpose();
        LocalLight { light_in_tangent: tangent_from_world * to_light, half_in_tangent: tangent_from_world * half }
    }
}

/// Linear RGB of one surface point, seen through `filter` by `probes` in the pixel of these integer coordinates: the
/// CPU twin of the surface shader.
pub fn shade_point(
    surface: &LitSurface,
    filter: &dyn Filter,
    point: &SurfacePoint,
    probes: Probes,
    pixel: [u32; 2],
) -> Vec3 {
    let to_eye = (surface.camera.eye_in_world() - point.position_in_world).normalize();
    let tangent_from_map = point.tangent_from(surface, filter.map());
    let over_probes = |shade: &dyn Fn(&Lookup) -> Vec3| {
        let (footprint, lod) = (point.footprint, probes.lod);
        let probe = |offset: Vec2| shade(&Lookup { uv: point.uv + offset, footprint, lod, pixel, tangent_from_map });
        if filter.is_truth() {
            probe(Vec2::ZERO)
        } else {
            probes.offsets().map(probe).sum::<Vec3>() / probes.count as f32
        }
    };
    // Where normals stay as they are there need be no mean for them to turn with.
    let turns = tangent_from_map != Mat3::IDENTITY;
    let mean = |lookup: &Lookup| if turns { filter.mean_normal(lookup) } else { None };
    let of_light = |incident: Incident, material: &Material| {
        let local = point.local_light(incident.direction_in_world, to_eye);
        let material = material.towards(local.light_in_tangent.dot(local.half_in_tangent));
        let towards = |lookup: &Lookup| mean(lookup).map_or(local, |mean| local.as_seen_from(lookup, mean));
        incident.radiance * over_probes(&|lookup| filter.shade(lookup, &towards(lookup), &material))
    };
    let lights = surface.lights.as_slice().iter().map(|light| light.at(point.position_in_world));
    let of_lights: Vec3 = lights.map(|incident| of_light(incident, &surface.material)).sum();
    let sunlight = surface.sky.sunlight().filter(|_| !filter.is_truth());
    let of_sun =
        sunlight.map_or(Vec3::ZERO, |incident| of_light(incident, &Material { diffuse: 0.0, ..surface.material }));
    let world_from_map = point.world_from_tangent * tangent_from_map;
    let sky = LocalSky::new(&surface.sky, &surface.material, world_from_map, to_eye);
    let of_sky = sky.map_or(Vec3::ZERO, |sky| over_probes(&|lookup| filter.shade_sky(lookup, &sky)));
    surface.exposure() * (of_lights + of_sun + of_sky)
}
