// Twin of sphere/vmf.rs in f32: what cancels there below kappa 0.05 cancels here below 1, so the series reach up to 1.

const KAPPA_DELTA: f32 = 1e7;

// A(kappa) = coth(kappa) - 1/kappa, for kappa below 100. Series: within 2e-6 at kappa 1.
fn mean_resultant_length(kappa: f32) -> f32 {
    if kappa < 1.0 {
        let k2 = kappa * kappa;
        return kappa * (1.0 / 3.0 - k2 * (1.0 / 45.0 - k2 * (2.0 / 945.0 - k2 * (1.0 / 4725.0 - k2 * 2.0 / 93555.0))));
    }
    let e = exp(-2.0 * kappa);
    return (1.0 + e) / (1.0 - e) - 1.0 / kappa;
}

// dA/dkappa = 1/kappa^2 - 1/sinh^2(kappa).
fn mean_resultant_slope(kappa: f32) -> f32 {
    if kappa < 1.0 {
        let k2 = kappa * kappa;
        return 1.0 / 3.0 - k2 * (1.0 / 15.0 - k2 * (2.0 / 189.0 - k2 * (1.0 / 675.0 - k2 * 2.0 / 10395.0)));
    }
    let e = exp(-2.0 * kappa);
    return 1.0 / (kappa * kappa) - 4.0 * e / ((1.0 - e) * (1.0 - e));
}

// The concentration whose mean resultant length is 1 - shortfall.
fn concentration(shortfall: f32) -> f32 {
    if shortfall < 0.02 {
        return min(1.0 / max(shortfall, 1.0 / KAPPA_DELTA), KAPPA_DELTA);
    }
    let r = 1.0 - shortfall;
    if r <= 0.0 {
        return 0.0;
    }
    var kappa = r * (3.0 - r * r) / (shortfall * (1.0 + r));
    for (var i = 0; i < 3; i++) {
        kappa -= (mean_resultant_length(kappa) - r) / mean_resultant_slope(kappa);
    }
    return max(kappa, 0.0);
}
