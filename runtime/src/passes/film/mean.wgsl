// The mean of the pictures so far, with one more. Stands after base.wgsl.

struct FilmShare {
    // One over the number of pictures, the new one counted in.
    share: f32,
    padding_a: f32,
    padding_b: vec2f,
}

@group(0) @binding(1) var film_mean: texture_2d<f32>;
@group(0) @binding(2) var<uniform> film: FilmShare;

@fragment
fn fragment(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let at = vec2i(position.xy);
    let one = textureLoad(film_picture, at, 0);
    // The first one finds nothing there that counts.
    if film.share >= 1.0 {
        return one;
    }
    return mix(textureLoad(film_mean, at, 0), one, film.share);
}
