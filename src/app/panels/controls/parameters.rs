//! Every parameter of the controls: name, range, default, unit, tooltip.

use crate::app::light_view::LightView;
use crate::app::parameter::Parameter;
use crate::app::view_state::NeedlesView;
use crate::brdf::{ConvolutionRule, DiffuseRule, Material};
use crate::filter::LevelChoice;
use crate::filter::probes::MOST_PROBES;
use crate::filter::vmf::{Alignment, Objective, Selection};
use crate::lighting::sky_harmonics::MOST_BANDS;
use crate::lighting::{Light, Sky};
use crate::normal_map::MapOptions;
use crate::scene::Shape;
use crate::session::Session;

const MATERIAL: Material = Material::DEFAULT;
const LIGHT: Light = Light::DEFAULT;
/// Of a light that becomes a point light: outside every shape.
pub(super) const DEFAULT_LIGHT_DISTANCE: f32 = 2.5;
const SHAPE_DEFAULT: Shape = Shape::DEFAULT;

/// A dimensionless parameter on a linear scale.
const PLAIN: Parameter =
    Parameter { name: "", range: [0.0, 1.0], default: 0.0, unit: "", decimals: 2, logarithmic: false, tooltip: "" };

pub(super) const GREEN: &str = "Which way the green channel points: up the image (OpenGL) or down (DirectX).";
pub(super) const TWO_CHANNEL: &str = "Takes z from x and y, whatever the third channel holds.";
pub(super) const X_IN_ALPHA: &str =
    "What alpha holds: nothing that is read, or x, with y in green and z taken from both.";
pub(super) const HEIGHTS: &str = "Reads the image as heights and takes the normals from their slope.";
pub(super) const SHAPE: &str = "What wears the map. A mesh is read from an OBJ, glTF or GLB file.";
pub(super) const MESH: &str = "Opens an OBJ, glTF or GLB file as the surface. A normal texture that it brings becomes \
                               the map.";
pub(super) const FRAMES: &str = "The tangent frames of vertices: those that a glTF file brings, MikkTSpace's where it \
                                 brings none; MikkTSpace's, the standard; or by the four rules of Mikkelsen's thesis \
                                 with an angular threshold.";
pub(super) const RECONSTRUCTION: &str = "What is made of the vertices' frames at a pixel between them: a rotation; both derivatives in the plane of the \
     normal (Mikkelsen's section 3.4); or the interpolated vectors as they are (3.5). A map should be read as it was baked.";
pub(super) const SPLITS: &str = "A split frame is a vertex that differs from another in its tangents alone: at mirrors, \
                                 and where derivatives lie further apart than the threshold.";
pub(super) const FRAME_NEEDLES: &str = "Draws the frames of some vertices: the map's rows vermilion, its columns green, \
                                        the normal blue.";
pub(super) const NEEDLES: &str = "Draws two normals of the relief at points of the surface: that of the displaced surface \
                                  (orange, Mikkelsen's equation 25) and Blinn's approximation (blue).";
pub(super) const MIRRORED: &str = "Mirrors the map, left for right: the frames become left-handed, the relief stays.";
pub(super) const SLOPES: &str = "How slopes are taken from heights: the difference of the two neighbours, or that \
                                 smoothed across the slope by Sobel's kernels.";
pub(super) const EDGES: &str = "What lies beyond an edge of the map.";
pub(super) const KAPPA: &str = "How a lobe's concentration follows from its mean length: the exact inverse of \
                                A(kappa) = coth(kappa) - 1/kappa, or the papers' closed form, up to 5 % off.";
pub(super) const E_STEP: &str = "How normals are shared between lobes: by alpha times density, or by density alone as \
                                 Algorithm 1 is printed, an error.";
pub(super) const ALIGNMENT: &str =
    "How lobe j of neighbouring texels is made to mean the same thing, so that hardware may interpolate it.";
pub(super) const SELECTION: &str = "How many lobes a texel gets: J of them, or as few as a criterion is content with. The BRDF's error is that of \
     Blinn-Phong at s = 64; BIC is the Bayesian information criterion.";
pub(super) const OBJECTIVE: &str = "What each texel's own fit strives for. Appearance: the shaded look. EM: the papers' Algorithm 1. Likelihood: the \
     highest density, by splitting and merging lobes.";
pub(super) const MODEL: &str = "How the specular part depends on the angle between normal and half vector.";
pub(super) const CONVOLUTION: &str = "How the material is convolved with a lobe of concentration kappa. The closed rules are \
                                      Blinn-Phong's and that of the lobes which stand for GGX; Torrance-Sparrow has its \
                                      own (eq. 21).";
