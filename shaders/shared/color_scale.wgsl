// Where on a colour map of nine stops a value lies: between which two, and how far.

struct ColorStop {
    index: u32,
    blend: f32,
}

// For t in 0..1; what lies beyond has the end's colour.
fn color_stop(t: f32) -> ColorStop {
    let scaled = 8.0 * clamp(t, 0.0, 1.0);
    let index = min(u32(scaled), 7u);
    return ColorStop(index, scaled - f32(index));
}
