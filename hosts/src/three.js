%%HEAD%%
import { BufferGeometry, Float32BufferAttribute, Matrix4, Mesh, NodeMaterial, Vector2, Vector3, Vector4, WebGPUCoordinateSystem } from 'three/webgpu';
import { Fn, positionGeometry, uniform, vec4, wgsl, wgslFn } from 'three/tsl';

export const SCENE = %%SCENE%%;

const MODULE = `%%MODULE%%`;

%%LOOK%%
const VECTORS = { vec2f: Vector2, vec3f: Vector3, vec4f: Vector4 };
const MATRIX = new Matrix4();
const SIZE = new Vector2();

/** The scene as an object of three.js: a triangle over the picture whose material traces the field and writes its depth. */
export class Field extends Mesh {
  /** `sky`: whether it draws the scene's sky where nothing stands; without it the host's own background is seen there. */
  constructor({ sky = true } = {}) {
    const nodes = {};
    for (const { name, type, start } of SCENE.fields) nodes[name] = uniform(type === 'f32' ? start[0] : new VECTORS[type](...start)).setName(name);
    const shown = wgslFn(`fn sf_shown(at: vec2f, sky: f32, ${SCENE.fields.map(({ name, type }) => `given_${name}: ${type}`).join(', ')}) -> vec4f {
  ${SCENE.fields.map(({ name }) => `sf_uniforms.${name} = given_${name};`).join('\n  ')}
  let size = sf_uniforms.view_size;
  let picture = ${SCENE.picture}(vec2f(0.5 + 0.5 * at.x, 0.5 - 0.5 * at.y) * size);
  if sky == 0.0 && picture.depth == select(0.0, 1.0, sf_uniforms.view_far > sf_uniforms.view_near) {
    discard;
  }
  return vec4f(picture.color.rgb, picture.depth);
}`, [wgsl(MODULE)]);
    const given = Object.fromEntries(SCENE.fields.map(({ name }) => [`given_${name}`, nodes[name]]));
    const picture = Fn(() => shown({ at: positionGeometry.xy, sky: sky ? 1 : 0, ...given }))().toVar();
    const material = new NodeMaterial();
    material.name = SCENE.name;
    material.fog = false;
    material.vertexNode = vec4(positionGeometry.xy, 0, 1);
    material.depthNode = picture.w;
    material.fragmentNode = vec4(picture.xyz, 1);
    const triangle = new BufferGeometry();
    triangle.setAttribute('position', new Float32BufferAttribute([-1, -1, 0, 3, -1, 0, -1, 3, 0], 3));
    super(triangle, material);
    this.name = SCENE.name;
    this.frustumCulled = false;
    this.nodes = nodes;
%%FIELD%%  }

%%METHODS%%  onBeforeRender(renderer, scene, camera) {
    if (!renderer.backend.isWebGPUBackend) throw new Error(`${SCENE.name} needs WebGPU: write it with --for three-webgl.`);
    if (renderer.logarithmicDepthBuffer) throw new Error(`${SCENE.name} has no logarithmic depth.`);
    const target = renderer.getRenderTarget();
    this.prepare(camera, target ? target.height : renderer.getDrawingBufferSize(SIZE).height, camera.coordinateSystem === WebGPUCoordinateSystem);
  }
}
