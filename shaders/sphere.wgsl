// The sphere of directions, drawn analytically: density and graticule, points, lobes. Twin: src/gpu/passes/sphere.rs.
// Every edge is antialiased by the exact gradient of what it is an edge of, so the picture is the same everywhere.
// Colours are sRGB codes already, premultiplied; the target is not an sRGB format.

struct LobeMark {
    mu_in_view: vec3f,
    // Cosine of the angle at which the lobe's density has fallen to exp(-1/2) of its peak.
    ring_cosine: f32,
    color: vec3f,
    weight: f32,
}

struct Sphere {
    view_from_tangent: mat3x3f,
    size_px: vec2f,
    // Radii of the sphere per pixel, and pixels per point of the interface.
    radii_per_px: f32,
    px_per_point: f32,
    density_peak: f32,
    // Decades below the peak that the scale covers; 0 for a linear scale.
    log_decades: f32,
    density_shown: u32,
    lobe_count: u32,
    heat: array<vec4f, 9>,
    lobes: array<LobeMark, 16>,
}

@group(0) @binding(0) var<uniform> sphere: Sphere;
@group(0) @binding(1) var density_grid: texture_2d<f32>;

const BARE = vec3f(0.145, 0.153, 0.172);
const BELOW = vec3f(0.086, 0.094, 0.110);
const LINE = vec3f(0.80, 0.84, 0.90);
const SHADOW = vec3f(0.02, 0.02, 0.03);

// What control flow depends on comes from the vertices and not from the uniforms: Mesa 22's software rasteriser compiles
// a shader anew in every pass, and keeps it, where uniforms alone decide a branch.
struct DiscVertex {
    @builtin(position) position: vec4f,
    // Position in radii of the sphere, y up.
    @location(0) in_disc: vec2f,
    @location(1) @interpolate(flat) lobe_count: u32,
    @location(2) @interpolate(flat) density_shown: u32,
    @location(3) @interpolate(flat) log_decades: f32,
}

@vertex
fn cover(@builtin(vertex_index) index: u32) -> DiscVertex {
    let corner = vec2f(f32(index & 1u) * 4.0 - 1.0, f32(index >> 1u) * 4.0 - 1.0);
    let in_disc = corner * 0.5 * sphere.size_px * sphere.radii_per_px;
    return DiscVertex(vec4f(corner, 0.0, 1.0), in_disc, sphere.lobe_count, sphere.density_shown, sphere.log_decades);
}

fn over(top: vec4f, bottom: vec4f) -> vec4f {
    return top + bottom * (1.0 - top.a);
}

fn ink(color: vec3f, coverage: f32) -> vec4f {
    return vec4f(color, 1.0) * coverage;
}

// Signed distance in pixels, positive inside, from the circle of directions at `cosine` around `axis`.
// d(n.axis)/dp follows from n = (p, sqrt(1 - p.p)).
fn circle_distance_px(in_disc: vec2f, height: f32, axis: vec3f, cosine: f32) -> f32 {
    let gradient = axis.xy - axis.z * in_disc / max(height, 1e-3);
    let value = dot(vec3f(in_disc, height), axis) - cosine;
    return value / max(length(gradient) * sphere.radii_per_px, 1e-9);
}

fn line_coverage(distance_px: f32, width_points: f32) -> f32 {
    return clamp(0.5 * width_points * sphere.px_per_point + 0.5 - abs(distance_px), 0.0, 1.0);
}

fn octahedral_from_direction(direction: vec3f) -> vec2f {
    let flat_direction = direction / (abs(direction.x) + abs(direction.y) + abs(direction.z));
    let side = select(vec2f(-1.0), vec2f(1.0), flat_direction.xy >= vec2f(0.0));
    let folded = (1.0 - abs(flat_direction.yx)) * side;
    return select(folded, flat_direction.xy, flat_direction.z >= 0.0) * 0.5 + 0.5;
}

// A cell of the grid; beyond an edge the square is folded onto itself, mirrored about the edge's middle.
fn cell(at: vec2i, size: vec2i) -> f32 {
    var inside = at;
    if at.x < 0 || at.x >= size.x {
        inside = vec2i(clamp(at.x, 0, size.x - 1), size.y - 1 - at.y);
    }
    if inside.y < 0 || inside.y >= size.y {
        inside = vec2i(size.x - 1 - inside.x, clamp(inside.y, 0, size.y - 1));
    }
    return textureLoad(density_grid, inside, 0).r;
}

fn density(direction_in_tangent: vec3f) -> f32 {
    let size = vec2i(textureDimensions(density_grid));
    let position = octahedral_from_direction(direction_in_tangent) * vec2f(size) - 0.5;
    let first = vec2i(floor(position));
    let blend = position - floor(position);
    let upper = mix(cell(first, size), cell(first + vec2i(1, 0), size), blend.x);
    let lower = mix(cell(first + vec2i(0, 1), size), cell(first + vec2i(1, 1), size), blend.x);
    return mix(upper, lower, blend.y);
}

fn heat(t: f32) -> vec3f {
    let stop = color_stop(t);
    return mix(sphere.heat[stop.index].rgb, sphere.heat[stop.index + 1u].rgb, stop.blend);
}

fn density_color(direction_in_tangent: vec3f, log_decades: f32) -> vec3f {
    let relative = density(direction_in_tangent) / sphere.density_peak;
    if log_decades == 0.0 {
        return heat(relative);
    }
    return heat(1.0 + log2(max(relative, 1e-30)) / (3.3219281 * log_decades));
}