pub(super) const DIFFUSE_RULE: &str = "How much light falls on what a lobe stands for.";
/// What a choice of level is.
pub(super) fn level(choice: LevelChoice) -> &'static str {
    match choice {
        LevelChoice::Auto => {
            "Matched: the level at which trilinear interpolation blurs as much as the pixel does, half of log2(3) \
             finer than hardware's. The default: it measures best, for every method."
        }
        LevelChoice::Hardware => {
            "Hardware: the level whose texels are as wide as the pixel is long (Williams 1983), as samplers take it; \
             it blurs with three times the pixel's variance."
        }
        LevelChoice::Fixed(_) => "Fixed: one level everywhere.",
    }
}

/// What a convolution rule is.
pub(super) fn convolution(rule: ConvolutionRule) -> &'static str {
    match rule {
        ConvolutionRule::ShiftedExponent => {
            "s + 1: Blinn-Phong of s' + 1 = kappa (s + 1) / (kappa + s + 1), because its multipliers follow \
             exp(-l(l+1) / (2(s+1))). The default: of the closed forms it measures best."
        }
        ConvolutionRule::Moment => {
            "Moment: Blinn-Phong of s' = (2m - 1) / (1 - m) with m = A(kappa) (s + 1) / (s + 2), exact in the first \
             moment."
        }
        ConvolutionRule::Paper => "Paper: Blinn-Phong of s' = kappa s / (kappa + s) (Han et al. 2007, eq. 20).",
        ConvolutionRule::Exact => {
            "Exact: the convolution itself, sum over l of (2l + 1) / (4 pi) rho_l A_l(kappa) P_l(u), from a table."
        }
    }
}

/// What a diffuse rule is.
pub(super) fn diffuse(rule: DiffuseRule) -> &'static str {
    match rule {
        DiffuseRule::Cosine => {
            "Cosine: max(mu.w, 0) of the lobe's mean direction mu (Han et al. 2007, Algorithm 2), wrong for wide lobes \
             near the horizon."
        }
        DiffuseRule::Exact => {
            "Exact: the clamped cosine convolved with the lobe, sum over l of (2l + 1) / 4 rho_l A_l(kappa) P_l(mu.w), \
             rho_l = 1, 2/3, 1/4, 0, -1/24, ..., from a table."
        }
    }
}

