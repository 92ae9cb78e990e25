// Twin of filter/sky_light.rs, and of what it reads: lighting/environment.rs, lighting/sky_harmonics.rs.

// The sky by latitude and longitude: linear RGB, and the density of the samples.
@group(3) @binding(0) var sky_texels: texture_2d<f32>;
// Unit vectors of that density, 128 to a row.
@group(3) @binding(1) var sky_samples: texture_2d<f32>;
// Harmonics of the diffuse light, one to a texel.
@group(3) @binding(2) var sky_diffuse: texture_2d<f32>;
// Harmonics of the specular light, one to a layer, over directions to the eye by azimuth and polar angle.
@group(3) @binding(3) var sky_views: texture_2d_array<f32>;
@group(3) @binding(4) var sky_sampler: sampler;
@group(3) @binding(5) var<uniform> sky: Sky;

struct Sky {
    // Turns the world's x and y into the sky's: cosine, sine.
    turn: vec2f,
    intensity: f32,
    // The last band of the specular light that is used.
    last_band: u32,
    // What a band of the light becomes: the material's multiplier times its colour.
    specular_bands: array<vec4f, 13>,
    diffuse_bands: array<vec4f, 9>,
}

const DIFFUSE_BAND: u32 = 8u;
const MOST_BANDS: u32 = 12u;
// Harmonics to MOST_BANDS; those of the diffuse light stand behind them.
const SPECULAR_TERMS: u32 = 169u;
const SKY_SAMPLES: u32 = 16384u;
const SKY_STEP = vec2u(2700274806u, 2313257605u);
const LEAST_COSINE: f32 = 1e-4;

// Normals that point about alike, as a method keeps them.
struct NdfLobe {
    weight: f32,
    mean_direction: vec3f,
    concentration: f32,
}

// All normals alike; a vector that is no unit vector counts by its length.
fn lobe_of_normal(normal: vec3f) -> NdfLobe {
    let weight = length(normal);
    return NdfLobe(weight, normal / max(weight, 1e-12), KAPPA_DELTA);
}

// The lobe of this mean vector, of weight 1.
fn lobe_of_mean(mean: vec3f) -> NdfLobe {
    let length = length(mean);
    return NdfLobe(1.0, mean / max(length, 1e-12), concentration(1.0 - length));
}

// The sky at the pixel's point.
struct LocalSky {
    // Takes the map's normals to the sky's frame, up to their length.
    sky_from_map: mat3x3f,
    to_eye: vec3f,
}

var<private> local_sky: LocalSky;
// What each harmonic of the light becomes, the specular ones first.
var<private> sky_light: array<vec3f, 250>;

// Radiance and density of the texel in a direction.
fn sky_texel(direction: vec3f) -> vec4f {
    let size = textureDimensions(sky_texels);
    let texel = min(vec2u(lat_long(direction) * vec2f(size)), size - 1u);
    return textureLoad(sky_texels, texel, 0);
}

// Sets up the sky at a point that is seen along `to_eye`; the matrix takes the map's normals to the surface's.
fn set_local_sky(world_from_map: mat3x3f, to_eye_in_world: vec3f) {
    let axes = mat3x3f(
        sky_from_world(sky.turn, world_from_map[0]),
        sky_from_world(sky.turn, world_from_map[1]),
        sky_from_world(sky.turn, world_from_map[2]),
    );
    local_sky = LocalSky(axes, sky_from_world(sky.turn, to_eye_in_world));
}

