// The relief of layer # by texture TEXTURE.
    if any(layers.weight_# != vec3f(0.0)) {
        let axes = SceneAxes(layers.across_#, layers.up_#, layers.along_#);
        let shares = scene_sides(axes, n, layers.sharpness_#);
        let own = scene_rise(scene_image_TEXTURE, layers.point_#, shares, scene_widths(axes, t));
        rise += layers.weight_# * (own.x * axes.across + own.y * axes.up + own.z * axes.along);
    }
