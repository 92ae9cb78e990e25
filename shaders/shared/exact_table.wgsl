// Twin of brdf/exact_table.rs; the tables' texture is the pass's to bind.

// Lobes sharper than this are taken by a closed form (sphere/vmf.rs).
const KAPPA_MAX: f32 = 1e5;
const LIT: f32 = 128.0;
const DARK: f32 = 32.0;

// The tables of the material, a measured one's by channel, and that of the clamped cosine, s = 1.
const OF_MATERIAL: i32 = 0;
const OF_LAMBERTIAN: i32 = 3;

// What the convolution is nearly, per steradian: a von Mises-Fisher lobe, or a tail from the same peak.
fn reference(table: i32, kappa: f32, cosine: f32) -> f32 {
    var peak = 0.5 + 0.5 * kappa;
    if kappa >= 1e-3 {
        peak = kappa / (1.0 - exp(-2.0 * kappa));
    }
    let fall = kappa * (1.0 - cosine);
    if (MODEL == GGX || MODEL == MEASURED) && table != OF_LAMBERTIAN {
        return peak / TAU / ((1.0 + fall) * (1.0 + fall));
    }
    return peak / TAU * exp(-fall);
}

fn exact_ratio(table: i32, row: f32, column: f32) -> f32 {
    let size = vec2i(textureDimensions(exact_tables));
    let at = clamp(vec2i(i32(column), i32(row)), vec2i(0), size - 2);
    let blend = vec2f(column, row) - vec2f(at);
    let upper = mix(
        textureLoad(exact_tables, at, table, 0).r,
        textureLoad(exact_tables, at + vec2i(1, 0), table, 0).r,
        blend.x,
    );
    let lower = mix(
        textureLoad(exact_tables, at + vec2i(0, 1), table, 0).r,
        textureLoad(exact_tables, at + vec2i(1, 1), table, 0).r,
        blend.x,
    );
    return mix(upper, lower, blend.y);
}

// The table's model, of equivalent exponent `shininess`, convolved with a lobe of concentration `kappa` up to KAPPA_MAX.
fn exact_convolved(table: i32, kappa: f32, shininess: f32, cosine: f32) -> f32 {
    let s1 = shininess + 1.0;
    let u = clamp(cosine, -1.0, 1.0);
    let width = kappa * s1 / (kappa + s1);
    let ratio_of_widths = sqrt((s1 + 1.0) / (kappa + 1.0));
    let rows = f32(textureDimensions(exact_tables).y) - 1.0;
    let row = rows * log(1.0 + ratio_of_widths) / log(1.0 + sqrt(s1 + 1.0));
    var column = LIT - 1.0;
    if u < 0.0 {
        column += DARK * sqrt(-u);
    } else if width < 1e-3 {
        column *= 1.0 - u;
    } else {
        column *= log(1.0 + width * (1.0 - u)) / log(1.0 + width);
    }
    return exact_ratio(table, row, column) * reference(table, width, u);
}
