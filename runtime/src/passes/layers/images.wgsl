// Images that are laid on. Stands after base.wgsl.

@group(1) @binding(4) var scene_repeated: sampler;

// The colour at a place, in widths of the image to the right and down.
fn scene_image(image: texture_2d<f32>, at: vec2f, level: f32) -> vec3f {
    let size = vec2f(textureDimensions(image));
    // The image is as high as it is for its width.
    return textureSampleLevel(image, scene_repeated, at * vec2f(1.0, size.x / size.y), level).rgb;
}

fn scene_level(image: texture_2d<f32>, widths: f32) -> f32 {
    return log2(max(widths * f32(textureDimensions(image).x), 1e-9));
}

// The image laid on from three sides, each as far as its share says.
fn scene_lay(image: texture_2d<f32>, p: vec3f, shares: vec3f, widths: f32) -> vec3f {
    let level = scene_level(image, widths);
    let x = scene_image(image, vec2f(p.z, -p.y), level);
    let y = scene_image(image, p.xz, level);
    let z = scene_image(image, vec2f(p.x, -p.y), level);
    return shares.x * x + shares.y * y + shares.z * z;
}

// How steeply the image rises along each axis of its space.
fn scene_rise(image: texture_2d<f32>, p: vec3f, shares: vec3f, widths: f32) -> vec3f {
    let level = scene_level(image, widths);
    let x = scene_image(image, vec2f(p.z, -p.y), level);
    let y = scene_image(image, p.xz, level);
    let z = scene_image(image, vec2f(p.x, -p.y), level);
    return shares.x * vec3f(0.0, -x.y, x.x) + shares.y * vec3f(y.x, 0.0, y.y) + shares.z * vec3f(z.x, -z.y, 0.0);
}

// What an image says where it is laid on from three sides; `t` is how far the eye is.
fn scene_laid(image: texture_2d<f32>, p: vec3f, axes: SceneAxes, n: vec3f, sharpness: f32, t: f32) -> vec3f {
    return scene_lay(image, p, scene_sides(axes, n, sharpness), scene_widths(axes, t));
}

// How steeply an image that is laid on so rises along the axes of the scene.
fn scene_risen(image: texture_2d<f32>, p: vec3f, axes: SceneAxes, n: vec3f, sharpness: f32, t: f32) -> vec3f {
    let own = scene_rise(image, p, scene_sides(axes, n, sharpness), scene_widths(axes, t));
    return own.x * axes.across + own.y * axes.up + own.z * axes.along;
}
