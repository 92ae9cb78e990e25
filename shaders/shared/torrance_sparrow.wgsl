// Twin of brdf/torrance_sparrow.rs.

// exp(-b^2 / (4 sigma^2)), scaled to integrate to 1 over the sphere.
fn torrance_sparrow(sigma: f32, cosine: f32) -> f32 {
    let u = clamp(cosine, -1.0, 1.0);
    // acos() loses the small angles.
    let ratio = atan2(sqrt(1.0 - u * u), u) / sigma;
    return exp(-0.25 * ratio * ratio) / (2.0 * TAU * mean_over_sphere(sigma * sigma));
}

// sigma' of the form blurred by a lobe (Han et al. 2007, eq. 21).
fn blurred_sigma(sigma: f32, kappa: f32) -> f32 {
    return sqrt(sigma * sigma + 0.5 / max(kappa, 1e-6));
}

// h(x) = 1/2 int_0^pi exp(-b^2 / (4 x)) sin(b) db.
fn mean_over_sphere(x: f32) -> f32 {
    if x < 0.25 {
        return x * (1.0 - x * (2.0 / 3.0 - x * (4.0 / 15.0 - x * (8.0 / 105.0 - x * 16.0 / 945.0))));
    }
    let y = 1.0 / x;
    return (1.0 + y * (0.4113017 + y * (0.11675245 - y * 4.930641e-4)))
        / (1.0 + y * (1.14500225 + y * (0.53510254 + y * 0.10901096)));
}
