// Twin of scene/bump.rs, and of Vertex::stretch and Vertex::shape_operator (scene/mesh.rs).

const BLINN: u32 = 1u;

// How far the surface goes per unit of either texture coordinate.
fn stretch_of(corner: Corner) -> vec2f {
    let along_u = corner.along_u.xyz * max(corner.along_u.w, LEAST_DERIVATIVE);
    let along_t = corner.along_t.xyz * max(corner.along_t.w, LEAST_DERIVATIVE);
    let m = frame.uv_from_surface;
    let lengths = vec2f(length(m[1].y * along_u + m[0].y * along_t), length(m[1].x * along_u + m[0].x * along_t));
    return lengths / abs(determinant(m));
}

// -A W A^-1 by columns, A the change of texture coordinates with t up.
fn shape_operator_of(corner: Corner) -> vec4f {
    let m = frame.uv_from_surface;
    let a = mat2x2f(m[0].x, -m[0].y, -m[1].x, m[1].y);
    let inverse = mat2x2f(a[1].y, -a[0].y, -a[1].x, a[0].x) * (1.0 / determinant(a));
    let z = a * mat2x2f(corner.bend.xy, corner.bend.zw) * inverse;
    return -vec4f(z[0], z[1]);
}

// The height at the pixel's centre, between the base texels around it.
fn height_at(uv: vec2f) -> f32 {
    var taps = bilinear(uv, vec2i(textureDimensions(means)), frame.wraps != 0u);
    var sum = 0.0;
    for (var i = 0; i < 4; i++) {
        sum += taps.weight[i] * textureLoad(means, taps.texel[i], 0).w;
    }
    return sum;
}

// Takes the map's normals to those of the bump-mapped surface, up to their length (Mikkelsen 2008, eq. 25).
fn bumped(point: Point, own: mat3x3f) -> mat3x3f {
    let normal = own[2];
    let s = point.stretch.x * own[0];
    let t = point.stretch.y
        * normalize_or_zero(point.bitangent_in_world - normal * dot(normal, point.bitangent_in_world));
    let across = cross(normal, s);
    let determinant = dot(across, t);
    let inverse_transposed = mat3x3f(cross(t, normal) / determinant, across / determinant, normal);
    let rise = vec3f(frame.rise, 1.0);
    if frame.bump == BLINN {
        return mat3x3f(rise.x * inverse_transposed[0], rise.y * inverse_transposed[1], normal);
    }
    let height = frame.bump_scale * height_at(point.uv);
    // [z1 z2; z3 z4].
    let z = point.shape_operator;
    let m33 = (1.0 + height * z.x) * (1.0 + height * z.w) - height * height * z.z * z.y;
    let correction = mat3x3f(
        vec3f(1.0 + height * z.w, -height * z.z, 0.0),
        vec3f(-height * z.y, 1.0 + height * z.x, 0.0),
        vec3f(0.0, 0.0, m33),
    );
    let all = inverse_transposed * correction;
    return mat3x3f(rise.x * all[0], rise.y * all[1], all[2]);
}
