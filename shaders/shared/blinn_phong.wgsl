// Twin of brdf/blinn_phong.rs.

const TAU: f32 = 6.2831855;

// (s+1)/(2 pi) max(u, 0)^s.
fn blinn_phong(shininess: f32, cosine: f32) -> f32 {
    // pow(0, 0) differs between processors; a cosine of 0 contributes only where the exponent is 0.
    var power = select(0.0, 1.0, shininess == 0.0);
    if cosine > 0.0 {
        power = exp(shininess * log(cosine));
    }
    return (shininess + 1.0) / TAU * power;
}
