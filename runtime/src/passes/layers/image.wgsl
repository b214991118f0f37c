// A texture, by its number and its place.
@group(1) @binding(BINDING) var scene_image_TEXTURE: texture_2d<f32>;
