// How metallic is layer #, by texture TEXTURE.
    if any(layers.weight_# != vec3f(0.0)) {
        let axes = SceneAxes(layers.across_#, layers.up_#, layers.along_#);
        let shares = scene_sides(axes, n, layers.sharpness_#);
        surface.metallic += layers.weight_#.z * scene_lay(scene_image_TEXTURE, layers.point_#, shares, scene_widths(axes, t)).z;
    }
