// Twin of filter/rival.rs and filter/channels.rs: the entry point of every rival. The method's own file follows, with
// `fn shade(lookup: Lookup, lod: f32, light: LocalLight, material: Material) -> vec3f` and, for the sky,
// `fn ndf_lobe_count() -> u32` and `fn ndf_lobe(lookup: Lookup, lod: f32, index: u32) -> NdfLobe`.

struct Rival {
    // Levels that may be read.
    lods: vec2f,
    // The map's level that the channels begin with.
    first_level: f32,
    // The number that the method's name carries.
    parameter: u32,
}

@group(2) @binding(0) var<uniform> method: Rival;
// The method's channels, four to a layer; one texel where it has none.
@group(2) @binding(1) var channels: texture_2d_array<f32>;

// The mean normal around a point, not normalised.
fn mean_normal(lookup: Lookup, lod: f32) -> vec3f {
    return textureSampleLevel(means, trilinear, lookup.uv, lod - frame.base_level).xyz;
}

// Four channels around a point.
fn channel_layer(lookup: Lookup, lod: f32, layer: u32) -> vec4f {
    return textureSampleLevel(channels, trilinear, lookup.uv, layer, lod - method.first_level);
}

// What the map reflects around a point of every light and of the sky, before its colour.
fn reflect_around(lookup: Lookup, lod: f32) -> vec3f {
    var mean = vec3f(0.0);
    if normals_turn() {
        mean = mean_normal(lookup, lod);
    }
    var sum = vec3f(0.0);
    for (var light = 0u; light < frame.light_count; light++) {
        let local = as_seen_from(mean, incident[light].local);
        sum += incident[light].radiance * shade(lookup, lod, local, material_towards(incident[light]));
    }
    if SKY {
        for (var index = 0u; index < ndf_lobe_count(); index++) {
            let lobe = ndf_lobe(lookup, lod, index);
            if lobe.weight > 0.0 {
                sum += shade_sky(lobe);
            }
        }
    }
    return sum;
}

@fragment
fn rival(point: Point) -> @location(0) vec4u {
    let lookup = look_at(point);
    let probes = probes_of(lookup, method.lods);
    var sum = vec3f(0.0);
    for (var i = 0u; i < probes.count; i++) {
        var probe = lookup;
        probe.uv += probe_offset(probes, i);
        sum += mean_color(probe, probes.lod) * reflect_around(probe, probes.lod);
    }
    return seen(sum / f32(probes.count));
}
