// Twin of scene/reconstruction.rs, and of the turns of filter/mod.rs: what is made of the vertices' frames at a pixel.

const ORTHONORMAL: u32 = 0u;
const PROJECTED: u32 = 1u;
// The least area that tangent and bitangent may span.
const LEAST_DETERMINANT: f32 = 1e-3;
const LEAST_TURN: f32 = -0.9;

// Takes the map's normals to tangent space, up to their length; read where they turn.
var<private> tangent_from_map: mat3x3f;

// False where normals of the map are those of tangent space.
fn normals_turn() -> bool {
    return frame.reconstruction != ORTHONORMAL || frame.bump != 0u;
}

// The orthonormal frame at a point: tangent, bitangent and normal.
fn world_from_tangent(point: Point) -> mat3x3f {
    let normal = normalize_or_zero(point.normal_in_world);
    let tangent = normalize_or_zero(point.tangent_in_world - normal * dot(normal, point.tangent_in_world));
    // A mirrored map makes a left-handed frame.
    let across = cross(normal, tangent);
    let bitangent = select(across, -across, dot(across, point.bitangent_in_world) < 0.0);
    return mat3x3f(tangent, bitangent, normal);
}

// Takes the map's normals to the surface's, up to their length.
fn world_from_map(point: Point, own: mat3x3f) -> mat3x3f {
    if frame.reconstruction == ORTHONORMAL {
        return own;
    }
    if frame.reconstruction == PROJECTED {
        let bitangent = normalize_or_zero(point.bitangent_in_world - own[2] * dot(own[2], point.bitangent_in_world));
        let across = cross(own[2], own[0]);
        let determinant = dot(across, bitangent);
        if abs(determinant) > LEAST_DETERMINANT {
            return mat3x3f(cross(bitangent, own[2]) / determinant, across / determinant, own[2]);
        }
        return own;
    }
    return mat3x3f(point.tangent_in_world, point.bitangent_in_world, point.normal_in_world);
}

// A normal of the map in tangent space, of its own length.
fn turned(normal: vec3f) -> vec3f {
    if !normals_turn() {
        return normal;
    }
    return length(normal) * normalize_or_zero(tangent_from_map * normal);
}

// Light and half vector turned as the mean normal in tangent space turns back to the map.
fn as_seen_from(mean: vec3f, light: LocalLight) -> LocalLight {
    if !normals_turn() {
        return light;
    }
    let before = normalize_or_zero(turned(mean));
    let after = normalize_or_zero(mean);
    let cosine = dot(before, after);
    if cosine < LEAST_TURN {
        return light;
    }
    let axis = cross(before, after);
    return LocalLight(
        turned_about(axis, cosine, light.light_in_tangent),
        turned_about(axis, cosine, light.half_in_tangent),
    );
}

fn turned_about(axis: vec3f, cosine: f32, v: vec3f) -> vec3f {
    let moved = cross(axis, v);
    return v + moved + cross(axis, moved) / (1.0 + cosine);
}
