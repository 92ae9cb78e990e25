//! The sphere of directions: a texel's NDF as a density and as points, and its lobes as rings and pins.
//!
//! Everything is analytic in the fragment shader, without depth: the sphere is a disc, a ring is a level set of
//! `n . mu`, and what lies behind the horizon is left out.

use glam::{DVec3, Mat3};

use crate::color::{LOBE_COLORS, color_stops, heat};
use crate::gpu::layout::{self, texture_2d};
use crate::reference::ndf_density::{DENSITY_SIZE, MAX_POINTS, NdfPicture};
use crate::sphere::Lobe;
use crate::sphere::mixture::MAX_LOBES;

/// The shader's parts, in order.
pub const SHADER: [&str; 2] = [layout::COLOR_SCALE, include_str!("../../../shaders/sphere.wgsl")];

/// The sphere's diameter over the shorter side of its view; the rest is for pins and labels.
pub const FILL: f64 = 0.83;

/// Decades below the peak that the logarithmic scale covers.
pub const LOG_DECADES: f32 = 4.0;

/// What of a texel is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(default)]
pub struct SphereLayers {
    /// The normals, as points.
    pub points: bool,
    /// Their smooth density, as a heat map.
    pub density: bool,
    /// The fitted lobes.
    pub lobes: bool,
    /// The density on a logarithmic scale.
    pub logarithmic: bool,
}

impl Default for SphereLayers {
    fn default() -> Self {
        Self { points: true, density: true, lobes: true, logarithmic: true }
    }
}

/// One picture of the sphere.
#[derive(Clone, Copy, Debug)]
pub struct SphereInput<'a> {
    /// The texel's NDF.
    pub ndf: &'a NdfPicture,
    /// Slot and lobe.
    pub lobes: &'a [(usize, Lobe)],
    /// How the sphere is turned: view space has x right, y up, z towards the eye.
    pub view_from_tangent: Mat3,
    /// What is drawn.
    pub layers: SphereLayers,
    /// Size of the view in pixels.
    pub size_px: [f32; 2],
    /// Pixels per point of the interface: lines and dots scale by it.
    pub px_per_point: f32,
}

/// Layouts of the uniform buffer, as `sphere.wgsl` reads it.
pub mod gpu_data {
    use crate::sphere::mixture::MAX_LOBES;

    /// One lobe.
    #[repr(C)]
    #[derive(Clone, Copy, Debug, Default, bytemuck::Pod, bytemuck::Zeroable)]
    pub struct LobeMark {
        /// Mean direction in view space.
        pub mu_in_view: [f32; 3],
        /// Cosine at which the density has fallen to exp(-1/2) of its peak.
        pub ring_cosine: f32,
        /// sRGB.
        pub color: [f32; 3],
        /// Weight alpha.
        pub weight: f32,
    }

    /// The uniform buffer.
    #[repr(C)]
    #[derive(Clone, Copy, Debug, Default, bytemuck::Pod, bytemuck::Zeroable)]
    pub struct Sphere {
        /// Columns, each padded to four floats.
        pub view_from_tangent: [[f32; 4]; 3],
        /// Size of the view in pixels.
        pub size_px: [f32; 2],
        /// Radii of the sphere per pixel.
        pub radii_per_px: f32,
        /// Pixels per point.
        pub px_per_point: f32,
        /// Density at the top of the scale.
        pub density_peak: f32,
        /// Decades of a logarithmic scale; 0 for a linear one.
        pub log_decades: f32,
        /// 1 where the density is shown.
        pub density_shown: u32,
        /// Lobes in use.
        pub lobe_count: u32,
        /// Nine stops of the heat scale, sRGB.
        pub heat: [[f32; 4]; 9],
        /// The lobes.
        pub lobes: [LobeMark; MAX_LOBES],
    }
}

/// Pipelines and buffers of the sphere view.
#[derive(Debug)]
pub struct SpherePass {
    surface: wgpu::RenderPipeline,
    points: wgpu::RenderPipeline,
    lobes: wgpu::RenderPipeline,
    uniforms: wgpu::Buffer,
    density: wgpu::Texture,
    point_buffer: wgpu::Buffer,
    bindings: wgpu::BindGroup,
    uploaded: Option<u64>,
    point_count: u32,
    layers: SphereLayers,
}

