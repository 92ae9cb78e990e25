// Twin of filter/rival.rs and filter/channels.rs: the entry point of every rival. The method's own file follows, with
// `fn shade(lookup: Lookup, lod: f32, light: LocalLight, material: Material) -> vec3f`.

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

@fragment
fn rival(point: Point) -> @location(0) vec4u {
    let lookup = lookup_of(point);
    let probes = probes_of(lookup, method.lods);
    var sum = vec3f(0.0);
    for (var index = 0u; index < frame.light_count; index++) {
        let incident = incident_light(point, index);
        for (var i = 0u; i < probes.count; i++) {
            var probe = lookup;
            probe.uv += probe_offset(probes, i);
            let reflected = shade(probe, probes.lod, incident.local, material());
            sum += incident.radiance * mean_color(probe, probes.lod) * reflected;
        }
    }
    return seen(sum / f32(probes.count));
}
