//! Draws the lit surface by one method into a picture of its own, in linear light with depth.

use super::environment::EnvironmentPass;
use crate::filter::rival::RivalKind;
use crate::filter::vmf::Fold;
use crate::filter::{LevelChoice, Method};
use crate::gpu::exact_tables::ExactTables;
use crate::gpu::layout::{self, bind_group, bind_group_layout, texture, texture_2d, uniform_buffer};
use crate::gpu::measured_table::MeasuredTable;
use crate::gpu::reflectance::ReflectanceData;
use crate::gpu::rival_textures::RivalTextures;
use crate::gpu::sky_textures::SkyTextures;
use crate::gpu::surface_pipelines::{SurfacePipelines, Variant};
use crate::gpu::textures::MapTextures;
use crate::lighting::{Light, MAX_LIGHTS};
use crate::lit_surface::LitSurface;
use crate::normal_map::NormalMap;
use crate::scene::bump::BumpRule;
use crate::scene::{Mesh, Reconstruction, Shape};

/// The format of the pictures: 32-bit floats, which means of many samples need, bit for bit in unsigned integers, which
/// every adapter can draw to.
pub const COLOR_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba32Uint;
/// The format of their depth.
pub const DEPTH_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;

/// The shader's parts, in order.
pub const SHADER: [&str; 18] = [
    layout::VMF,
    layout::BLINN_PHONG,
    layout::TORRANCE_SPARROW,
    layout::GGX,
    layout::MEASURED,
    layout::CONVOLUTION,
    layout::MATERIAL,
    layout::EXACT_TABLE,
    layout::FILTER,
    layout::PROBES,
    layout::SAMPLING,
    layout::TRUTH,
    layout::RECONSTRUCTION,
    layout::BUMP,
    layout::LAT_LONG,
    layout::SKY,
    include_str!("../../../shaders/surface.wgsl"),
    layout::LOBES,
];

/// The parts of a rival's shader, in order: the surface's, the entry point, the method's own.
pub fn rival_shader(kind: &RivalKind) -> Vec<&'static str> {
    SHADER.into_iter().chain([layout::RIVAL, kind.shader]).collect()
}

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
    /// Lights in use.
    pub light_count: u32,
    /// How the frame at a pixel is reconstructed, by the shader's number.
    pub reconstruction: u32,
    /// How a map of heights bumps the surface, by the shader's number; 0 where none does.
    pub bump: u32,
    /// What a height of 1 is then, in world units.
    pub bump_scale: f32,
    /// By how much slopes by texture coordinates are steeper than the map's.
    pub rise: [f32; 2],
    /// Nothing.
    pub padding: [u32; 2],
    /// Which slot each slot is added to.
    pub fold: [[u32; 4]; 4],
    /// The lights.
    pub lights: [LightData; MAX_LIGHTS],
}

/// One light; `Light` in the shader.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct LightData {
    /// Where it stands, in homogeneous coordinates.
    pub position_in_world: [f32; 4],
    /// Linear RGB, at a distance of 1 where it has one.
    pub radiance: [f32; 3],
    /// Nothing.
    pub padding: u32,
}

impl LightData {
    fn new(light: &Light) -> Self {
        let (position, radiance) = (light.position_in_world(), light.radiance());
        Self { position_in_world: position.to_array(), radiance: radiance.to_array(), padding: 0 }
    }
}