impl SpherePass {
    /// Builds the pipelines for a colour target of `format`.
    pub fn new(device: &wgpu::Device, format: wgpu::TextureFormat) -> Self {
        // Read by textureLoad and interpolated by hand, so that 32-bit textures need no filtering.
        let sample_type = wgpu::TextureSampleType::Float { filterable: false };
        let types = [layout::UNIFORM, layout::texture(sample_type, wgpu::TextureViewDimension::D2)];
        let group = layout::bind_group_layout(device, "sphere", wgpu::ShaderStages::VERTEX_FRAGMENT, &types);
        let pipeline = PipelineMaker::new(device, &group, format);
        let uniforms = layout::uniform_buffer::<gpu_data::Sphere>(device, "sphere");
        let density = density_texture(device);
        let view = density.create_view(&wgpu::TextureViewDescriptor::default());
        let resources = [uniforms.as_entire_binding(), wgpu::BindingResource::TextureView(&view)];
        let bindings = layout::bind_group(device, "sphere", &group, &resources);
        Self {
            surface: pipeline.make("sphere surface", "cover", "surface", false),
            points: pipeline.make("sphere points", "place_point", "draw_point", true),
            lobes: pipeline.make("sphere lobes", "cover", "draw_lobes", false),
            uniforms,
            density,
            point_buffer: vertex_buffer(device),
            bindings,
            uploaded: None,
            point_count: 0,
            layers: SphereLayers::default(),
        }
    }

    /// Uploads what `draw` needs. Points and density go up only when `ndf_revision` differs from the last call's.
    pub fn prepare(&mut self, queue: &wgpu::Queue, input: &SphereInput<'_>, ndf_revision: u64) {
        if self.uploaded != Some(ndf_revision) {
            self.upload_ndf(queue, input.ndf);
            self.uploaded = Some(ndf_revision);
        }
        queue.write_buffer(&self.uniforms, 0, bytemuck::bytes_of(&uniforms(input)));
        self.layers = input.layers;
    }

    fn upload_ndf(&mut self, queue: &wgpu::Queue, ndf: &NdfPicture) {
        let size = DENSITY_SIZE as u32;
        queue.write_texture(
            self.density.as_image_copy(),
            bytemuck::cast_slice(&ndf.density),
            wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(4 * size), rows_per_image: None },
            wgpu::Extent3d { width: size, height: size, depth_or_array_layers: 1 },
        );
        let points = point_instances(&ndf.points);
        queue.write_buffer(&self.point_buffer, 0, bytemuck::cast_slice(&points));
        self.point_count = points.len() as u32;
    }

    /// Draws into a pass whose viewport is the sphere's view, blending over what is there.
    pub fn draw(&self, pass: &mut wgpu::RenderPass<'_>) {
        pass.set_bind_group(0, &self.bindings, &[]);
        pass.set_pipeline(&self.surface);
        pass.draw(0..3, 0..1);
        if self.layers.points {
            pass.set_pipeline(&self.points);
            pass.set_vertex_buffer(0, self.point_buffer.slice(..));
            pass.draw(0..4, 0..self.point_count);
        }
        if self.layers.lobes {
            pass.set_pipeline(&self.lobes);
            pass.draw(0..3, 0..1);
        }
    }
}

/// Radius of a dot in points: its area reads as the weight, within what stays visible and apart; many are small.
fn point_instances(points: &[(DVec3, f64)]) -> Vec<[f32; 4]> {
    let mean = 1.0 / points.len().max(1) as f64;
    let typical = (30.0 * mean.sqrt()).clamp(0.4, 1.8);
    let instance = |&(direction, weight): &(DVec3, f64)| {
        let radius = (typical * (weight / mean).sqrt()).clamp(0.4, 3.0);
        direction.extend(radius).as_vec4().to_array()
    };
    points.iter().take(MAX_POINTS).map(instance).collect()
}

