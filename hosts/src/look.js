// What the shader is told of a view. `camera` is the camera's matrix in the space of the field, `projection` its projection: sixteen numbers each, column after
// column. `half`: whether the host's depth of clip space begins at 0 and not at -1. `left`: whether its coordinates are left-handed; z of the scene points the
// other way there. `height`: of the picture, in pixels.
function look(camera, projection, half, left, height) {
  const c = camera;
  const p = [...projection];
  const turn = left ? -1 : 1;
  for (const i of [8, 9, 10]) p[i] *= turn;
  const parallel = p[15] === 1;
  if (parallel !== SCENE.parallel) {
    throw new Error(`The rays of ${SCENE.name} ${SCENE.parallel ? 'go side by side: it needs an orthographic camera' : 'come from the eye: it needs a perspective camera'}.`);
  }
  // A column of the matrix: where an axis of the camera points. Its length is what a unit of the host is in the scene.
  const axis = (i, by) => [by * c[i], by * c[i + 1], turn * by * c[i + 2]];
  const unit = Math.hypot(c[8], c[9], c[10]) || 1;
  const eye = axis(12, 1);
  const ahead = axis(8, -turn / unit);
  // Where rays go side by side, what is looked at says how far it is from where they begin.
  const reach = Math.max(eye.reduce((sum, e, i) => sum + (SCENE.camera.target[i] - e) * ahead[i], 0), 1e-3);
  // What is 0 and 1 in the depth buffer, where it is reversed too.
  const [first, last] = half ? [0, 1] : [-1, 1];
  const near = parallel ? (p[14] - first) / p[10] : p[14] / (p[10] + first);
  const most = p[10] + last;
  const far = parallel ? (p[14] - last) / p[10] : Math.abs(most) > 1e-12 ? p[14] / most : 1e12;
  const width = height * (p[5] / p[0]);
  const [x, y] = parallel ? [-p[12], -p[13]] : [p[8], p[9]];
  return {
    view_eye: eye,
    view_look_at: eye.map((e, i) => e + reach * ahead[i]),
    view_up: axis(4, 1),
    view_fov: 2 * Math.atan(1 / p[5]),
    view_height: (2 * unit) / p[5],
    view_near: near * unit,
    view_far: far * unit,
    view_size: [width, height],
    // A picture that is not in the middle of what the camera sees.
    view_corner: [-0.5 * width * x, 0.5 * height * y],
  };
}

// The fields of a view that the shader reads.
const VIEW = SCENE.fields.filter((field) => field.source === 'view').map((field) => field.name);
