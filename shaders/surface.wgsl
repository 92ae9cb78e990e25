// The lit surface and its truth; the entry points of lobes follow in shared/lobes.wgsl, the other methods' in
// shared/rival.wgsl. Radiance in linear light, before exposure, alpha 1 where it is seen.
// `truth` takes its samples into the mean so far; the others are whole pictures. The floats are written bit for bit into
// targets of unsigned integers, which every adapter can draw to; GL often cannot draw to 32-bit floats.

struct Frame {
    clip_from_world: mat4x4f,
    eye_in_world: vec3f,
    fixed_level: f32,
    uv_from_surface: mat2x2f,
    base_size: vec2f,
    vmf_lods: vec2f,
    base_level: f32,
    lobe_level: f32,
    lobes: u32,
    wraps: u32,
    first_sample: u32,
    sample_count: u32,
    level_choice: u32,
    most_probes: u32,
    light_count: u32,
    reconstruction: u32,
    bump: u32,
    bump_scale: f32,
    rise: vec2f,
    lamp_count: u32,
    padding: u32,
    fold: array<vec4u, 4>,
    lights: array<Light, 9>,
}

// Where a light stands, in homogeneous coordinates, its radiance, at a distance of 1 where it has one, and a factor on
// what it lights diffusely: 0 for the sun, which stands behind the lamps.
struct Light {
    position_in_world: vec4f,
    radiance: vec3f,
    diffuse: f32,
}

// A pipeline is made for what it is asked for: software adapters run both sides of every branch.
// Whether the map has colour.
override COLORED: bool = false;
// Whether a rule needs the tables.
override EXACT_RULES: bool = false;
// Whether a sky lights the surface.
override SKY: bool = false;

// Weights below this are an empty slot (sphere/mixture.rs).
const EMPTY_WEIGHT: f32 = 1e-7;
// Slots at most (sphere/mixture.rs).
const MAX_LOBES: u32 = 16u;
// A derivative's length counts as this at least (scene/mesh.rs).
const LEAST_DERIVATIVE: f32 = 1e-6;

@group(0) @binding(0) var<uniform> frame: Frame;
// Exact convolutions, a layer per model; empty where no rule asks for them.
@group(0) @binding(1) var exact_tables: texture_2d_array<f32>;

// Mean normals of every level; the first level holds the map's own normals, zero where they are invalid, and heights.
@group(1) @binding(0) var means: texture_2d<f32>;
// The slot of each base texel's only lobe.
@group(1) @binding(1) var base_slots: texture_2d<u32>;
// Stored lobes, a layer per slot, from level 1 upward.
@group(1) @binding(2) var lobes: texture_2d_array<f32>;
// Mean colours of every level, and the lobes' stored colours alpha y; one texel each but where `COLORED`.
@group(1) @binding(3) var mean_colors: texture_2d<f32>;
@group(1) @binding(4) var lobe_colors: texture_2d_array<f32>;
@group(1) @binding(5) var trilinear: sampler;

// The mean of the truth's samples so far.
@group(2) @binding(0) var mean_so_far: texture_2d<u32>;

struct Corner {
    @location(0) position_in_world: vec3f,
    @location(1) normal_in_world: vec3f,
    // Derivatives by u and, up the image, by v: a unit vector and its length.
    @location(2) along_u: vec4f,
    @location(3) along_t: vec4f,
    @location(4) uv: vec2f,
    // The Weingarten matrix by u and t, by columns.
    @location(5) bend: vec4f,
}

struct Point {
    @builtin(position) position: vec4f,
    @location(0) position_in_world: vec3f,
    @location(1) tangent_in_world: vec3f,
    @location(2) bitangent_in_world: vec3f,
    @location(3) normal_in_world: vec3f,
    @location(4) uv: vec2f,
    // Depth along the view. The built-in position's fourth component is its inverse on some backends only.
    @location(5) w: f32,
    // What a relief bumps: how far the surface goes by texture coordinates, and how it bends.
    @location(6) stretch: vec2f,
    @location(7) shape_operator: vec4f,
}

@vertex
fn vertex(corner: Corner) -> Point {
    let position = frame.clip_from_world * vec4f(corner.position_in_world, 1.0);
    let tangents = tangents_of(corner);
    return Point(
        position,
        corner.position_in_world,
        tangents[0],
        tangents[1],
        corner.normal_in_world,
        frame.uv_from_surface * corner.uv,
        position.w,
        stretch_of(corner),
        shape_operator_of(corner),
    );
}

// The map's rows and columns at a vertex: the twin of Vertex::tangents (scene/mesh.rs).
fn tangents_of(corner: Corner) -> array<vec3f, 2> {
    let along_u = corner.along_u.xyz * max(corner.along_u.w, LEAST_DERIVATIVE);
    let along_t = corner.along_t.xyz * max(corner.along_t.w, LEAST_DERIVATIVE);
    let m = frame.uv_from_surface;
    let orientation = select(1.0, -1.0, determinant(m) < 0.0);
    return array<vec3f, 2>(
        normalize_or_zero(orientation * (m[1].y * along_u + m[0].y * along_t)),
        normalize_or_zero(orientation * (m[1].x * along_u + m[0].x * along_t)),
    );
}

// The material as it reflects this light.
fn material_towards(incident: Incident) -> Material {
    var material = with_factor(incident.unfiltered);
    material.diffuse *= incident.diffuse;
    return material;
}

// Fine derivatives, explicitly: the coarse ones may leave out half the quad, and the processor's twin takes these.
fn lookup_of(point: Point) -> Lookup {
    return Lookup(point.uv, dpdxFine(point.uv), dpdyFine(point.uv), vec2u(point.position.xy));
}

