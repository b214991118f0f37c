%%HEAD%%
import { CULLFACE_NONE, Entity, Mat4, Mesh, MeshInstance, SEMANTIC_POSITION, ShaderMaterial, Vec3 } from 'playcanvas';

export const SCENE = %%SCENE%%;

const MODULE = `%%MODULE%%`;

const VERTEX = `attribute aPosition: vec3f;
varying sf_at: vec2f;
@vertex
fn vertexMain(input: VertexInput) -> VertexOutput {
  var output: VertexOutput;
  output.sf_at = input.aPosition.xy;
  output.position = vec4f(input.aPosition.xy, 0.0, 1.0);
  return output;
}`;

%%LOOK%%
/** The scene as an entity of PlayCanvas: a triangle over the picture whose material traces the field and writes its depth. */
export class Field extends Entity {
  /** `sky`: whether it draws the scene's sky where nothing stands; without it the host's own background is seen there. */
  constructor(app, { sky = true } = {}) {
    if (!app.graphicsDevice.isWebGPU) throw new Error(`${SCENE.name} needs a graphics device for WebGPU.`);
    super(SCENE.name, app);
    const mesh = new Mesh(app.graphicsDevice);
    mesh.setPositions([-1, -1, 0, 3, -1, 0, -1, 3, 0]);
    mesh.setIndices([0, 1, 2]);
    mesh.update();
    const fragmentWGSL = `varying sf_at: vec2f;
${SCENE.fields.map(({ name, type }) => `uniform ${name}: ${type};\n`).join('')}${MODULE}
@fragment
fn fragmentMain(input: FragmentInput) -> FragmentOutput {
  var output: FragmentOutput;
  ${SCENE.fields.map(({ name }) => `sf_uniforms.${name} = uniform.${name};`).join('\n  ')}
  let at = vec2f(0.5 + 0.5 * input.sf_at.x, 0.5 - 0.5 * input.sf_at.y);
  let picture = ${SCENE.picture}(at * sf_uniforms.view_size);
  ${sky ? '' : 'if (picture.depth == select(0.0, 1.0, sf_uniforms.view_far > sf_uniforms.view_near)) { discard; }'}
  output.color = vec4f(picture.color.rgb, 1.0);
  output.fragDepth = picture.depth;
  return output;
}`;
    this.material = new ShaderMaterial({ uniqueName: `surefoot-${SCENE.name}-${sky}`, vertexWGSL: VERTEX, fragmentWGSL, attributes: { aPosition: SEMANTIC_POSITION } });
    this.material.cull = CULLFACE_NONE;
    this.given = {};
    for (const { name, start } of SCENE.fields) this.give(name, start);
    const instance = new MeshInstance(mesh, this.material);
    instance.cull = false;
    this.addComponent('render', { meshInstances: [instance], castShadows: false, receiveShadows: false });
    const own = (name) => Object.defineProperty({}, 'value', {
      get: () => (this.given[name].length === 1 ? this.given[name][0] : this.given[name]),
      set: (value) => this.give(name, [value].flat()),
    });
    /** The scene's parameters by their names: `parameters['melt'].value = 0.4`, or an array of numbers. Angles are in radians. */
    this.parameters = Object.fromEntries(SCENE.fields.filter((field) => field.source === 'parameter').map((field) => [field.parameter, own(field.name)]));
    /** The scene's time, in seconds, where anything moves. While `playing`, it is that since the first picture. */
    this.time = this.given.time ? own('time') : { value: 0 };
    this.playing = true;
    const prepare = (camera) => this.prepare(camera);
    app.scene.on('prerender', prepare);
    this.once('destroy', () => app.scene.off('prerender', prepare));
  }

  give(name, values) {
    this.given[name] = values;
    this.material.setParameter(name, values.length === 1 ? values[0] : values);
  }

  /** Puts an entity with a camera where the scene's own camera is. */
  see(entity) {
    const { eye, target, up, fov, height, near, far } = SCENE.camera;
    const world = this.getWorldTransform();
    entity.setPosition(world.transformPoint(new Vec3(eye)));
    entity.lookAt(world.transformPoint(new Vec3(target)), new Vec3(up));
    const size = Math.hypot(...world.data.slice(0, 3));
    const seen = fov ? { fov: (fov * 180) / Math.PI } : { projection: 1, orthoHeight: (size * height) / 2 };
    Object.assign(entity.camera, { nearClip: size * near, farClip: size * far }, seen);
    return entity;
  }

  prepare(component) {
    if (this.playing) {
      this.began ??= performance.now();
      this.time.value = (performance.now() - this.began) / 1000;
    }
    const { camera } = component;
    const target = component.renderTarget;
    const tall = (target ? target.height : component.system.app.graphicsDevice.height) * component.rect.w;
    const place = new Mat4().copy(this.getWorldTransform()).invert().mul(component.entity.getWorldTransform());
    const view = look(place.data, camera.projectionMatrix.data, false, false, tall);
    for (const name of VIEW) this.give(name, [view[name]].flat());
  }
}
