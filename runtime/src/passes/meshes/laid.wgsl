// Images on meshes.

// The axes of an image that is laid on from three sides; by the mesh's own coordinates it is repeated as often for each of their units.
fn mesh_axes(across: vec3f, up: vec3f, along: vec3f) -> SceneAxes {
    mesh_widths = length(across);
    return SceneAxes(mesh_slope(across), mesh_slope(up), mesh_slope(along));
}

// What an image says at the mesh's own coordinates.
fn mesh_image(image: texture_2d<f32>) -> vec3f {
    let size = vec2f(textureDimensions(image));
    let pixels = max(length(mesh_steps.xy * size), length(mesh_steps.zw * size));
    return textureSampleLevel(image, scene_repeated, mesh_widths * mesh_coordinates, log2(max(mesh_widths * pixels, 1e-9))).rgb;
}

fn mesh_laid(image: texture_2d<f32>, p: vec3f, axes: SceneAxes, n: vec3f, sharpness: f32, t: f32) -> vec3f {
    if mesh_place.mapped == 0u {
        return scene_laid(image, p, axes, n, sharpness, t);
    }
    return mesh_image(image);
}

fn mesh_risen(image: texture_2d<f32>, p: vec3f, axes: SceneAxes, n: vec3f, sharpness: f32, t: f32) -> vec3f {
    if mesh_place.mapped == 0u {
        return scene_risen(image, p, axes, n, sharpness, t);
    }
    // The image's slopes are for each of its widths, and the coordinates stretch it to their unit.
    let size = vec2f(textureDimensions(image));
    let slope = mesh_image(image).xy * mesh_widths * vec2f(1.0, size.y / size.x);
    return slope.x * mesh_across + slope.y * mesh_down;
}