@fragment
fn surface(vertex: DiscVertex) -> @location(0) vec4f {
    let radius = length(vertex.in_disc);
    let edge = clamp((1.0 - radius) / sphere.radii_per_px + 0.5, 0.0, 1.0);
    if edge == 0.0 {
        return vec4f(0.0);
    }
    let in_disc = vertex.in_disc * min(1.0, 0.99999 / radius);
    let height = sqrt(max(1.0 - dot(in_disc, in_disc), 0.0));
    let direction = transpose(sphere.view_from_tangent) * vec3f(in_disc, height);
    var color = mix(BELOW, BARE, clamp(0.5 + direction.z * 60.0, 0.0, 1.0));
    if vertex.density_shown != 0u {
        let shown = density_color(direction, vertex.log_decades);
        color = mix(mix(BELOW, shown, 0.6), shown, f32(direction.z >= 0.0));
    }
    let axis = sphere.view_from_tangent * vec3f(0.0, 0.0, 1.0);
    let horizon = line_coverage(circle_distance_px(in_disc, height, axis, 0.0), 1.2) * 0.55;
    let parallels = max(
        line_coverage(circle_distance_px(in_disc, height, axis, 0.8660254), 1.0),
        line_coverage(circle_distance_px(in_disc, height, axis, 0.5), 1.0));
    let meridians = max(
        line_coverage(circle_distance_px(in_disc, height, sphere.view_from_tangent * vec3f(1.0, 0.0, 0.0), 0.0), 1.0),
        line_coverage(circle_distance_px(in_disc, height, sphere.view_from_tangent * vec3f(0.0, 1.0, 0.0), 0.0), 1.0));
    let rim = line_coverage((1.0 - radius) / sphere.radii_per_px - 0.5, 1.0) * 0.45;
    let lines = max(max(horizon, rim), max(parallels * 0.26, meridians * 0.16));
    return vec4f(mix(color, LINE, lines), 1.0) * edge;
}

struct PointVertex {
    @builtin(position) position: vec4f,
    // Pixels from the point's centre.
    @location(0) offset_px: vec2f,
    @location(1) radius_px: f32,
}

@vertex
fn place_point(@builtin(vertex_index) index: u32, @location(0) point_and_radius: vec4f) -> PointVertex {
    let in_view = sphere.view_from_tangent * point_and_radius.xyz;
    let radius_px = point_and_radius.w * sphere.px_per_point;
    let corner = vec2f(f32(index & 1u), f32(index >> 1u)) * 2.0 - 1.0;
    let offset_px = corner * (radius_px + 1.5);
    let at_px = in_view.xy / sphere.radii_per_px + offset_px;
    // Behind the horizon: out of the clip volume.
    let position = select(vec4f(2.0, 2.0, 2.0, 1.0), vec4f(at_px * 2.0 / sphere.size_px, 0.0, 1.0), in_view.z >= 0.0);
    return PointVertex(position, offset_px, radius_px);
}

@fragment
fn draw_point(vertex: PointVertex) -> @location(0) vec4f {
    let distance_px = length(vertex.offset_px);
    let dot_coverage = clamp(vertex.radius_px + 0.5 - distance_px, 0.0, 1.0);
    let shadow = clamp(vertex.radius_px + min(vertex.radius_px, 1.0) + 0.3 - distance_px, 0.0, 1.0);
    return over(ink(vec3f(0.93, 0.95, 1.0), dot_coverage * 0.75), ink(SHADOW, shadow * 0.35));
}

fn ring(in_disc: vec2f, height: f32, lobe: LobeMark) -> vec4f {
    let distance_px = circle_distance_px(in_disc, height, lobe.mu_in_view, lobe.ring_cosine);
    let inside = ink(lobe.color, clamp(distance_px + 0.5, 0.0, 1.0) * 0.16);
    let shadow = ink(SHADOW, line_coverage(distance_px, 4.4) * 0.55);
    return over(ink(lobe.color, line_coverage(distance_px, 2.2)), over(shadow, inside));
}

// The tip of a lobe's pin, in radii: its length above the sphere reads as the weight.
fn pin_tip(lobe: LobeMark) -> vec2f {
    return lobe.mu_in_view.xy * (1.02 + 0.16 * lobe.weight);
}

fn segment_distance(point: vec2f, a: vec2f, b: vec2f) -> f32 {
    let along = b - a;
    let t = clamp(dot(point - a, along) / max(dot(along, along), 1e-12), 0.0, 1.0);
    return length(point - a - t * along);
}

fn pin(at: vec2f, lobe: LobeMark) -> vec4f {
    let tip = pin_tip(lobe);
    let shaft_px = segment_distance(at, lobe.mu_in_view.xy, tip) / sphere.radii_per_px;
    let head_px = length(at - tip) / sphere.radii_per_px - (1.8 + 4.2 * sqrt(lobe.weight)) * sphere.px_per_point;
    let shape = max(line_coverage(shaft_px, 2.2), clamp(0.5 - head_px, 0.0, 1.0));
    let shadow = max(line_coverage(shaft_px, 4.4), clamp(0.5 + sphere.px_per_point - head_px, 0.0, 1.0));
    return over(ink(lobe.color, shape), ink(SHADOW, shadow * 0.8));
}

@fragment
fn draw_lobes(vertex: DiscVertex) -> @location(0) vec4f {
    var color = vec4f(0.0);
    let radius = length(vertex.in_disc);
    let height = sqrt(max(1.0 - radius * radius, 0.0));
    if radius < 1.0 {
        for (var i = 0u; i < vertex.lobe_count; i++) {
            color = over(ring(vertex.in_disc, height, sphere.lobes[i]), color);
        }
    }
    for (var i = 0u; i < vertex.lobe_count; i++) {
        if sphere.lobes[i].mu_in_view.z >= 0.0 {
            color = over(pin(vertex.in_disc, sphere.lobes[i]), color);
        }
    }
    return color;
}