pub(super) const HEIGHT_SCALE: Parameter = Parameter {
    name: "Height scale",
    range: [0.01, 100.0],
    default: MapOptions::HEIGHT_SCALE as f64,
    logarithmic: true,
    tooltip: "Texel widths from the lowest to the highest height.",
    ..PLAIN
};
pub(super) const LOBES: Parameter = Parameter {
    name: "Lobes J",
    range: [1.0, 16.0],
    default: 6.0,
    decimals: 0,
    tooltip: "Lobes per texel. Fewer are shown at once, merged from those at hand, until the fit is done.",
    ..PLAIN
};
pub(super) const MOST_LOBES: Parameter = Parameter {
    name: "Most lobes J",
    default: 16.0,
    tooltip: "Most lobes that a texel may get; most texels need fewer.",
    ..LOBES
};
pub(super) const BRDF_ERROR: Parameter = Parameter {
    name: "BRDF error",
    range: [0.1, 50.0],
    default: Selection::DEFAULT_PERCENT as f64,
    unit: " %",
    decimals: 1,
    logarithmic: true,
    tooltip: "A texel gets the fewest lobes whose effective Blinn-Phong at s = 64 is no farther from the truth.",
};
pub(super) const STEPS: Parameter = Parameter {
    name: "Refinement",
    range: [0.0, 10.0],
    default: Objective::DEFAULT_STEPS as f64,
    decimals: 0,
    tooltip: "Gauss-Newton steps on the distance between the shaded lobes and the shaded truth.",
    ..PLAIN
};
pub(super) const BLEND: Parameter = Parameter {
    name: "Neighbours b",
    range: [0.0, 0.9],
    default: Alignment::DEFAULT_BLEND as f64,
    tooltip: "The neighbours' share in the E-step; directions are left alone.",
    ..PLAIN
};
pub(super) const STRENGTH: Parameter = Parameter {
    name: "Alignment C",
    range: [0.0, 100.0],
    default: 1.0,
    logarithmic: true,
    tooltip: "Pull of the mean directions towards the neighbours' (Han et al. 2007, eq. 23; Mikkelsen 2008, \
              eq. 113).",
    ..PLAIN
};
pub(super) const ITERATIONS: Parameter = Parameter {
    name: "Iterations",
    range: [1.0, 400.0],
    default: 100.0,
    decimals: 0,
    logarithmic: true,
    tooltip: "The most EM iterations per texel; most texels stop earlier.",
    ..PLAIN
};
pub(super) const SPECULAR: Parameter = Parameter {
    name: "Specular Ks",
    range: [0.0, 2.0],
    default: MATERIAL.specular as f64,
    decimals: 3,
    tooltip: "Strength of the specular part.",
    ..PLAIN
};
pub(super) const DIFFUSE: Parameter = Parameter {
    name: "Diffuse Kd",
    range: [0.0, 2.0],
    default: MATERIAL.diffuse as f64,
    decimals: 3,
    tooltip: "Strength of the diffuse part.",
    ..PLAIN
};
pub(super) const DRYING_TIME: Parameter = Parameter {
    name: "Drying time",
    tooltip: "From 0, wet, to 1, dry: Ks, Kd and ln s go by wet + (dry - wet) (1 - exp(-3 t)) / (1 - exp(-3)).",
    ..PLAIN
};
pub(super) const FRESNEL: Parameter = Parameter {
    name: "Fresnel",
    default: MATERIAL.fresnel as f64,
    tooltip: "Strength 1 - F0 of Schlick's factor F0 + (1 - F0) (1 - l.h)^5 on the specular part; 0 is none. It does not \
              depend on the normal and is not filtered (Han et al. 2007, section 4.3).",
    ..PLAIN
};
pub(super) const LIGHT_AZIMUTH: Parameter = Parameter {
    name: "Light azimuth",
    range: [-180.0, 180.0],
    default: LIGHT.azimuth_deg as f64,
    unit: "°",
    decimals: 1,
    tooltip: "Where the selected light stands, from +x towards +y.",
    ..PLAIN
};
pub(super) const LIGHT_ELEVATION: Parameter = Parameter {
    name: "Light elevation",
    range: [-90.0, 90.0],
    default: LIGHT.elevation_deg as f64,
    unit: "°",
    decimals: 1,
    tooltip: "How high the selected light stands over the plane.",
    ..PLAIN
};
pub(super) const LIGHT_DISTANCE: Parameter = Parameter {
    name: "Light distance",
    range: [Light::MIN_DISTANCE as f64, Light::MAX_DISTANCE as f64],
    default: DEFAULT_LIGHT_DISTANCE as f64,
    logarithmic: true,
    tooltip: "From the surface's centre to the selected light, which falls off by the inverse square.",
    ..PLAIN
};
pub(super) const LIGHT_INTENSITY: Parameter = Parameter {
    name: "Light intensity",
    range: [0.0, 1000.0],
    default: LIGHT.intensity as f64,
    logarithmic: true,
    tooltip: "Factor on the light's colour; of a point light, at a distance of 1.",
    ..PLAIN
};
pub(super) const SWEEP_SPEED: Parameter = Parameter {
    name: "Sweep speed",
    range: [-180.0, 180.0],
    default: LightView::SWEEP_DEG_PER_S as f64,
    unit: "°/s",
    decimals: 0,
    tooltip: "How fast the selected light turns around the surface while the sweep plays.",
    ..PLAIN
};
pub(super) const SKY: &str = "Light from everywhere, for lobes as spherical harmonics (Han et al. 2007, section 8), for the \
                              truth by samples of the sky and of the material.";
pub(super) const SKY_FILE: &str = "A sky by latitude and longitude: Radiance HDR or OpenEXR, twice as wide as high.";
pub(super) const SKY_ROTATION: Parameter = Parameter {
    name: "Sky rotation",
    range: [-180.0, 180.0],
    unit: "°",
    decimals: 1,
    tooltip: "Turns the sky around the vertical.",
    ..PLAIN
};
pub(super) const SKY_INTENSITY: Parameter = Parameter {
    name: "Sky intensity",
    range: [0.0, 20.0],
    default: 1.0,
    logarithmic: true,
    tooltip: "Factor on the sky's radiance.",
    ..PLAIN
};
pub(super) const SKY_BANDS: Parameter = Parameter {
    name: "Sky bands l*",
    range: [0.0, MOST_BANDS as f64],
    default: Sky::LAST_BAND as f64,
    decimals: 0,
    tooltip: "The last band of the sky's specular light (Han et al. 2007, eq. 26): shiny materials need about \
              sqrt(4 s). The truth has them all.",
    ..PLAIN
};
pub(super) const SKY_SUN: &str = "The specular light of the sky's sun is that of a far light, for its bands ring; off, it \
                                  goes through the bands with the rest, as in the paper.";
pub(super) const TILING_U: Parameter = Parameter {
    name: "Tiling u",
    range: [0.25, 64.0],
    default: 2.0,
    logarithmic: true,
    tooltip: "How often the map repeats across the surface.",
    ..PLAIN
};
pub(super) const TILING_V: Parameter =
    Parameter { name: "Tiling v", tooltip: "How often the map repeats down the surface.", ..TILING_U };
