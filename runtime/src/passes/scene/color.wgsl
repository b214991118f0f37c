// The colour alone: nothing is drawn over the field.
@fragment
fn fragment(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let pixel = scene_pixel(scene_start(position.xy), scene_direction(position.xy), scene_begin(position.xy), scene.max_distance);
    return scene_target(pixel.color, pixel.t >= 0.0, position.xy);
}
