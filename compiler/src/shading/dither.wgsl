// What a screen's eight bits can't hold is spread over pixels. The twin is `dither` in compiler/src/reference/film.rs.

// How far a pixel is moved before it is rounded, in levels: from -0.5 to 0.5, another one in each of 8×8 pixels (Bayer, "An Optimum Method for
// Two-Level Rendition of Continuous-Tone Pictures", 1973). A level that eight bits hold stays as it is.
fn screen_dither(position: vec2f) -> f32 {
    let at = vec2u(position);
    let mixed = at.x ^ at.y;
    let rank = ((mixed & 1u) * 32u) + ((at.y & 1u) * 16u) + ((mixed & 2u) * 4u) + ((at.y & 2u) * 2u) + ((mixed & 4u) / 2u) + ((at.y & 4u) / 4u);
    return (f32(rank) + 0.5) / 64.0 - 0.5;
}
