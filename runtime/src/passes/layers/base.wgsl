// What lies on the surface: images from three sides, and relief. The twin is compiler/src/images/texture.rs.

// Slopes of the coordinates of an image's space along the axes of the scene's.
struct SceneAxes {
    across: vec3f,
    up: vec3f,
    along: vec3f,
}

// How much each of the three sides has of a surface: by the squares of its normal's components in the image's space, to a power.
fn scene_sides(axes: SceneAxes, n: vec3f, sharpness: f32) -> vec3f {
    // Normals follow the cofactors of the map that points follow.
    let own = vec3f(dot(cross(axes.up, axes.along), n), dot(cross(axes.along, axes.across), n), dot(cross(axes.across, axes.up), n));
    let squares = own * own;
    let most = max(squares.x, max(squares.y, squares.z));
    if most <= 0.0 {
        return vec3f(1.0 / 3.0);
    }
    // Over the largest first, so that no power vanishes.
    let powers = pow(max(squares / most, vec3f(1e-9)), vec3f(sharpness));
    return powers / (powers.x + powers.y + powers.z);
}

// How many widths of the image a pixel of the picture is wide, `t` from the eye.
fn scene_widths(axes: SceneAxes, t: f32) -> f32 {
    return scene.footprint * t * max(length(axes.across), max(length(axes.up), length(axes.along)));
}