fn uniforms(input: &SphereInput<'_>) -> gpu_data::Sphere {
    let columns = input.view_from_tangent.to_cols_array_2d();
    let shorter = input.size_px[0].min(input.size_px[1]);
    let mut uniforms = gpu_data::Sphere {
        view_from_tangent: columns.map(|[x, y, z]| [x, y, z, 0.0]),
        size_px: input.size_px,
        radii_per_px: 2.0 / (shorter * FILL as f32),
        px_per_point: input.px_per_point,
        density_peak: input.ndf.peak,
        log_decades: if input.layers.logarithmic { LOG_DECADES } else { 0.0 },
        density_shown: u32::from(input.layers.density),
        lobe_count: input.lobes.len().min(MAX_LOBES) as u32,
        heat: color_stops(heat),
        ..Default::default()
    };
    for (mark, (slot, lobe)) in uniforms.lobes.iter_mut().zip(input.lobes) {
        *mark = lobe_mark(input.view_from_tangent, *slot, lobe);
    }
    uniforms
}

fn lobe_mark(view_from_tangent: Mat3, slot: usize, lobe: &Lobe) -> gpu_data::LobeMark {
    let [r, g, b, _] = unit_rgb(LOBE_COLORS[slot % MAX_LOBES], 1.0);
    gpu_data::LobeMark {
        mu_in_view: (view_from_tangent * lobe.mean_direction.as_vec3()).to_array(),
        ring_cosine: ring_cosine(lobe.concentration) as f32,
        color: [r, g, b],
        weight: lobe.weight as f32,
    }
}

/// Cosine at which a lobe's density has fallen to `exp(-1/2)` of its peak, one standard deviation: `1 - 1/(2 kappa)`.
/// A lobe so wide that it never falls that far has its ring at its antipode.
pub fn ring_cosine(kappa: f64) -> f64 {
    (1.0 - 0.5 / kappa.max(1e-9)).max(-1.0)
}

fn unit_rgb(rgb: [u8; 3], fourth: f32) -> [f32; 4] {
    let [r, g, b] = rgb.map(|code| f32::from(code) / 255.0);
    [r, g, b, fourth]
}

fn vertex_buffer(device: &wgpu::Device) -> wgpu::Buffer {
    device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("sphere points"),
        size: (MAX_POINTS * size_of::<[f32; 4]>()) as u64,
        usage: wgpu::BufferUsages::VERTEX | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    })
}

fn density_texture(device: &wgpu::Device) -> wgpu::Texture {
    let usage = wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST;
    texture_2d(device, "sphere density", [DENSITY_SIZE as u32; 2], wgpu::TextureFormat::R32Float, usage)
}

/// What the three pipelines share.
struct PipelineMaker<'a> {
    device: &'a wgpu::Device,
    module: wgpu::ShaderModule,
    layout: wgpu::PipelineLayout,
    format: wgpu::TextureFormat,
}

impl<'a> PipelineMaker<'a> {
    fn new(device: &'a wgpu::Device, group: &wgpu::BindGroupLayout, format: wgpu::TextureFormat) -> Self {
        let module = layout::shader(device, "sphere", &SHADER);
        let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some("sphere"),
            bind_group_layouts: &[Some(group)],
            immediate_size: 0,
        });
        Self { device, module, layout, format }
    }

    fn make(&self, label: &str, vertex: &str, fragment: &str, instanced: bool) -> wgpu::RenderPipeline {
        let instances = wgpu::VertexBufferLayout {
            array_stride: size_of::<[f32; 4]>() as u64,
            step_mode: wgpu::VertexStepMode::Instance,
            attributes: &wgpu::vertex_attr_array![0 => Float32x4],
        };
        let buffers = [Some(instances)];
        let topology = if instanced { wgpu::PrimitiveTopology::TriangleStrip } else { Default::default() };
        self.device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some(label),
            layout: Some(&self.layout),
            vertex: wgpu::VertexState {
                module: &self.module,
                entry_point: Some(vertex),
                compilation_options: Default::default(),
                buffers: if instanced { &buffers } else { &[] },
            },
            primitive: wgpu::PrimitiveState { topology, ..Default::default() },
            depth_stencil: None,
            multisample: wgpu::MultisampleState::default(),
            fragment: Some(wgpu::FragmentState {
                module: &self.module,
                entry_point: Some(fragment),
                compilation_options: Default::default(),
                targets: &[Some(wgpu::ColorTargetState {
                    format: self.format,
                    blend: Some(wgpu::BlendState::PREMULTIPLIED_ALPHA_BLENDING),
                    write_mask: wgpu::ColorWrites::ALL,
                })],
            }),
            multiview_mask: None,
            cache: None,
        })
    }
}
