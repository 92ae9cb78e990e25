//! Draws the sky behind the surface, into the surface's own picture.

use super::surface::{COLOR_FORMAT, DEPTH_FORMAT};
use crate::gpu::layout::{self, bind_group, bind_group_layout, texture, uniform_buffer};
use crate::lit_surface::LitSurface;

/// The shader's parts, in order.
pub const SHADER: [&str; 2] = [layout::LAT_LONG, include_str!("../../../shaders/environment.wgsl")];

/// Where the sky is seen from; `Environment` in the shader.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct EnvironmentData {
    /// World space from clip space.
    pub world_from_clip: [[f32; 4]; 4],
    /// The eye.
    pub eye_in_world: [f32; 3],
    /// Factor on the sky's radiance.
    pub intensity: f32,
    /// Cosine and sine of the sky's rotation.
    pub turn: [f32; 2],
    /// Nothing.
    pub padding: [u32; 2],
}

impl EnvironmentData {
    /// The sky in a picture of `size`.
    pub fn new(surface: &LitSurface, size: [u32; 2]) -> Self {
        let clip_from_world = surface.camera.clip_from_world(size[0] as f32 / size[1] as f32);
        let (sin, cos) = surface.sky.rotation_deg.to_radians().sin_cos();
        Self {
            world_from_clip: clip_from_world.inverse().to_cols_array_2d(),
            eye_in_world: surface.camera.eye_in_world().to_array(),
            intensity: surface.sky.intensity,
            turn: [cos, sin],
            padding: [0; 2],
        }
    }
}

/// The pipeline, its constants and the sky's picture.
#[derive(Debug)]
pub struct EnvironmentPass {
    pipeline: wgpu::RenderPipeline,
    layout: wgpu::BindGroupLayout,
    constants: wgpu::Buffer,
    bind_group: Option<wgpu::BindGroup>,
    is_seen: bool,
}

impl EnvironmentPass {
    /// Compiles the pipeline.
    pub fn new(device: &wgpu::Device) -> Self {
        let read = wgpu::TextureSampleType::Float { filterable: false };
        let types = [layout::UNIFORM, texture(read, wgpu::TextureViewDimension::D2)];
        let layout = bind_group_layout(device, "environment", wgpu::ShaderStages::FRAGMENT, &types);
        let pipeline = pipeline(device, &layout);
        let constants = uniform_buffer::<EnvironmentData>(device, "environment");
        Self { pipeline, layout, constants, bind_group: None, is_seen: false }
    }

    /// Takes up another sky.
    pub fn set_sky(&mut self, device: &wgpu::Device, texels: &wgpu::Texture) {
        let view = texels.create_view(&wgpu::TextureViewDescriptor { label: Some("sky"), ..Default::default() });
        let resources = [self.constants.as_entire_binding(), wgpu::BindingResource::TextureView(&view)];
        self.bind_group = Some(bind_group(device, "environment", &self.layout, &resources));
    }

    /// Writes the constants for a picture of `size`.
    pub fn prepare(&mut self, queue: &wgpu::Queue, surface: &LitSurface, size: [u32; 2]) {
        self.is_seen = surface.sky.is_seen && surface.sky.environment.is_some();
        let data = EnvironmentData::new(surface, size);
        queue.write_buffer(&self.constants, 0, bytemuck::bytes_of(&data));
    }

    /// Covers the picture with the sky, where it is seen.
    pub fn draw(&self, pass: &mut wgpu::RenderPass<'_>) {
        let Some(bind_group) = self.bind_group.as_ref().filter(|_| self.is_seen) else { return };
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, bind_group, &[]);
        pass.draw(0..3, 0..1);
    }
}

fn pipeline(device: &wgpu::Device, layout: &wgpu::BindGroupLayout) -> wgpu::RenderPipeline {
    let module = layout::shader(device, "environment", &SHADER);
    let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: Some("environment"),
        bind_group_layouts: &[Some(layout)],
        immediate_size: 0,
    });
    device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some("environment"),
        layout: Some(&layout),
        vertex: wgpu::VertexState {
            module: &module,
            entry_point: Some("vertex"),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            buffers: &[],
        },
        primitive: wgpu::PrimitiveState::default(),
        // It shares the surface's pass and leaves its depth alone.
        depth_stencil: Some(wgpu::DepthStencilState {
            format: DEPTH_FORMAT,
            depth_write_enabled: Some(false),
            depth_compare: Some(wgpu::CompareFunction::Always),
            stencil: wgpu::StencilState::default(),
            bias: wgpu::DepthBiasState::default(),
        }),
        multisample: wgpu::MultisampleState::default(),
        fragment: Some(wgpu::FragmentState {
            module: &module,
            entry_point: Some("fragment"),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            targets: &[Some(COLOR_FORMAT.into())],
        }),
        multiview_mask: None,
        cache: None,
    })
}
