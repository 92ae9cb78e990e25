// What stored lobes reflect, aligned and unaligned, an entry point each: the twin of filter/vmf/mod.rs.

// A lobe as stored, with its stored colour alpha y; that is read only where `COLORED`.
struct ColoredLobe {
    stored: vec4f,
    color: vec3f,
}

fn plus(a: ColoredLobe, b: ColoredLobe) -> ColoredLobe {
    return ColoredLobe(a.stored + b.stored, a.color + b.color);
}

// A base texel as a lobe: (1, n), empty where it is invalid.
fn base_lobe(texel: vec2i) -> ColoredLobe {
    let normal = textureLoad(means, texel, 0).xyz;
    let weight = select(0.0, 1.0, any(normal != vec3f(0.0)));
    return ColoredLobe(vec4f(weight, normal), weight * color_at(texel));
}

// The base texels around a point, each a lobe (1, n) in a slot of its own.
struct BaseTaps {
    stored: array<vec4f, 4>,
    color: array<vec3f, 4>,
    slot: vec4u,
}

fn base_taps(uv: vec2f) -> BaseTaps {
    var result = BaseTaps();
    let taps = bilinear(uv, vec2i(textureDimensions(means)), frame.wraps != 0u);
    var texels = taps.texel;
    for (var i = 0; i < 4; i++) {
        let lobe = base_lobe(texels[i]);
        result.stored[i] = taps.weight[i] * lobe.stored;
        result.color[i] = taps.weight[i] * lobe.color;
        result.slot[i] = fold(textureLoad(base_slots, texels[i], 0).r);
    }
    return result;
}

// The slot that `slot` is added to before shading.
fn fold(slot: u32) -> u32 {
    return frame.fold[slot / 4u][slot % 4u];
}

// The interpolated channels of every slot that folds into `target_slot`, from level 1 upward.
fn coarse_slot(uv: vec2f, lod: f32, target_slot: u32) -> ColoredLobe {
    var sum = ColoredLobe();
    for (var slot = 0u; slot < frame.lobes; slot++) {
        if fold(slot) == target_slot {
            let stored = textureSampleLevel(lobes, trilinear, uv, slot, lod - frame.lobe_level);
            var color = vec3f(0.0);
            if COLORED {
                color = textureSampleLevel(lobe_colors, trilinear, uv, slot, lod - frame.lobe_level).rgb;
            }
            sum = plus(sum, ColoredLobe(stored, color));
        }
    }
    return sum;
}

// The same of the base level.
fn base_slot(base: BaseTaps, target_slot: u32) -> ColoredLobe {
    var sum = ColoredLobe();
    var taps = base;
    for (var i = 0; i < 4; i++) {
        if taps.slot[i] == target_slot {
            sum = plus(sum, ColoredLobe(taps.stored[i], taps.color[i]));
        }
    }
    return sum;
}

// y alpha (Ks Bs(w_h . mu) + Kd) cos of one stored lobe (Han et al. 2007, Algorithm 2), linear RGB.
fn shade_lobe(lobe: ColoredLobe, light: LocalLight, material: Material) -> vec3f {
    let resultant = lobe.stored.yzw / lobe.stored.x;
    let length = length(resultant);
    let mu = turned(resultant / max(length, 1e-12));
    let kappa = concentration(1.0 - length);
    let light_cosine = dot(mu, light.light_in_tangent);
    let specular = blurred_at(material, kappa, dot(mu, light.half_in_tangent));
    let diffuse = diffuse_cosine(material.diffuse_rule, kappa, light_cosine);
    return lobe_color(lobe) * (
        material.specular * specular * max(light_cosine, 0.0) * material.specular_color
        + material.diffuse * diffuse * material.diffuse_color);
}

// What a stored lobe reflects of every light and of the sky.
fn reflect_lobe(lobe: ColoredLobe) -> vec3f {
    var sum = vec3f(0.0);
    for (var light = 0u; light < frame.light_count; light++) {
        sum += incident[light].radiance * shade_lobe(lobe, incident[light].local, material_towards(incident[light]));
    }
    if SKY {
        sum += lobe_color(lobe) * shade_sky(lobe_of_mean(lobe.stored.yzw / lobe.stored.x));
    }
    return sum;
}

