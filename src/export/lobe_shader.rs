//! The lobe shader for other renderers: one source in WGSL, translated to GLSL and HLSL by naga.
//!
//! It is the window's own way from a stored lobe to light: the same inverse of A(kappa), the default rule of
//! convolution, the cosine of the lobe's direction. A header says how the textures are laid out in each language.

use naga::back::{glsl, hlsl};
use naga::proc::BoundsCheckPolicies;
use naga::valid::{Capabilities, ModuleInfo, ValidationFlags, Validator};
use naga::{Module, ShaderStage};

/// A shading language.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Language {
    /// WebGPU's.
    #[default]
    Wgsl,
    /// OpenGL's, version 4.50.
    Glsl,
    /// Direct3D's, shader model 6.0.
    Hlsl,
}

/// The shader could not be translated; the text is naga's.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the shader cannot be translated: {0}")]
pub struct TranslateError(String);

/// The name of the entry point, a fragment shader.
const ENTRY: &str = "shade";

const INVERSE: &str = include_str!("../../shaders/shared/vmf.wgsl");
const SHADING: &str = include_str!("../../shaders/export/lobes.wgsl");

/// What every language's header says.
const LAYOUT: &str = "\
A lit texel from its von Mises-Fisher lobes.

Texture: a 2-D array of four floats (32 or 16 bits), all MIP levels, a layer per slot j. A texel of layer j holds
(alpha, alpha A(kappa) mu.x, alpha A(kappa) mu.y, alpha A(kappa) mu.z): the channels lobe.NN.alpha, .rx, .ry and .rz of
the part level.LL that `ndf-inspector export MAP lobes` writes. All interpolate linearly: sample trilinearly.
Tangent space: +x right, +y up the image, +z out of it; v runs down the image. Light and eye need no unit length.
Result: radiance under a light of radiance 1, linear RGB.
";

impl Language {
    /// Every language, in the order they are offered.
    pub const ALL: [Self; 3] = [Self::Wgsl, Self::Glsl, Self::Hlsl];

    /// The name to show.
    pub fn label(self) -> &'static str {
        match self {
            Self::Wgsl => "WGSL",
            Self::Glsl => "GLSL",
            Self::Hlsl => "HLSL",
        }
    }

    /// The ending of files in it.
    pub fn ending(self) -> &'static str {
        match self {
            Self::Wgsl => "wgsl",
            Self::Glsl => "glsl",
            Self::Hlsl => "hlsl",
        }
    }

    /// Where its bindings are.
    fn bindings(self) -> &'static str {
        match self {
            Self::Wgsl => "Bindings: group 0, the texture 0, its sampler 1, the material 2.",
            Self::Glsl => "Bindings: the texture with its sampler 0, the material's block 2 (std140).",
            Self::Hlsl => "Bindings: the texture t0, its sampler s1, the material b2.",
        }
    }
}

/// The shader for `lobes` slots, 1 to 16.
///
/// # Errors
/// What naga says, which a test holds that it does not.
pub fn lobe_shader(lobes: usize, language: Language) -> Result<String, TranslateError> {
    let source = source(lobes);
    let header = format!("{LAYOUT}{}\n", language.bindings());
    let header: String = header.lines().map(|line| format!("// {line}").trim_end().to_owned() + "\n").collect();
    let translated = match language {
        Language::Wgsl => return Ok(format!("{header}\n{source}")),
        Language::Glsl => glsl(&source)?,
        Language::Hlsl => hlsl(&source)?,
    };
    // GLSL asks for its version on the first line.
    let (first, rest) = if translated.starts_with("#version") {
        translated.split_once('\n').unwrap_or((&translated, ""))
    } else {
        ("", translated.as_str())
    };
    Ok(format!("{first}\n{header}\n{rest}").trim_start().to_owned())
}

fn source(lobes: usize) -> String {
    format!("const LOBES: u32 = {lobes}u;\n\n{INVERSE}\n{SHADING}")
}

fn validated(source: &str) -> Result<(Module, ModuleInfo), TranslateError> {
    let module = naga::front::wgsl::parse_str(source).map_err(|error| failed(error.emit_to_string(source)))?;
    let info = Validator::new(ValidationFlags::all(), Capabilities::empty()).validate(&module).map_err(failed)?;
    Ok((module, info))
}

