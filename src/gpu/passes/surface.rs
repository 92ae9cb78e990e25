//! Draws the lit surface by one method into a picture of its own, in linear light with depth.

use super::environment::EnvironmentPass;
use crate::filter::Method;
use crate::filter::rival::RivalKind;
use crate::gpu::exact_tables::ExactTables;
use crate::gpu::frame_data::FrameData;
use crate::gpu::layout::{self, bind_group, bind_group_layout, texture, texture_2d, uniform_buffer};
use crate::gpu::measured_table::MeasuredTable;
use crate::gpu::reflectance::ReflectanceData;
use crate::gpu::rival_textures::RivalTextures;
use crate::gpu::sky_textures::SkyTextures;
use crate::gpu::surface_pipelines::{SurfacePipelines, Variant};
use crate::gpu::textures::MapTextures;
use crate::lit_surface::LitSurface;
use crate::scene::{Mesh, Shape};

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
