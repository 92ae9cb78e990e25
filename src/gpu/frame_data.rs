//! The constants of the surface pass: how the surface is seen and lit, and how the map is read.

use crate::filter::LevelChoice;
use crate::filter::vmf::Fold;
use crate::lighting::{Incident, Light, MAX_LIGHTS};
use crate::lit_surface::LitSurface;
use crate::normal_map::NormalMap;
use crate::scene::bump::BumpRule;
use crate::scene::{Reconstruction, Shape};

/// The frame's constants; `Frame` in the shader.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct FrameData {
    /// Clip space from world.
    pub clip_from_world: [[f32; 4]; 4],
    /// The eye.
    pub eye_in_world: [f32; 3],
    /// The level to read everywhere, where the rule asks for one.
    pub fixed_level: f32,
    /// Where the map is read, from the surface's own texture coordinates; by columns.
    pub uv_from_surface: [[f32; 2]; 2],
    /// Texels of the map's base level.
    pub base_size: [f32; 2],
    /// Levels that `vmf` may read.
    pub vmf_lods: [f32; 2],
    /// The map's level that the means begin with.
    pub base_level: f32,
    /// The map's level that the lobes begin with.
    pub lobe_level: f32,
    /// Slots in use.
    pub lobes: u32,
    /// 1 where the map tiles.
    pub wraps: u32,
    /// Index of the first sample of the truth to add.
    pub first_sample: u32,
    /// Samples of the truth to add.
    pub sample_count: u32,
    /// The choice of level, by the shader's number.
    pub level_choice: u32,
    /// Most probes along the long axis of a pixel's footprint.
    pub most_probes: u32,
    /// Lights in use, the sun's included.
    pub light_count: u32,
    /// How the frame at a pixel is reconstructed, by the shader's number.
    pub reconstruction: u32,
    /// How a map of heights bumps the surface, by the shader's number; 0 where none does.
    pub bump: u32,
    /// What a height of 1 is then, in world units.
    pub bump_scale: f32,
    /// By how much slopes by texture coordinates are steeper than the map's.
    pub rise: [f32; 2],
    /// Lights in use without the sun's.
    pub lamp_count: u32,
    /// Nothing.
    pub padding: u32,
    /// Which slot each slot is added to.
    pub fold: [[u32; 4]; 4],
    /// The lights, and behind them the sun.
    pub lights: [LightData; MAX_LIGHTS + 1],
}

/// One light; `Light` in the shader.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct LightData {
    /// Where it stands, in homogeneous coordinates.
    pub position_in_world: [f32; 4],
    /// Linear RGB, at a distance of 1 where it has one.
    pub radiance: [f32; 3],
    /// Factor on what it lights diffusely: 0 for the sun, whose diffuse light is among the sky's harmonics.
    pub diffuse: f32,
}

impl LightData {
    fn new(light: &Light) -> Self {
        let (position, radiance) = (light.position_in_world(), light.radiance());
        Self { position_in_world: position.to_array(), radiance: radiance.to_array(), diffuse: 1.0 }
    }

    fn of_sun(sunlight: Incident) -> Self {
        Self {
            position_in_world: sunlight.direction_in_world.extend(0.0).to_array(),
            radiance: sunlight.radiance.to_array(),
            diffuse: 0.0,
        }
    }
}

impl FrameData {
    /// The part that follows from the surface and the picture's size; the rest is the map's, left 0.
    pub fn of_surface(surface: &LitSurface, size: [u32; 2]) -> Self {
        let lamps = surface.lights.as_slice();
        let mut lights = [LightData::default(); MAX_LIGHTS + 1];
        let all = lamps.iter().map(LightData::new).chain(surface.sky.sunlight().map(LightData::of_sun));
        let light_count = lights.iter_mut().zip(all).map(|(place, light)| *place = light).count();
        Self {
            lights,
            light_count: light_count as u32,
            lamp_count: lamps.len() as u32,
            clip_from_world: surface.camera.clip_from_world(size[0] as f32 / size[1] as f32).to_cols_array_2d(),
            eye_in_world: surface.camera.eye_in_world().to_array(),
            fixed_level: if let LevelChoice::Fixed(level) = surface.level { level } else { 0.0 },
            level_choice: match surface.level {
                LevelChoice::Auto => 0,
                LevelChoice::Hardware => 1,
                LevelChoice::Fixed(_) => 2,
            },
            most_probes: surface.level_rule().most_probes,
            reconstruction: match surface.shape.reconstruction {
                Reconstruction::Orthonormal => 0,
                Reconstruction::Projected => 1,
                Reconstruction::Interpolated => 2,
            },
            uv_from_surface: surface.shape.uv_from_surface().to_cols_array_2d(),
            ..Self::default()
        }
    }

    /// Sets how the map bumps the surface, where it holds heights and the shape asks for it.
    pub fn set_bump(&mut self, shape: &Shape, map: &NormalMap) {
        let scale = shape.bump_scale * shape.scale() as f32;
        let (Some(rule), Some(rise)) = (shape.bump_rule(), map.rise(scale)) else { return };
        (self.bump_scale, self.rise) = (scale, rise.to_array());
        self.bump = match rule {
            BumpRule::Blinn => 1,
            BumpRule::Exact => 2,
        };
    }

    /// Sets which slot each slot is added to.
    pub fn set_fold(&mut self, fold: &Fold) {
        for (slot, &target) in fold.0.iter().enumerate() {
            self.fold[slot / 4][slot % 4] = u32::from(target);
        }
    }
}
