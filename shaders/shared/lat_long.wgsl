// Twin of lighting/environment.rs: where a direction stands in a picture by latitude and longitude.

const SKY_PI: f32 = 3.1415927;

// The sky's frame from the world's; `turn` is cosine and sine of the sky's rotation.
fn sky_from_world(turn: vec2f, v: vec3f) -> vec3f {
    return vec3f(turn.x * v.x + turn.y * v.y, turn.x * v.y - turn.y * v.x, v.z);
}

// Both coordinates in 0..1.
fn lat_long(direction: vec3f) -> vec2f {
    // atan2(0, 0) is not defined; at the poles every column is as good.
    let is_pole = abs(direction.x) + abs(direction.y) == 0.0;
    let turn = atan2(direction.x, select(direction.y, 1.0, is_pole)) / (2.0 * SKY_PI);
    return vec2f(turn + 0.5, acos(clamp(direction.z, -1.0, 1.0)) / SKY_PI);
}
