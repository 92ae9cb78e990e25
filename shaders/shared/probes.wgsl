// Twin of filter/probes.rs.

const MATCHED: u32 = 0u;
const HARDWARE: u32 = 1u;
// Below this a length in base texels counts as none.
const LEAST_LENGTH: f32 = 1e-12;

// How the levels are read.
struct LevelRule {
    choice: u32,
    fixed_level: f32,
    most_probes: u32,
}

// The probes of one pixel: the level of each, how many, and from one to the next in texture coordinates.
struct Probes {
    lod: f32,
    count: u32,
    step: vec2f,
}

// Where a probe stands from the pixel's centre.
fn probe_offset(probes: Probes, index: u32) -> vec2f {
    return (f32(index) - 0.5 * f32(probes.count - 1u)) * probes.step;
}

fn probes(rule: LevelRule, uv_dx: vec2f, uv_dy: vec2f, base: vec2f, range: vec2f) -> Probes {
    var result = Probes(rule.fixed_level, 1u, vec2f(0.0));
    if rule.choice == MATCHED {
        result = matched(uv_dx * base, uv_dy * base, rule.most_probes, range.x);
    } else if rule.choice == HARDWARE {
        result = hardware(uv_dx * base, uv_dy * base, rule.most_probes, range.x);
    }
    result.lod = clamp(result.lod, range.x, range.y);
    result.step /= base;
    return result;
}

// Probes whose kernels have the pixel's variance along both axes; the step in base texels.
fn matched(dx: vec2f, dy: vec2f, most: u32, finest: f32) -> Probes {
    let xx = (dx.x * dx.x + dy.x * dy.x) / 12.0;
    let xy = (dx.x * dx.y + dy.x * dy.y) / 12.0;
    let yy = (dx.y * dx.y + dy.y * dy.y) / 12.0;
    let mean = 0.5 * (xx + yy);
    let half = 0.5 * (xx - yy);
    let apart = sqrt(half * half + xy * xy);
    let long = max(mean + apart, LEAST_LENGTH);
    let short = max(mean - apart, LEAST_LENGTH);
    let count = probes_for(sqrt(long / short), most, lod_of(long) > finest);
    let of_each = select(max(short, long / f32(count * count)), long, count == 1u);
    // Evenly spaced points a step apart have variance (count^2 - 1) / 12 step^2.
    let step = sqrt(12.0 * max(long - of_each, 0.0) / f32(max(count * count - 1u, 1u)));
    // atan2(0, 0) is not defined; a round footprint has no long axis.
    let angle = select(0.0, 0.5 * atan2(xy, half), apart > 0.0);
    return Probes(lod_of(of_each), count, step * vec2f(cos(angle), sin(angle)));
}

fn lod_of(variance: f32) -> f32 {
    return 0.5 * log2(4.0 * variance);
}

// The probes of EXT_texture_filter_anisotropic; the step in base texels.
fn hardware(dx: vec2f, dy: vec2f, most: u32, finest: f32) -> Probes {
    let right_is_longer = dot(dx, dx) >= dot(dy, dy);
    let long = select(dy, dx, right_is_longer);
    let short = select(dx, dy, right_is_longer);
    let span = max(length(long), LEAST_LENGTH);
    let count = probes_for(span / max(length(short), LEAST_LENGTH), most, log2(span) > finest);
    return Probes(log2(span / f32(count)), count, long / f32(count + 1u));
}

// A probe for each time that the long axis holds the short one; one where the finest level there is suffices.
fn probes_for(ratio: f32, most: u32, is_minified: bool) -> u32 {
    return select(1u, max(u32(min(ceil(ratio), f32(most))), 1u), is_minified);
}