// The derivatives at the pixel's centre from those between two pixels of the quad, one of which it is: a step of one
// pixel to the other, o = 1 or -1, changes uv by d o / (1 + g o).
fn footprint_of(point: Point, lookup: Lookup) -> PixelFootprint {
    let nearness = 1.0 / point.w;
    let perspective = vec2f(dpdxFine(nearness), dpdyFine(nearness)) * point.w;
    let to_other = 1.0 - 2.0 * vec2f(lookup.pixel & vec2u(1u));
    let stretch = 1.0 + to_other * perspective;
    return PixelFootprint(stretch.x * lookup.uv_dx, stretch.y * lookup.uv_dy, perspective);
}

// What a light gives at the pixel's point, and the material's factor for it.
struct Incident {
    local: LocalLight,
    radiance: vec3f,
    unfiltered: vec3f,
    diffuse: f32,
}

// The least squared distance that is told apart (lighting/light.rs).
const LEAST_SQUARED: f32 = 1e-4;

var<private> incident: array<Incident, 9>;

// Works out what each light, and the sky, gives at the pixel's point.
fn gather_light(point: Point) {
    for (var index = 0u; index < frame.light_count; index++) {
        incident[index] = incident_light(point, index);
    }
    let own = world_from_tangent(point);
    var all = world_from_map(point, own);
    if frame.bump != 0u {
        all = bumped(point, own);
    }
    tangent_from_map = transpose(own) * all;
    if SKY {
        set_local_sky(all, normalize_or_zero(frame.eye_in_world - point.position_in_world));
    }
}

fn incident_light(point: Point, index: u32) -> Incident {
    let light = frame.lights[index];
    let to_light = light.position_in_world.xyz - light.position_in_world.w * point.position_in_world;
    let squared = max(dot(to_light, to_light), LEAST_SQUARED);
    let local = local_light(point, normalize_or_zero(to_light));
    let difference_cosine = dot(local.light_in_tangent, local.half_in_tangent);
    return Incident(local, light.radiance / squared, unfiltered(difference_cosine), light.diffuse);
}

fn local_light(point: Point, light_in_world: vec3f) -> LocalLight {
    let frame_in_world = world_from_tangent(point);
    let to_eye = normalize_or_zero(frame.eye_in_world - point.position_in_world);
    let sum = to_eye + light_in_world;
    let half = select(frame_in_world[2], normalize_or_zero(sum), dot(sum, sum) > 1e-30);
    // Columns are the frame's axes, so multiplying from the right takes world to tangent space.
    return LocalLight(light_in_world * frame_in_world, half * frame_in_world);
}

// The mean colour of a texel; white where the map has no colour.
fn color_at(texel: vec2i) -> vec3f {
    if COLORED {
        return textureLoad(mean_colors, texel, 0).rgb;
    }
    return vec3f(1.0);
}

// The texel of a seen surface.
fn seen(color: vec3f) -> vec4u {
    return bitcast<vec4u>(vec4f(color, 1.0));
}

// What a normal reflects of every lamp and, by one sample, of the sky with its sun.
fn reflect_all(normal: vec3f, pixel: vec2u, index: u32) -> vec3f {
    let in_tangent = turned(normal);
    var sum = vec3f(0.0);
    for (var light = 0u; light < frame.lamp_count; light++) {
        let local = incident[light].local;
        let material = material_towards(incident[light]);
        let specular = specular_at(material, dot(in_tangent, local.half_in_tangent));
        sum += incident[light].radiance * reflect(material, specular, dot(in_tangent, local.light_in_tangent));
    }
    if SKY {
        sum += sample_sky(normal, pixel, index);
    }
    return sum;
}

@fragment
fn truth(point: Point) -> @location(0) vec4u {
    let lookup = lookup_of(point);
    let footprint = footprint_of(point, lookup);
    gather_light(point);
    let size = vec2i(textureDimensions(means));
    var sum = vec3f(0.0);
    for (var i = 0u; i < frame.sample_count; i++) {
        let index = frame.first_sample + i;
        let uv = lookup.uv + uv_step(footprint, jitter(lookup.pixel, index));
        let texel = vec2i(
            nearest_texel(uv.x, size.x, frame.wraps != 0u),
            nearest_texel(uv.y, size.y, frame.wraps != 0u),
        );
        // Unit already, but where the map's finest levels are left out and these are means.
        let normal = normalize_or_zero(textureLoad(means, texel, 0).xyz);
        sum += color_at(texel) * reflect_all(normal, lookup.pixel, index);
    }
    // A running mean keeps its digits; a sum of 65536 samples would lose four of its seven.
    let mean = bitcast<vec3f>(textureLoad(mean_so_far, vec2i(lookup.pixel), 0).rgb);
    let share = f32(frame.sample_count) / f32(frame.first_sample + frame.sample_count);
    return seen(mean + share * (sum / f32(frame.sample_count) - mean));
}

// The pixel's view of the map, with the light that a method shades it by.
fn look_at(point: Point) -> Lookup {
    let lookup = lookup_of(point);
    gather_light(point);
    if SKY {
        fetch_sky_light();
    }
    return lookup;
}

// The mean colour around a point; white where the map has no colour.
fn mean_color(lookup: Lookup, lod: f32) -> vec3f {
    if COLORED {
        return textureSampleLevel(mean_colors, trilinear, lookup.uv, lod - frame.base_level).rgb;
    }
    return vec3f(1.0);
}

// The probes that read the pixel, at levels within `lods`.
fn probes_of(lookup: Lookup, lods: vec2f) -> Probes {
    let rule = LevelRule(frame.level_choice, frame.fixed_level, frame.most_probes);
    return probes(rule, lookup.uv_dx, lookup.uv_dy, frame.base_size, lods);
}
