// Rays begin where the cone of their tile ends.
@group(2) @binding(1) var scene_cones: texture_2d<u32>;

fn scene_begin(position: vec2f) -> f32 {
    return bitcast<f32>(textureLoad(scene_cones, vec2i((position - floor(scene.corner)) / SCENE_TILE), 0).x);
}
