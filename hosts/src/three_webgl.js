%%HEAD%%
import { BufferGeometry, Float32BufferAttribute, Matrix4, Mesh, ShaderMaterial, Vector2, Vector3, Vector4 } from 'three';

export const SCENE = %%SCENE%%;

const VERTEX = `varying vec2 sf_at;
void main() {
  sf_at = position.xy;
  gl_Position = vec4(position.xy, 0.0, 1.0);
}`;

const FRAGMENT = `%%MODULE%%`;

%%LOOK%%
const VECTORS = { vec2f: Vector2, vec3f: Vector3, vec4f: Vector4 };
const MATRIX = new Matrix4();
const SIZE = new Vector2();

/** The scene as an object of three.js: a triangle over the picture whose material traces the field and writes its depth. */
export class Field extends Mesh {
  /** `sky`: whether it draws the scene's sky where nothing stands; without it the host's own background is seen there. */
  constructor({ sky = true } = {}) {
    const nodes = {};
    for (const { name, type, start } of SCENE.fields) nodes[name] = { value: type === 'f32' ? start[0] : new VECTORS[type](...start) };
    const material = new ShaderMaterial({
      name: SCENE.name,
      vertexShader: VERTEX,
      fragmentShader: FRAGMENT,
      uniforms: Object.fromEntries(SCENE.fields.map(({ name, uniform = name }) => [uniform, nodes[name]])),
      defines: sky ? { SF_SKY: true } : {},
      toneMapped: false,
    });
    const triangle = new BufferGeometry();
    triangle.setAttribute('position', new Float32BufferAttribute([-1, -1, 0, 3, -1, 0, -1, 3, 0], 3));
    super(triangle, material);
    this.name = SCENE.name;
    this.frustumCulled = false;
    this.nodes = nodes;
%%FIELD%%  }

%%METHODS%%  onBeforeRender(renderer, scene, camera) {
    if (renderer.capabilities.logarithmicDepthBuffer) throw new Error(`${SCENE.name} has no logarithmic depth.`);
    const target = renderer.getRenderTarget();
    this.prepare(camera, target ? target.height : renderer.getDrawingBufferSize(SIZE).height, camera.reversedDepth === true);
  }
}
