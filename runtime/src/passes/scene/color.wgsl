// The colour alone: nothing is drawn over the field.
@fragment
fn fragment(@builtin(position) position: vec4f) -> @location(0) vec4f {
    return scene_target(scene_pixel(scene_direction(position.xy), scene.max_distance).color);
}
