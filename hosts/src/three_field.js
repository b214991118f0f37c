    /** The scene's parameters by their names: `parameters['melt'].value = 0.4`. Angles are in radians. */
    this.parameters = Object.fromEntries(SCENE.fields.filter((field) => field.source === 'parameter').map((field) => [field.parameter, nodes[field.name]]));
    /** The scene's time, in seconds, where anything moves. While `playing`, it is that since the first picture. */
    this.time = nodes.time ?? { value: 0 };
    this.playing = true;
    this.began = null;
