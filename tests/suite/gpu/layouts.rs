//! Rust and WGSL agree on every structure they share, and every shader is valid.

use std::mem::offset_of;

use ndf_inspector::filter::rival::RIVALS;
use ndf_inspector::gpu::frame_data::{FrameData, LightData};
use ndf_inspector::gpu::passes::compare::{self, CompareData};
use ndf_inspector::gpu::passes::environment::{self, EnvironmentData};
use ndf_inspector::gpu::passes::sphere::{self, gpu_data};
use ndf_inspector::gpu::passes::surface;
use ndf_inspector::gpu::reflectance::{MaterialData, ReflectanceData};
use ndf_inspector::gpu::rival_textures::RivalData;
use ndf_inspector::gpu::sky_textures::SkyData;
use wgpu::naga;

fn parse(parts: &[&str]) -> naga::Module {
    let source = parts.concat();
    let module = naga::front::wgsl::parse_str(&source).unwrap_or_else(|e| panic!("{}", e.emit_to_string(&source)));
    let mut validator =
        naga::valid::Validator::new(naga::valid::ValidationFlags::all(), naga::valid::Capabilities::empty());
    validator.validate(&module).unwrap_or_else(|e| panic!("{}", e.emit_to_string(&source)));
    module
}

/// Names and offsets of a structure's members, and its size.
fn layout(module: &naga::Module, name: &str) -> (Vec<(String, usize)>, usize) {
    let mut found = module.types.iter().filter(|(_, ty)| ty.name.as_deref() == Some(name));
    let (_, ty) = found.next().expect("the structure is in the shader");
    let naga::TypeInner::Struct { members, span } = &ty.inner else { panic!("{name} is no structure") };
    let member = |m: &naga::StructMember| (m.name.clone().unwrap_or_default(), m.offset as usize);
    (members.iter().map(member).collect(), *span as usize)
}

macro_rules! rust_layout {
    ($structure:ty { $($member:ident),* $(,)? }) => {
        (vec![$((stringify!($member).to_owned(), offset_of!($structure, $member))),*], size_of::<$structure>())
    };
}

#[test]
fn the_surface_shader_is_valid_and_lays_out_the_frame_as_rust_does() {
    let module = parse(&surface::SHADER);
    let rust = rust_layout!(FrameData {
        clip_from_world,
        eye_in_world,
        fixed_level,
        uv_from_surface,
        base_size,
        vmf_lods,
        base_level,
        lobe_level,
        lobes,
        wraps,
        first_sample,
        sample_count,
        level_choice,
        most_probes,
        light_count,
        reconstruction,
        bump,
        bump_scale,
        rise,
        lamp_count,
        padding,
        fold,
        lights,
    });
    assert_eq!(layout(&module, "Frame"), rust);
    assert_eq!(layout(&module, "Light"), rust_layout!(LightData { position_in_world, radiance, diffuse }));
    let sky = rust_layout!(SkyData { turn, intensity, last_band, specular_bands, diffuse_bands });
    assert_eq!(layout(&module, "Sky"), sky);
    let rust = rust_layout!(ReflectanceData { material, lobes, multipliers });
    assert_eq!(layout(&module, "Reflectance"), rust);
    let (members, _) = rust_layout!(MaterialData {
        specular_color,
        specular,
        diffuse_color,
        diffuse,
        exponent,
        roughness,
        peak,
        fresnel,
        convolution,
        diffuse_rule,
    });
    assert_eq!(layout(&module, "Material"), (members, size_of::<MaterialData>()));
}

#[test]
fn every_rivals_shader_is_valid_and_lays_out_its_constants_as_rust_does() {
    for kind in RIVALS {
        let module = parse(&surface::rival_shader(kind));
        assert_eq!(layout(&module, "Rival"), rust_layout!(RivalData { lods, first_level, parameter }), "{}", kind.name);
    }
}

#[test]
fn the_environment_shader_is_valid_and_lays_out_its_constants_as_rust_does() {
    let module = parse(&environment::SHADER);
    let rust = rust_layout!(EnvironmentData { world_from_clip, eye_in_world, intensity, turn, padding });
    assert_eq!(layout(&module, "Environment"), rust);
}

#[test]
fn the_compare_shader_is_valid_and_lays_out_its_constants_as_rust_does() {
    let module = parse(&compare::SHADER);
    let rust = rust_layout!(CompareData {
        origin,
        extent,
        left_scale,
        right_scale,
        wipe,
        divider,
        border,
        ends,
        shown,
        padding,
        more_padding,
        scale,
    });
    assert_eq!(layout(&module, "Compare"), rust);
}

#[test]
fn the_sphere_shader_is_valid_and_lays_out_its_structures_as_rust_does() {
    let module = parse(&sphere::SHADER);
    let rust = rust_layout!(gpu_data::Sphere {
        view_from_tangent,
        size_px,
        radii_per_px,
        px_per_point,
        density_peak,
        log_decades,
        density_shown,
        lobe_count,
        heat,
        lobes,
    });
    assert_eq!(layout(&module, "Sphere"), rust);
    assert_eq!(
        layout(&module, "LobeMark"),
        rust_layout!(gpu_data::LobeMark { mu_in_view, ring_cosine, color, weight })
    );
}
