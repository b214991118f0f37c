  /** Puts a camera where the scene's own camera is. */
  see(camera) {
    const { eye, target, up, fov, height, near, far } = SCENE.camera;
    camera.up.set(...up);
    camera.position.set(...eye).applyMatrix4(this.matrixWorld);
    camera.lookAt(new Vector3(...target).applyMatrix4(this.matrixWorld));
    const size = this.matrixWorld.getMaxScaleOnAxis();
    Object.assign(camera, { near: size * near, far: size * far });
    if (camera.isPerspectiveCamera) {
      camera.fov = (fov * 180) / Math.PI;
    } else {
      const high = (size * height) / 2;
      const wide = (high * (camera.right - camera.left)) / (camera.top - camera.bottom);
      Object.assign(camera, { top: high, bottom: -high, right: wide, left: -wide });
    }
    camera.updateProjectionMatrix();
    return camera;
  }

  /** Nothing picks the triangle that it is drawn with. */
  raycast() {}

  prepare(camera, height, half) {
    if (this.playing) {
      this.began ??= performance.now();
      this.time.value = (performance.now() - this.began) / 1000;
    }
    MATRIX.copy(this.matrixWorld).invert().multiply(camera.matrixWorld);
    const view = look(MATRIX.elements, camera.projectionMatrix.elements, half, false, height);
    for (const name of VIEW) {
      const node = this.nodes[name];
      if (typeof node.value === 'number') node.value = view[name];
      else node.value.fromArray(view[name]);
    }
  }