// Fetches what lobes are shaded with.
fn fetch_sky_light() {
    let eye = local_sky.to_eye;
    let is_pole = abs(eye.x) + abs(eye.y) == 0.0;
    let azimuth = atan2(eye.y, select(eye.x, 1.0, is_pole));
    let at = vec2f(azimuth / (2.0 * SKY_PI), acos(clamp(eye.z, -1.0, 1.0)) / SKY_PI);
    var index = 0u;
    for (var m = 0u; m <= sky.last_band; m++) {
        let sides = min(m, 1u) + 1u;
        for (var l = m; l <= sky.last_band; l++) {
            for (var side = 0u; side < sides; side++) {
                let light = textureSampleLevel(sky_views, sky_sampler, at, index, 0.0).rgb;
                sky_light[index] = light * sky.specular_bands[l].rgb;
                index++;
            }
        }
        index += sides * (MOST_BANDS - sky.last_band);
    }
    index = 0u;
    for (var m = 0u; m <= DIFFUSE_BAND; m++) {
        let sides = min(m, 1u) + 1u;
        for (var l = m; l <= DIFFUSE_BAND; l++) {
            for (var side = 0u; side < sides; side++) {
                let light = textureLoad(sky_diffuse, vec2u(index, 0u), 0).rgb;
                sky_light[SPECULAR_TERMS + index] = light * sky.diffuse_bands[l].rgb;
                index++;
            }
        }
    }
}

// The direction in the frame that is turned half way from +z to `to_eye`.
fn half_way(to_eye: vec3f, direction: vec3f) -> vec3f {
    let sum = to_eye + vec3f(0.0, 0.0, 1.0);
    let axis = select(vec3f(1.0, 0.0, 0.0), normalize_or_zero(sum), dot(sum, sum) > 1e-30);
    let turn = vec3f(axis.y, -axis.x, 0.0);
    let moved = cross(turn, direction);
    return direction + moved + cross(turn, moved) / (1.0 + axis.z);
}

// A_l(kappa) for l <= MOST_BANDS (sphere/harmonics.rs).
fn lobe_zonal(kappa: f32) -> array<f32, 13> {
    var zonal = array<f32, 13>();
    let start = f32(MOST_BANDS) + 9.0;
    var ratio = kappa / (start + 1.0 + sqrt((start + 2.0) * (start + 2.0) + kappa * kappa));
    for (var l = i32(MOST_BANDS) + 8; l >= 0; l--) {
        ratio = kappa / (f32(2 * l + 3) + kappa * ratio);
        if l < i32(MOST_BANDS) {
            zonal[l + 1] = ratio;
        }
    }
    zonal[0] = 1.0;
    for (var l = 1u; l <= MOST_BANDS; l++) {
        zonal[l] *= zonal[l - 1u];
    }
    return zonal;
}

// The normalised Legendre function of l > m from those of l - 1 and l - 2.
fn legendre_up(l: f32, m: f32, z: f32, last: f32, second_last: f32) -> f32 {
    let k = (l - 1.0) * (l - 1.0);
    let a = sqrt((4.0 * l * l - 1.0) / (l * l - m * m));
    // 0 where l = m + 1.
    let b = sqrt(max(k - m * m, 0.0) / (4.0 * k - 1.0 + select(0.0, 2.0, k == 0.0)));
    return a * (z * last - b * second_last);
}

// sum_lm zonal_l light_lm Y_lm(direction) for l <= last, of light that stands from `first` on and goes to band `most`.
fn sky_series(first: u32, most: u32, last: u32, zonal: array<f32, 13>, direction: vec3f) -> vec3f {
    var a = zonal;
    var diagonal = sqrt(0.25 / SKY_PI);
    var cosine = 1.0;
    var sine = 0.0;
    var sum = vec3f(0.0);
    var index = first;
    for (var m = 0u; m <= last; m++) {
        if m > 0u {
            diagonal *= sqrt(f32(2u * m + 1u) / f32(2u * m));
            let turned = cosine * direction.x - sine * direction.y;
            sine = sine * direction.x + cosine * direction.y;
            cosine = turned;
        }
        var previous = 0.0;
        var current = diagonal;
        for (var l = m; l <= last; l++) {
            if l > m {
                let next = legendre_up(f32(l), f32(m), direction.z, current, previous);
                previous = current;
                current = next;
            }
            if m == 0u {
                sum += a[l] * current * sky_light[index];
                index++;
            } else {
                let pair = cosine * sky_light[index] + sine * sky_light[index + 1u];
                sum += a[l] * sqrt(2.0) * current * pair;
                index += 2u;
            }
        }
        index += (min(m, 1u) + 1u) * (most - last);
    }
    return sum;
}