pub(super) const FIXED_LEVEL: Parameter = Parameter {
    name: "Fixed level",
    tooltip: "The level that is read everywhere; between two levels both are blended.",
    ..PLAIN
};
pub(super) const ANISOTROPY: Parameter = Parameter {
    name: "Anisotropy",
    range: [1.0, MOST_PROBES as f64],
    default: 1.0,
    unit: "x",
    tooltip: "Most probes along the long axis of a pixel's footprint, each as wide as the short one. At grazing angles \
              one probe blurs too much.",
    ..PLAIN
};
pub(super) const EXPOSURE: Parameter = Parameter {
    name: "Exposure",
    range: [-8.0, 8.0],
    unit: " EV",
    decimals: 1,
    tooltip: "Stops: each doubles the picture's linear values.",
    ..PLAIN
};
pub(super) const RING_RADIUS: Parameter = Parameter {
    name: "Ring radius a",
    range: [0.1, 1.5],
    default: SHAPE_DEFAULT.radii[0] as f64,
    tooltip: "From the torus's middle to that of its tube.",
    ..PLAIN
};
pub(super) const TUBE_RADIUS: Parameter = Parameter {
    name: "Tube radius b",
    range: [0.02, 0.75],
    default: SHAPE_DEFAULT.radii[1] as f64,
    tooltip: "Of the torus's tube; always less than the ring's.",
    ..PLAIN
};
pub(super) const FRAME_THRESHOLD: Parameter = Parameter {
    name: "Threshold",
    range: [0.0, 180.0],
    default: 180.0,
    unit: "°",
    decimals: 0,
    tooltip: "Derivatives of neighbouring triangles further apart than this are not averaged; 180° averages whole groups.",
    ..PLAIN
};
pub(super) const NEEDLE_SCALE: Parameter = Parameter {
    name: "Relief lambda",
    range: [0.002, 1.0],
    default: NeedlesView::DEFAULT.scale as f64,
    decimals: 4,
    logarithmic: true,
    tooltip: "What a height of 1 is for the needles, in the surface's own units. Both normals part where height times \
              curvature is large.",
    ..PLAIN
};
pub(super) const SHEAR: Parameter = Parameter {
    name: "Shear",
    range: [-2.0, 2.0],
    tooltip: "How far each row of the tiled map is shifted sideways, per unit of height.",
    ..PLAIN
};
pub(super) const TURN: Parameter = Parameter {
    name: "Turn",
    range: [-180.0, 180.0],
    unit: "°",
    decimals: 1,
    tooltip: "Turns the texture coordinates counter-clockwise, after tiling and shear; the map turns the other way.",
    ..PLAIN
};
pub(super) const TRUTH_SAMPLES: Parameter = Parameter {
    name: "Truth samples",
    range: [16.0, 65536.0],
    default: Session::TRUTH_SAMPLES as f64,
    decimals: 0,
    logarithmic: true,
    tooltip: "Samples per pixel at which the truth is done. It starts anew only where its own picture changes; more \
              samples go on from those there are.",
    ..PLAIN
};

#[cfg(test)]
mod tests {
    use super::*;
    use crate::filter::vmf::FitSettings;
    use crate::lit_surface::LitSurface;

    #[test]
    fn a_reset_brings_back_what_a_new_session_has() {
        let surface = LitSurface::default();
        let fit = FitSettings::default();
        let light = surface.lights.as_slice()[0];
        let pairs = [
            (LOBES, fit.lobes as f64),
            (ITERATIONS, fit.iterations as f64),
            (BLEND, f64::from(Alignment::DEFAULT_BLEND)),
            (SPECULAR, f64::from(surface.material.specular)),
            (DIFFUSE, f64::from(surface.material.diffuse)),
            (FRESNEL, f64::from(surface.material.fresnel)),
            (LIGHT_AZIMUTH, f64::from(light.azimuth_deg)),
            (LIGHT_ELEVATION, f64::from(light.elevation_deg)),
            (LIGHT_INTENSITY, f64::from(light.intensity)),
            (TILING_U, f64::from(surface.shape.tiling[0])),
            (TILING_V, f64::from(surface.shape.tiling[1])),
            (EXPOSURE, f64::from(surface.exposure_stops)),
            (RING_RADIUS, f64::from(surface.shape.radii[0])),
            (TUBE_RADIUS, f64::from(surface.shape.radii[1])),
            (SHEAR, f64::from(surface.shape.shear)),
            (TURN, f64::from(surface.shape.turn_deg)),
        ];
        for (parameter, default) in pairs {
            assert!((parameter.default - default).abs() < 1e-6, "{}: {default}", parameter.name);
        }
    }
}
