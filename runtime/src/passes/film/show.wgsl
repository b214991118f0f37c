// A linear picture as a screen of eight bits wants it: sRGB (IEC 61966-2-1). Stands after base.wgsl and dither.wgsl.

@fragment
fn fragment(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let c = clamp(textureLoad(film_picture, vec2i(position.xy), 0).rgb, vec3f(0.0), vec3f(1.0));
    let encoded = select(1.055 * pow(max(c, vec3f(1e-6)), vec3f(1.0 / 2.4)) - 0.055, 12.92 * c, c <= vec3f(0.0031308));
    return vec4f(encoded + screen_dither(position.xy) / 255.0, 1.0);
}