// What a lobe of normals reflects of the sky, linear RGB (Han et al. 2007, eq. 25 and 26).
fn shade_sky(lobe: NdfLobe) -> vec3f {
    let mu = normalize_or_zero(local_sky.sky_from_map * lobe.mean_direction);
    let zonal = lobe_zonal(lobe.concentration);
    let diffuse = sky_series(SPECULAR_TERMS, DIFFUSE_BAND, DIFFUSE_BAND, zonal, mu);
    let specular = sky_series(0u, MOST_BANDS, sky.last_band, zonal, half_way(local_sky.to_eye, mu));
    return sky.intensity * lobe.weight * (diffuse + unfiltered(dot(mu, local_sky.to_eye)) * specular);
}

// A half vector about `normal` with the density of the Blinn-Phong as wide as the material (basis of Duff et al. 2017).
fn half_vector_about(normal: vec3f, exponent: f32, at: vec2f) -> vec3f {
    let cosine = exp(log(1.0 - at.x) / (exponent + 1.0));
    let sine = sqrt(max(1.0 - cosine * cosine, 0.0));
    let angle = 2.0 * SKY_PI * at.y;
    let side = select(-1.0, 1.0, normal.z >= 0.0);
    let a = -1.0 / (side + normal.z);
    let b = normal.x * normal.y * a;
    let x = vec3f(1.0 + side * normal.x * normal.x * a, side * b, -side * normal.x);
    let y = vec3f(b, side + normal.y * normal.y * a, -normal.y);
    return sine * (cos(angle) * x + sin(angle) * y) + cosine * normal;
}

// L reflect / pi of one direction over the density with which it is drawn.
fn sky_estimate(normal: vec3f, direction: vec3f) -> vec3f {
    let half = normalize_or_zero(direction + local_sky.to_eye);
    let material = with_factor(unfiltered(dot(half, local_sky.to_eye)));
    let texel = sky_texel(direction);
    let mirrored = 4.0 * max(dot(half, local_sky.to_eye), LEAST_COSINE);
    let density = 0.5 * (texel.a + blinn_phong(material.exponent, dot(half, normal)) / mirrored);
    if density <= 0.0 {
        return vec3f(0.0);
    }
    let reflected = reflect(material, specular_at(material, dot(half, normal)), dot(normal, direction));
    return sky.intensity / (SKY_PI * density) * texel.rgb * reflected;
}

// Sample `index` of a pixel of what one normal reflects, linear RGB.
fn sample_sky(normal_in_tangent: vec3f, pixel: vec2u, index: u32) -> vec3f {
    let normal = normalize_or_zero(local_sky.sky_from_map * normal_in_tangent);
    let seeds = sky_seeds(pixel);
    let nth = index / 2u;
    if index % 2u == 0u {
        let place = (seeds.z + nth) % SKY_SAMPLES;
        return sky_estimate(normal, textureLoad(sky_samples, vec2u(place % 128u, place / 128u), 0).xyz);
    }
    let at = vec2f((seeds.xy + nth * SKY_STEP) >> vec2u(8u)) / 16777216.0;
    let half = half_vector_about(normal, reflectance.material.exponent, at);
    let cosine = dot(half, local_sky.to_eye);
    if cosine < LEAST_COSINE {
        return vec3f(0.0);
    }
    return sky_estimate(normal, 2.0 * cosine * half - local_sky.to_eye);
}

// The pixel's third to fifth seed, after those of its jitter.
fn sky_seeds(pixel: vec2u) -> vec3u {
    let third = pcg(pcg(pcg(pixel.x ^ pcg(pixel.y))));
    let fourth = pcg(third);
    return vec3u(third, fourth, pcg(fourth));
}
