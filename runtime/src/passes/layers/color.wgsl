// The colour of layer # by texture TEXTURE.
    if any(layers.weight_# != vec3f(0.0)) {
        let axes = AXES(layers.across_#, layers.up_#, layers.along_#);
        surface.color += layers.weight_# * LAID(scene_image_TEXTURE, layers.point_#, axes, n, layers.sharpness_#, t);
    }
