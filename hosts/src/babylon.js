%%HEAD%%
import { Matrix, Mesh, ShaderLanguage, ShaderMaterial, Vector2, Vector3, Vector4, VertexData } from '@babylonjs/core';

export const SCENE = %%SCENE%%;

const MODULE = `%%MODULE%%`;

const VERTEX = `attribute position : vec3f;
varying sf_at : vec2f;
@vertex
fn main(input : VertexInputs) -> FragmentInputs {
  vertexOutputs.sf_at = vertexInputs.position.xy;
  vertexOutputs.position = vec4f(vertexInputs.position.xy, 0.0, 1.0);
}`;

%%LOOK%%
const VECTORS = [null, null, Vector2, Vector3, Vector4];

/** The scene as a mesh of Babylon.js: a triangle over the picture whose material traces the field and writes its depth. */
export class Field extends Mesh {
  /** `sky`: whether it draws the scene's sky where nothing stands; without it the host's own background is seen there. */
  constructor(scene, { sky = true } = {}) {
    if (!scene.getEngine().isWebGPU) throw new Error(`${SCENE.name} needs the WebGPUEngine.`);
    super(SCENE.name, scene);
    const triangle = new VertexData();
    triangle.positions = [-1, -1, 0, 3, -1, 0, -1, 3, 0];
    triangle.indices = [0, 1, 2];
    triangle.applyToMesh(this);
    this.alwaysSelectAsActiveMesh = true;
    this.isPickable = false;
    const fragmentSource = `varying sf_at : vec2f;
${SCENE.fields.map(({ name, type }) => `uniform ${name} : ${type};\n`).join('')}${MODULE}
@fragment
fn main(input : FragmentInputs) -> FragmentOutputs {
  ${SCENE.fields.map(({ name }) => `sf_uniforms.${name} = uniforms.${name};`).join('\n  ')}
  let at = vec2f(0.5 + 0.5 * fragmentInputs.sf_at.x, 0.5 - 0.5 * fragmentInputs.sf_at.y);
  let picture = ${SCENE.picture}(at * sf_uniforms.view_size);
  ${sky ? '' : 'if (picture.depth == select(0.0, 1.0, sf_uniforms.view_far > sf_uniforms.view_near)) { discard; }'}
  fragmentOutputs.color = vec4f(picture.color.rgb, 1.0);
  fragmentOutputs.fragDepth = picture.depth;
}`;
    const uniforms = SCENE.fields.map((field) => field.name);
    this.material = new ShaderMaterial(SCENE.name, scene, { vertexSource: VERTEX, fragmentSource }, { attributes: ['position'], uniforms, shaderLanguage: ShaderLanguage.WGSL });
    this.material.backFaceCulling = false;
    this.given = {};
    for (const { name, start } of SCENE.fields) this.give(name, start);
    const own = (name) => Object.defineProperty({}, 'value', {
      get: () => (this.given[name].length === 1 ? this.given[name][0] : this.given[name]),
      set: (value) => this.give(name, [value].flat()),
    });
    /** The scene's parameters by their names: `parameters['melt'].value = 0.4`, or an array of numbers. Angles are in radians. */
    this.parameters = Object.fromEntries(SCENE.fields.filter((field) => field.source === 'parameter').map((field) => [field.parameter, own(field.name)]));
    /** The scene's time, in seconds, where anything moves. While `playing`, it is that since the first picture. */
    this.time = this.given.time ? own('time') : { value: 0 };
    this.playing = true;
    this.onBeforeBindObservable.add(() => this.prepare());
  }

  give(name, values) {
    this.given[name] = values;
    const value = values.length === 1 ? values[0] : new VECTORS[values.length](...values);
    this.material[['setFloat', 'setVector2', 'setVector3', 'setVector4'][values.length - 1]](name, value);
  }

  /** Puts a camera where the scene's own camera is. */
  see(camera) {
    const turn = this.getScene().useRightHandedSystem ? 1 : -1;
    const at = ([x, y, z]) => new Vector3(x, y, turn * z);
    const { eye, target, up, fov, height, near, far } = SCENE.camera;
    const world = this.computeWorldMatrix(true);
    camera.upVector = at(up);
    camera.position = Vector3.TransformCoordinates(at(eye), world);
    camera.setTarget(Vector3.TransformCoordinates(at(target), world));
    const size = Math.hypot(...world.m.slice(0, 3));
    Object.assign(camera, { minZ: size * near, maxZ: size * far });
    if (fov) {
      camera.fov = fov;
    } else {
      const high = (size * height) / 2;
      const wide = high * this.getScene().getEngine().getAspectRatio(camera);
      Object.assign(camera, { mode: 1, orthoTop: high, orthoBottom: -high, orthoRight: wide, orthoLeft: -wide });
    }
    return camera;
  }

  prepare() {
    if (this.playing) {
      this.began ??= performance.now();
      this.time.value = (performance.now() - this.began) / 1000;
    }
    const scene = this.getScene();
    const engine = scene.getEngine();
    const camera = Matrix.Invert(scene.getViewMatrix()).multiply(Matrix.Invert(this.getWorldMatrix()));
    const view = look(camera.m, scene.getProjectionMatrix().m, engine.isNDCHalfZRange, !scene.useRightHandedSystem, engine.getRenderHeight());
    for (const name of VIEW) this.give(name, [view[name]].flat());
  }
}