// alpha y.
fn lobe_color(lobe: ColoredLobe) -> vec3f {
    if COLORED {
        return lobe.color;
    }
    return vec3f(lobe.stored.x);
}

// What the interpolated lobes around `uv` reflect.
fn shade_aligned(uv: vec2f, lod: f32) -> vec3f {
    // The base level is not stored as lobes: below level 1 its normals are blended in by hand.
    let base_share = clamp(1.0 - lod, 0.0, 1.0);
    var base = BaseTaps();
    if base_share > 0.0 {
        base = base_taps(uv);
    }
    var sum = vec3f(0.0);
    for (var slot = 0u; slot < frame.lobes; slot++) {
        var lobe = ColoredLobe();
        if base_share < 1.0 {
            let coarse = coarse_slot(uv, max(lod, 1.0), slot);
            lobe = ColoredLobe((1.0 - base_share) * coarse.stored, (1.0 - base_share) * coarse.color);
        }
        if base_share > 0.0 {
            let fine = base_slot(base, slot);
            lobe = plus(lobe, ColoredLobe(base_share * fine.stored, base_share * fine.color));
        }
        if lobe.stored.x > EMPTY_WEIGHT {
            sum += reflect_lobe(lobe);
        }
    }
    return sum;
}

@fragment
fn vmf(point: Point) -> @location(0) vec4u {
    let lookup = look_at(point);
    let probes = probes_of(lookup, frame.vmf_lods);
    var sum = vec3f(0.0);
    for (var i = 0u; i < probes.count; i++) {
        sum += shade_aligned(lookup.uv + probe_offset(probes, i), probes.lod);
    }
    return seen(sum / f32(probes.count));
}

// What the lobes of one texel reflect, slots folded before they are shaded.
fn shade_texel(texel: vec2i, level: i32) -> vec3f {
    var folded = array<vec4f, MAX_LOBES>();
    var colors = array<vec3f, MAX_LOBES>();
    for (var slot = 0u; slot < frame.lobes; slot++) {
        folded[fold(slot)] += textureLoad(lobes, texel, slot, level);
        if COLORED {
            colors[fold(slot)] += textureLoad(lobe_colors, texel, slot, level).rgb;
        }
    }
    var sum = vec3f(0.0);
    for (var slot = 0u; slot < frame.lobes; slot++) {
        if folded[slot].x > EMPTY_WEIGHT {
            sum += reflect_lobe(ColoredLobe(folded[slot], colors[slot]));
        }
    }
    return sum;
}

// The blend of what the four texels around `uv` reflect, `level` counted as the map's.
fn shade_around(uv: vec2f, level: i32) -> vec3f {
    // Not textureDimensions(): some adapters answer it for one level per quad, and a quad may straddle two.
    let size = max(vec2i(frame.base_size) >> vec2u(u32(level)), vec2i(1));
    var taps = bilinear(uv, size, frame.wraps != 0u);
    var sum = vec3f(0.0);
    for (var i = 0; i < 4; i++) {
        if taps.weight[i] == 0.0 {
            continue;
        }
        if level > 0 {
            sum += taps.weight[i] * shade_texel(taps.texel[i], level - i32(frame.lobe_level));
            continue;
        }
        // A base texel is one lobe, whichever slot it sits in.
        let lobe = base_lobe(taps.texel[i]);
        if lobe.stored.x > 0.0 {
            sum += taps.weight[i] * reflect_lobe(lobe);
        }
    }
    return sum;
}

@fragment
fn vmf_unaligned(point: Point) -> @location(0) vec4u {
    let lookup = look_at(point);
    let probes = probes_of(lookup, frame.vmf_lods);
    let level = floor(probes.lod);
    let share = probes.lod - level;
    var sum = vec3f(0.0);
    for (var i = 0u; i < probes.count; i++) {
        let uv = lookup.uv + probe_offset(probes, i);
        sum += (1.0 - share) * shade_around(uv, i32(level));
        if share > 0.0 {
            sum += share * shade_around(uv, i32(level) + 1);
        }
    }
    return seen(sum / f32(probes.count));
}
