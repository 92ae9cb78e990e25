//! The surface pass's pipelines: one per method, and per kind of map and material, made when first drawn.
//!
//! What differs is fixed when a pipeline is made and not asked per pixel: software adapters run both sides of every
//! branch, and would fetch the colours that a map does not have.

use std::collections::HashMap;

use super::passes::surface::{COLOR_FORMAT, DEPTH_FORMAT, SHADER, rival_shader};
use crate::brdf::{ConvolutionRule, DiffuseRule, Model};
use crate::filter::{Method, Rival};
use crate::gpu::layout;
use crate::lit_surface::LitSurface;
use crate::scene::Vertex;

/// What a pipeline is made for; the shader's overrides.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Variant {
    /// `COLORED`: the map has colour.
    pub colored: bool,
    /// `EXACT_RULES`: the material names an exact rule.
    pub exact: bool,
    /// `SKY`: a sky lights the surface.
    pub sky: bool,
    /// `MODEL`: the specular part's model.
    pub model: Model,
}

impl Variant {
    /// The variant for a surface.
    pub fn new(colored: bool, surface: &LitSurface) -> Self {
        let material = &surface.material;
        let exact = material.convolution == ConvolutionRule::Exact || material.diffuse_rule == DiffuseRule::Exact;
        // A material without a specular part is drawn as one of strength 0, an unread one as what stands in for it.
        let model = match Model::from(material.brdf()) {
            Model::Lambert => Model::default(),
            model => model,
        };
        Self { colored, exact, sky: surface.sky.environment.is_some(), model }
    }

    /// What `method` has of it: rules are for lobes.
    fn of(self, method: Method) -> Self {
        Self { exact: self.exact && method.shows_lobes(), ..self }
    }
}

/// A model by the shader's number.
fn number_of(model: Model) -> u8 {
    match model {
        Model::Lambert | Model::BlinnPhong => 0,
        Model::TorranceSparrow => 1,
        Model::Ggx => 2,
        Model::Measured => 3,
    }
}

/// The pipelines made so far.
#[derive(Debug)]
pub struct SurfacePipelines {
    shader: wgpu::ShaderModule,
    /// By name: each is compiled when it is first shown.
    rival_shaders: HashMap<&'static str, wgpu::ShaderModule>,
    layout: wgpu::PipelineLayout,
    truth_layout: wgpu::PipelineLayout,
    rival_layout: wgpu::PipelineLayout,
    made: HashMap<(Method, Variant), wgpu::RenderPipeline>,
}

/// The method whose pipeline draws `method`: a rival's number is no part of it.
fn without_number(method: Method) -> Method {
    method.rival().map_or(method, |rival| Method::Rival(Rival::plain(rival.kind)))
}

impl SurfacePipelines {
    /// Compiles the truth and the lobes for maps without colour, rules of closed form and no sky; `groups` are frame, map
    /// and sky, then the truth's mean so far and a rival's channels, which take the same place before the sky.
    pub fn new(
        device: &wgpu::Device,
        [frame, map, sky]: [&wgpu::BindGroupLayout; 3],
        [mean, rival]: [&wgpu::BindGroupLayout; 2],
    ) -> Self {
        let layout = |groups: &[Option<&wgpu::BindGroupLayout>]| {
            device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
                label: Some("surface"),
                bind_group_layouts: groups,
                immediate_size: 0,
            })
        };
        let mut pipelines = Self {
            shader: layout::shader(device, "surface", &SHADER),
            rival_shaders: HashMap::new(),
            layout: layout(&[Some(frame), Some(map), None, Some(sky)]),
            truth_layout: layout(&[Some(frame), Some(map), Some(mean), Some(sky)]),
            rival_layout: layout(&[Some(frame), Some(map), Some(rival), Some(sky)]),
            made: HashMap::new(),
        };
        pipelines.make(device, &[Method::Truth, Method::Vmf, Method::VmfUnaligned], Variant::default());
        pipelines
    }

    /// Makes what is missing to draw `methods`.
    pub fn make(&mut self, device: &wgpu::Device, methods: &[Method], variant: Variant) {
        for &method in methods {
            let (method, variant) = (without_number(method), variant.of(method));
            if !self.made.contains_key(&(method, variant)) {
                let shader = self.shader_of(device, method);
                let pipeline = self.pipeline(device, &shader, method, variant);
                self.made.insert((method, variant), pipeline);
            }
        }
    }

    /// The pipeline of a method, if it was made.
    pub fn get(&self, method: Method, variant: Variant) -> Option<&wgpu::RenderPipeline> {
        self.made.get(&(without_number(method), variant.of(method)))
    }

    fn shader_of(&mut self, device: &wgpu::Device, method: Method) -> wgpu::ShaderModule {
        let Some(Rival { kind, .. }) = method.rival() else { return self.shader.clone() };
        let compile = || layout::shader(device, kind.name, &rival_shader(kind));
        self.rival_shaders.entry(kind.name).or_insert_with(compile).clone()
    }

    fn pipeline(
        &self,
        device: &wgpu::Device,
        shader: &wgpu::ShaderModule,
        method: Method,
        variant: Variant,
    ) -> wgpu::RenderPipeline {
        let attributes = wgpu::vertex_attr_array![
            0 => Float32x3, 1 => Float32x3, 2 => Float32x4, 3 => Float32x4, 4 => Float32x2, 5 => Float32x4
        ];
        let number = |flag: bool| f64::from(u8::from(flag));
        let overrides = [
            ("COLORED", number(variant.colored)),
            ("EXACT_RULES", number(variant.exact)),
            ("SKY", number(variant.sky)),
            ("MODEL", f64::from(number_of(variant.model))),
        ];
        let (layout, entry_point) = match method {
            Method::Truth => (&self.truth_layout, "truth"),
            Method::Vmf => (&self.layout, "vmf"),
            Method::VmfUnaligned => (&self.layout, "vmf_unaligned"),
            Method::Rival(_) => (&self.rival_layout, "rival"),
        };
        device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some(entry_point),
            layout: Some(layout),
            vertex: wgpu::VertexState {
                module: shader,
                entry_point: Some("vertex"),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                buffers: &[Some(wgpu::VertexBufferLayout {
                    array_stride: size_of::<Vertex>() as u64,
                    step_mode: wgpu::VertexStepMode::Vertex,
                    attributes: &attributes,
                })],
            },
            // Both sides are drawn: a plane that vanished when seen from below would puzzle.
            primitive: wgpu::PrimitiveState::default(),
            depth_stencil: Some(wgpu::DepthStencilState {
                format: DEPTH_FORMAT,
                depth_write_enabled: Some(true),
                depth_compare: Some(wgpu::CompareFunction::Less),
                stencil: wgpu::StencilState::default(),
                bias: wgpu::DepthBiasState::default(),
            }),
            multisample: wgpu::MultisampleState::default(),
            fragment: Some(wgpu::FragmentState {
                module: shader,
                entry_point: Some(entry_point),
                compilation_options: wgpu::PipelineCompilationOptions { constants: &overrides, ..Default::default() },
                targets: &[Some(COLOR_FORMAT.into())],
            }),
            multiview_mask: None,
            cache: None,
        })
    }
}
