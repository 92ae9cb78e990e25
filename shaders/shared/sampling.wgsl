// Twin of filter/sampling.rs.

// The four texels around a point, and their weights, which sum to 1.
struct Taps {
    texel: array<vec2i, 4>,
    weight: vec4f,
}

// The texel that `index` stands for along an axis of `size` texels, where the map tiles or its edge goes on.
fn address(index: i32, size: i32, wraps: bool) -> i32 {
    if wraps {
        let rest = index % size;
        return select(rest, rest + size, rest < 0);
    }
    return clamp(index, 0, size - 1);
}

fn bilinear(uv: vec2f, size: vec2i, wraps: bool) -> Taps {
    let at = uv * vec2f(size) - 0.5;
    let first = vec2i(floor(at));
    let f = at - floor(at);
    let x = vec2i(address(first.x, size.x, wraps), address(first.x + 1, size.x, wraps));
    let y = vec2i(address(first.y, size.y, wraps), address(first.y + 1, size.y, wraps));
    return Taps(
        array(vec2i(x.x, y.x), vec2i(x.y, y.x), vec2i(x.x, y.y), vec2i(x.y, y.y)),
        vec4f((1.0 - f.x) * (1.0 - f.y), f.x * (1.0 - f.y), (1.0 - f.x) * f.y, f.x * f.y),
    );
}
