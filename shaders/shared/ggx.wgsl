// Twin of brdf/ggx.rs.

// alpha^2 / (pi (1 - (1 - alpha^2) u^2)^2) above the horizon, scaled to `peak` at the normal.
fn ggx(alpha: f32, peak: f32, cosine: f32) -> f32 {
    let a2 = alpha * alpha;
    let ratio = a2 / (a2 + (1.0 - a2) * (1.0 - cosine * cosine));
    return select(0.0, peak * ratio * ratio, cosine > 0.0);
}