impl FrameData {
    /// The part that follows from the surface and the picture's size; the rest is the map's, left 0.
    pub fn of_surface(surface: &LitSurface, size: [u32; 2]) -> Self {
        let lights = surface.lights.as_slice();
        Self {
            lights: std::array::from_fn(|index| lights.get(index).map(LightData::new).unwrap_or_default()),
            light_count: lights.len() as u32,
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

/// What group 0 binds: the frame, exact convolutions, the material, its measured factors.
const FRAME_BINDINGS: [wgpu::BindingType; 4] =
    [layout::UNIFORM, ExactTables::BINDING, layout::UNIFORM, MeasuredTable::BINDING];

/// Pipelines, the mesh and constants.
#[derive(Debug)]
pub struct SurfacePass {
    pipelines: SurfacePipelines,
    variant: Variant,
    constants: wgpu::Buffer,
    reflectance: wgpu::Buffer,
    exact_tables: ExactTables,
    measured: MeasuredTable,
    frame_group: wgpu::BindGroup,
    sky: SkyTextures,
    environment: EnvironmentPass,
    mean_layout: wgpu::BindGroupLayout,
    rival_layout: wgpu::BindGroupLayout,
    mesh: Option<(Shape, MeshBuffers)>,
}

/// What a method reads beside the map.
#[derive(Clone, Copy, Debug)]
pub enum Reads<'a> {
    /// Nothing.
    Nothing,
    /// The truth's mean so far.
    Mean(&'a Target),
    /// A rival's channels.
    Channels(&'a RivalTextures),
}

#[derive(Debug)]
struct MeshBuffers {
    vertices: wgpu::Buffer,
    indices: wgpu::Buffer,
    count: u32,
}

/// Where a method draws.
#[derive(Debug)]
pub struct Target {
    /// Linear RGB and coverage.
    pub color: wgpu::Texture,
    view: wgpu::TextureView,
    depth: wgpu::TextureView,
    /// The picture as the truth reads its mean so far.
    as_mean: wgpu::BindGroup,
}

impl Target {
    /// A view of the picture.
    pub fn view(&self) -> &wgpu::TextureView {
        &self.view
    }
}

impl SurfacePass {
    /// Compiles the pipelines of every method; `map` is the layout of group 1.
    pub fn new(device: &wgpu::Device, map: &wgpu::BindGroupLayout) -> Self {
        let both = wgpu::ShaderStages::VERTEX_FRAGMENT;
        let frame = bind_group_layout(device, "surface frame", both, &FRAME_BINDINGS);
        let mean_type = texture(wgpu::TextureSampleType::Uint, wgpu::TextureViewDimension::D2);
        let mean_layout = bind_group_layout(device, "truth so far", wgpu::ShaderStages::FRAGMENT, &[mean_type]);
        let rival_layout = RivalTextures::layout(device);
        let sky = SkyTextures::new(device);
        let pipelines = SurfacePipelines::new(device, [&frame, map, sky.layout()], [&mean_layout, &rival_layout]);
        let constants = uniform_buffer::<FrameData>(device, "surface frame");
        let reflectance = uniform_buffer::<ReflectanceData>(device, "material");
        let exact_tables = ExactTables::new(device);
        let tables = exact_tables.view();
        let measured = MeasuredTable::new(device);
        let (tables, table) = (texture_view(&tables), measured.view());
        let resources = [constants.as_entire_binding(), tables, reflectance.as_entire_binding(), texture_view(&table)];
        let frame_group = bind_group(device, "surface frame", &frame, &resources);
        Self {
            pipelines,
            variant: Variant::default(),
            constants,
            reflectance,
            exact_tables,
            measured,
            frame_group,
            sky,
            environment: EnvironmentPass::new(device),
            mean_layout,
            rival_layout,
            mesh: None,
        }
    }

    /// No channels yet, of a rival that is to be drawn.
    pub fn rival_textures(&self, device: &wgpu::Device) -> RivalTextures {
        RivalTextures::new(device, &self.rival_layout)
    }

    /// A picture to draw into, with depth of its own.
    pub fn target(&self, device: &wgpu::Device, label: &str, size: [u32; 2]) -> Target {
        use wgpu::TextureUsages as Usage;
        let usage = Usage::RENDER_ATTACHMENT | Usage::TEXTURE_BINDING | Usage::COPY_SRC;
        let color = texture_2d(device, label, size, COLOR_FORMAT, usage);
        let depth = texture_2d(device, "surface depth", size, DEPTH_FORMAT, Usage::RENDER_ATTACHMENT);
        let view = color.create_view(&wgpu::TextureViewDescriptor { label: Some(label), ..Default::default() });
        let depth_label = wgpu::TextureViewDescriptor { label: Some("surface depth"), ..Default::default() };
        let resource = wgpu::BindingResource::TextureView(&view);
        let as_mean = bind_group(device, "truth so far", &self.mean_layout, &[resource]);
        Target { depth: depth.create_view(&depth_label), as_mean, color, view }
    }

    /// Writes the frame's constants and makes sure of the mesh, of the sky and of the tables that the material needs,
    /// for pictures of `size`.
    pub fn prepare(
        &mut self,
        (device, queue): (&wgpu::Device, &wgpu::Queue),
        surface: &LitSurface,
        data: &FrameData,
        size: [u32; 2],
    ) {
        queue.write_buffer(&self.constants, 0, bytemuck::bytes_of(data));
        let reflectance = ReflectanceData::of_material(&surface.material);
        queue.write_buffer(&self.reflectance, 0, bytemuck::bytes_of(&reflectance));
        self.exact_tables.prepare(queue, &surface.material);
        self.measured.prepare(queue, &surface.material);
        if self.sky.prepare(queue, &surface.sky, &surface.material) {
            self.environment.set_sky(device, self.sky.texels());
        }
        self.environment.prepare(queue, surface, size);
        let shape = &surface.shape;
        if self.mesh.as_ref().is_none_or(|(held, _)| !held.has_mesh_of(shape)) {
            self.mesh = Some((shape.clone(), MeshBuffers::new(device, queue, &shape.mesh())));
        }
    }

    /// Makes sure of the pipelines of `methods` for what they will draw next.
    pub fn prepare_methods(&mut self, device: &wgpu::Device, methods: &[Method], variant: Variant) {
        self.variant = variant;
        self.pipelines.make(device, methods, variant);
    }

    /// Draws the shape last prepared by `method` into `target`, and notes when where that is wanted.
    pub fn draw(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        method: Method,
        map: &MapTextures,
        target: &Target,
        reads: Reads<'_>,
        timestamps: Option<wgpu::RenderPassTimestampWrites<'_>>,
    ) {
        let (Some((_, mesh)), Some(pipeline)) = (&self.mesh, self.pipelines.get(method, self.variant)) else {
            return;
        };
        let mut pass = begin(encoder, target, timestamps);
        self.environment.draw(&mut pass);
        pass.set_pipeline(pipeline);
        pass.set_bind_group(0, &self.frame_group, &[]);
        pass.set_bind_group(1, map.bind_group(), &[]);
        pass.set_bind_group(3, self.sky.bind_group(), &[]);
        match reads {
            Reads::Nothing => {}
            Reads::Mean(mean) => pass.set_bind_group(2, &mean.as_mean, &[]),
            Reads::Channels(channels) => pass.set_bind_group(2, channels.bind_group(), &[]),
        }
        pass.set_vertex_buffer(0, mesh.vertices.slice(..));
        pass.set_index_buffer(mesh.indices.slice(..), wgpu::IndexFormat::Uint32);
        pass.draw_indexed(0..mesh.count, 0, 0..1);
    }

    /// Empties `target`.
    pub fn clear(&self, encoder: &mut wgpu::CommandEncoder, target: &Target) {
        drop(begin(encoder, target, None));
    }
}

impl MeshBuffers {
    fn new(device: &wgpu::Device, queue: &wgpu::Queue, mesh: &Mesh) -> Self {
        let buffer = |label, bytes: &[u8], usage| {
            let size = bytes.len() as u64;
            let usage = usage | wgpu::BufferUsages::COPY_DST;
            let descriptor = wgpu::BufferDescriptor { label: Some(label), size, usage, mapped_at_creation: false };
            let buffer = device.create_buffer(&descriptor);
            queue.write_buffer(&buffer, 0, bytes);
            buffer
        };
        Self {
            vertices: buffer("vertices", bytemuck::cast_slice(&mesh.vertices), wgpu::BufferUsages::VERTEX),
            indices: buffer("indices", bytemuck::cast_slice(&mesh.indices), wgpu::BufferUsages::INDEX),
            count: mesh.indices.len() as u32,
        }
    }
}

fn texture_view(view: &wgpu::TextureView) -> wgpu::BindingResource<'_> {
    wgpu::BindingResource::TextureView(view)
}

fn begin<'a>(
    encoder: &'a mut wgpu::CommandEncoder,
    target: &Target,
    timestamps: Option<wgpu::RenderPassTimestampWrites<'_>>,
) -> wgpu::RenderPass<'a> {
    encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        label: Some("surface"),
        color_attachments: &[Some(wgpu::RenderPassColorAttachment {
            view: &target.view,
            depth_slice: None,
            resolve_target: None,
            ops: wgpu::Operations { load: wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT), store: wgpu::StoreOp::Store },
        })],
        depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
            view: &target.depth,
            depth_ops: Some(wgpu::Operations { load: wgpu::LoadOp::Clear(1.0), store: wgpu::StoreOp::Discard }),
            stencil_ops: None,
        }),
        timestamp_writes: timestamps,
        occlusion_query_set: None,
        multiview_mask: None,
    })
}