fn failed(error: impl ToString) -> TranslateError {
    TranslateError(error.to_string())
}

fn glsl(source: &str) -> Result<String, TranslateError> {
    let (module, info) = validated(source)?;
    let bindings = [(0, 0), (2, 2)].map(|(binding, slot)| (naga::ResourceBinding { group: 0, binding }, slot));
    let options = glsl::Options {
        version: glsl::Version::Desktop(450),
        binding_map: bindings.into_iter().collect(),
        ..glsl::Options::default()
    };
    let pipeline =
        glsl::PipelineOptions { shader_stage: ShaderStage::Fragment, entry_point: ENTRY.to_owned(), multiview: None };
    let mut text = String::new();
    let writer = glsl::Writer::new(&mut text, &module, &info, &options, &pipeline, BoundsCheckPolicies::default());
    writer.and_then(|mut writer| writer.write()).map_err(failed)?;
    // The names that the source has.
    Ok(text.replace("_group_0_binding_0_fs", "lobes").replace("_group_0_binding_2_fs", "material"))
}

fn hlsl(source: &str) -> Result<String, TranslateError> {
    let (module, info) = validated(source)?;
    let target = |binding: u32| {
        let place = naga::ResourceBinding { group: 0, binding };
        (place, hlsl::BindTarget { register: binding, ..hlsl::BindTarget::default() })
    };
    let options = hlsl::Options {
        shader_model: hlsl::ShaderModel::V6_0,
        binding_map: (0..3).map(target).collect(),
        // The buffer of sampler indices, which goes below.
        fake_missing_bindings: true,
        ..hlsl::Options::default()
    };
    let pipeline = hlsl::PipelineOptions { entry_point: Some((ShaderStage::Fragment, ENTRY.to_owned())) };
    let mut text = String::new();
    hlsl::Writer::new(&mut text, &options, &pipeline).write(&module, &info, None).map_err(failed)?;
    Ok(with_plain_sampler(&text))
}

/// Declares the sampler as people do: naga takes it from a heap of samplers, by an index from a buffer.
fn with_plain_sampler(hlsl: &str) -> String {
    let declared = |line: &str| {
        let of_heap = line.starts_with("SamplerState nagaSamplerHeap")
            || line.starts_with("SamplerComparisonState nagaComparisonSamplerHeap")
            || line.starts_with("StructuredBuffer<uint> nagaGroup0SamplerIndexArray");
        match line.split_once(" = nagaSamplerHeap[") {
            Some((declaration, _)) => {
                Some(format!("{} : register(s1);", declaration.trim_start_matches("static const ")))
            }
            None => (!of_heap).then(|| line.to_owned()),
        }
    };
    hlsl.lines().filter_map(declared).map(|line| line + "\n").collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_language_holds_the_layout_and_the_entry_point() {
        for language in Language::ALL {
            for lobes in [1, 6, 16] {
                let text = lobe_shader(lobes, language).expect("a translation");
                assert!(text.contains("lobe.NN.alpha") && text.contains(language.bindings()), "{text}");
                assert!(text.contains("LOBES") && text.contains(&format!("{lobes}u")), "{text}");
            }
        }
    }

    #[test]
    fn wgsl_is_valid_as_it_is_exported() {
        validated(&lobe_shader(6, Language::Wgsl).expect("text")).expect("valid");
    }

    #[test]
    fn glsl_starts_with_its_version_and_has_one_sampler_and_one_block() {
        let text = lobe_shader(6, Language::Glsl).expect("a translation");
        assert!(text.starts_with("#version 450"), "{text}");
        for declared in ["sampler2DArray lobes;", "void main()", "material;"] {
            assert_eq!(text.matches(declared).count(), 1, "{declared}: {text}");
        }
    }

    #[test]
    fn hlsl_has_plain_registers() {
        let text = lobe_shader(6, Language::Hlsl).expect("a translation");
        assert!(!text.contains("naga"), "{text}");
        for declared in
            ["Texture2DArray<float4> lobes : register(t0", "SamplerState trilinear : register(s1", "register(b2"]
        {
            assert_eq!(text.matches(declared).count(), 1, "{declared}: {text}");
        }
    }
}
