// Whether engines of the web draw what `surefoot compile --for` wrote for them: in Chromium without a screen, in a page of each engine that only adds the
// object to its scene, beside a cube of its own triangles. The same of wgpu-py, in a program.
//
//     node engines.mjs PROGRAM FOLDER [HOST or SCENE…]
//
// PROGRAM is surefoot, FOLDER takes the files and pictures. The usual run draws two small scenes; with SUREFOOT_ENGINES=write in the environment it draws
// all of them and writes docs/engines.md. CHROMIUM names the browser, /usr/bin/chromium where it does not; PYTHON
// a Python with wgpu, python3 where it does not. This must hold: the picture is the program's own;
// the cube is seen where it is seen as a part of the scene; the picture is the program's own after the host has set a parameter, and
// stays so where the host moves the object and the camera with it.

import { execFileSync } from 'node:child_process';
import { existsSync, mkdirSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { cpus, tmpdir } from 'node:os';
import { dirname, extname, join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { chromium } from 'playwright-core';
import { PNG } from 'pngjs';

const [program, work, ...chosen] = process.argv.slice(2);
const root = join(dirname(fileURLToPath(import.meta.url)), '..');
const packages = join(root, 'tests', 'node_modules');
const whole = process.env.SUREFOOT_ENGINES === 'write';
const [width, height] = [192, 108];

// Each with the place and the side of a cube that is half within what stands there, and what the host sets.
const SCENES = {
  // Rays that go side by side.
  parallel: {
    cube: [1, 0.5, 0.7, 0.9],
    set: ['hole', 0.55],
    text: `param hole = 0.3 in 0.1..0.6
material clay { color: #c9784f, roughness: 0.6 }
scene = (box((2, 1.2, 1.4)) - cylinder(hole, 3)).translate(0, 0.6, 0).material(clay) | sphere(0.4).translate(-1.2, 0.4, 1.2) | plane(y)
camera { eye: (8, 7, 8), target: (0, 0.6, 0), projection: orthographic, height: 4 }
`,
  },
  csg: { cube: [0, 1.15, 0.4, 1.6], set: ['drill', 0.2] },
  melting: { cube: [0.4, 1.75, 0.1, 1.2], set: ['melt', 0.5] },
  colonnade: { cube: [1.5, 1.4, 0.6, 1.6], set: ['rows', 3] },
  chess: { cube: [0.5, 0.5, -1, 0.9], set: ['polish', 0.6] },
  menger: { cube: [0.2, 1.3, 0.2, 1.9], set: ['cut', 0.6] },
  balls_bowl: { cube: [0.6, 0.8, 0.4, 1], set: ['bump', 0.85] },
  // Sixty spheres in a table, whose joins the host sets.
  spheres: {
    cube: [0.3, 0.3, 0.2, 0.7],
    set: ['melt', 0.25],
    text: `param melt = 0.05 in 0.01..0.3
material clay { color: #c9784f, roughness: 0.6 }
scene = (for i in 0..60 by smooth_union(melt) { sphere(0.13 + 0.002 * i).translate(0.16 * sqrt(i) * cos(137.5deg * i), 0.25, 0.16 * sqrt(i) * sin(137.5deg * i)) }).material(clay)
      | plane(y)
camera { eye: (1.9, 2.2, 2.8), target: (0, 0.2, 0), fov: 38deg }
`,
  },
};
// Of all pixels so many are the same, within three levels of 255; the cube's edges are where two rasterisers differ.
const SAME = 0.99;
// All pictures of a scene in a host take no longer than so many seconds. A compiler of WebGL that is not done by then is not done for long.
const longest = (host) => (HOSTS[host].gpu ? 900 : 300);

// What a page of the host does by itself: its renderer, a camera, a cube. `draw` draws once what is to be seen.
const three = (module, renderer) => `
  import * as THREE from '${module}';
  import { Field, SCENE } from 'scene';
  const renderer = new THREE.${renderer}({ antialias: false, preserveDrawingBuffer: true });
  renderer.setSize(WIDTH, HEIGHT);
  document.body.append(renderer.domElement);
  if (renderer.init) await renderer.init();
  const { eye, target, up, fov, height, near, far } = SCENE.camera;
  const high = (height ?? 1) / 2;
  const camera = height ? new THREE.OrthographicCamera(-high * WIDTH / HEIGHT, high * WIDTH / HEIGHT, high, -high, near, far)
    : new THREE.PerspectiveCamera(fov * 180 / Math.PI, WIDTH / HEIGHT, near, far);
  camera.up.set(...up);
  camera.position.set(...eye);
  camera.lookAt(...target);
  const scene = new THREE.Scene();
  const cube = new THREE.Mesh(new THREE.BoxGeometry(SIDE, SIDE, SIDE), new THREE.MeshBasicMaterial({ color: 0xff00ff }));
  cube.position.set(...PLACE);
  scene.add(cube);
  const field = new Field();
  field.playing = false;
  scene.add(field);
  window.set = (name, value) => { field.parameters[name].value = value; };
  // The object is moved, and the camera with it.
  window.turn = () => {
    field.position.set(1, 2, 3);
    field.rotation.y = 0.7;
    field.scale.setScalar(2);
    field.updateMatrixWorld();
    field.see(camera);
  };
  window.draw = (shown, cubed) => { field.visible = shown; cube.visible = cubed; renderer.render(scene, camera); };`;

const babylon = `
  import * as BABYLON from '@babylonjs/core';
  import { Field, SCENE } from 'scene';
  const canvas = document.createElement('canvas');
  Object.assign(canvas, { width: WIDTH, height: HEIGHT });
  document.body.append(canvas);
  const engine = new BABYLON.WebGPUEngine(canvas, { antialias: false });
  await engine.initAsync();
  const scene = new BABYLON.Scene(engine);
  const place = ([x, y, z]) => new BABYLON.Vector3(x, y, -z);
  const { eye, target, up, fov, height, near, far } = SCENE.camera;
  const camera = new BABYLON.FreeCamera('camera', place(eye), scene);
  camera.upVector = place(up);
  camera.setTarget(place(target));
  Object.assign(camera, { minZ: near, maxZ: far });
  const high = (height ?? 1) / 2;
  const wide = high * WIDTH / HEIGHT;
  if (fov) camera.fov = fov;
  else Object.assign(camera, { mode: 1, orthoLeft: -wide, orthoRight: wide, orthoTop: high, orthoBottom: -high });
  const cube = BABYLON.MeshBuilder.CreateBox('cube', { size: SIDE }, scene);
  cube.position = place(PLACE);
  cube.material = new BABYLON.StandardMaterial('marker', scene);
  Object.assign(cube.material, { disableLighting: true, emissiveColor: new BABYLON.Color3(1, 0, 1) });
  const field = new Field(scene);
  field.playing = false;
  await scene.whenReadyAsync();
  window.set = (name, value) => { field.parameters[name].value = value; };
  window.turn = () => {
    field.position.set(1, 2, 3);
    field.rotation.y = 0.7;
    field.scaling.setAll(2);
    field.see(camera);
  };
  window.draw = (shown, cubed) => { field.setEnabled(shown); cube.setEnabled(cubed); engine.beginFrame(); scene.render(); engine.endFrame(); };`;

const playcanvas = `
  import * as pc from 'playcanvas';
  import { Field, SCENE } from 'scene';
  const canvas = document.createElement('canvas');
  document.body.append(canvas);
  const device = await pc.createGraphicsDevice(canvas, { deviceTypes: ['webgpu'], antialias: false });
  const options = new pc.AppOptions();
  Object.assign(options, { graphicsDevice: device, componentSystems: [pc.RenderComponentSystem, pc.CameraComponentSystem] });
  const app = new pc.AppBase(canvas);
  app.init(options);
  app.autoRender = false;
  app.setCanvasFillMode('NONE', WIDTH, HEIGHT);
  app.setCanvasResolution('FIXED', WIDTH, HEIGHT);
  app.start();
  const { eye, target, up, fov, height, near, far } = SCENE.camera;
  const camera = new pc.Entity('camera');
  camera.addComponent('camera', { nearClip: near, farClip: far, fov: (fov ?? 1) * 180 / Math.PI, projection: fov ? 0 : 1, orthoHeight: (height ?? 1) / 2 });
  camera.setPosition(...eye);
  camera.lookAt(new pc.Vec3(target), new pc.Vec3(up));
  app.root.addChild(camera);
  const material = new pc.StandardMaterial();
  Object.assign(material, { useLighting: false, diffuse: new pc.Color(0, 0, 0), emissive: new pc.Color(1, 0, 1) });
  material.update();
  const cube = new pc.Entity('cube');
  cube.addComponent('render', { type: 'box', material });
  cube.setLocalScale(SIDE, SIDE, SIDE);
  cube.setPosition(...PLACE);
  app.root.addChild(cube);
  const field = new Field(app);
  field.playing = false;
  app.root.addChild(field);
  window.set = (name, value) => { field.parameters[name].value = value; };
  window.turn = () => {
    field.setPosition(1, 2, 3);
    field.setEulerAngles(0, 40, 0);
    field.setLocalScale(2, 2, 2);
    field.see(camera);
  };
  window.draw = (shown, cubed) => { field.enabled = shown; cube.enabled = cubed; app.renderNextFrame = true; };`;

// Godot is no program of a page. Here its shader is read as what it is but for its first lines, GLSL, and is given what Godot's documents say that it gives.
const godot = `
  import * as THREE from 'three';
  const text = await (await fetch('/scene.js')).text();
  const renderer = new THREE.WebGLRenderer({ antialias: false, preserveDrawingBuffer: true });
  renderer.setSize(WIDTH, HEIGHT);
  document.body.append(renderer.domElement);
  const { eye, target, up, fov, height, near, far } = CAMERA;
  const high = (height ?? 1) / 2;
  const camera = height ? new THREE.OrthographicCamera(-high * WIDTH / HEIGHT, high * WIDTH / HEIGHT, high, -high, near, far)
    : new THREE.PerspectiveCamera(fov * 180 / Math.PI, WIDTH / HEIGHT, near, far);
  camera.up.set(...up);
  camera.position.set(...eye);
  camera.lookAt(...target);
  const uniforms = {
    MODEL_MATRIX: { value: new THREE.Matrix4() },
    INV_VIEW_MATRIX: { value: camera.matrixWorld },
    PROJECTION_MATRIX: { value: camera.projectionMatrix },
    INV_PROJECTION_MATRIX: { value: camera.projectionMatrixInverse },
    VIEWPORT_SIZE: { value: new THREE.Vector2(WIDTH, HEIGHT) },
    TIME: { value: 0 },
  };
  const declared = /^uniform (\\w+) (\\w+)(?: : hint_range\\(.*?\\))? = (.*?);/gm;
  for (const [, type, name, start] of text.matchAll(declared)) uniforms[name] = { value: type === 'float' ? Number(start) : start.match(/[-\\d.e]+(?=[,)])/g).map(Number) };
  const glsl = text.replace(declared, 'uniform $1 $2;').replace(/^(shader_type|render_mode) .*$/gm, '');
  const built = 'uniform mat4 MODEL_MATRIX, INV_VIEW_MATRIX, PROJECTION_MATRIX, INV_PROJECTION_MATRIX; uniform vec2 VIEWPORT_SIZE; uniform float TIME;'
    + '\\n#define SCREEN_UV (gl_FragCoord.xy / VIEWPORT_SIZE)\\n#define RENDERER_COMPATIBILITY 1\\n#define CURRENT_RENDERER 1\\nvec3 ALBEDO; float DEPTH; vec4 POSITION; const vec3 VERTEX = vec3(0.0);\\n';
  const material = new THREE.ShaderMaterial({
    uniforms,
    toneMapped: false,
    vertexShader: 'void main() { gl_Position = vec4(position.xy, 0.0, 1.0); }',
    fragmentShader: built + glsl + '\\nvoid main() { fragment(); gl_FragColor = vec4(ALBEDO, 1.0); gl_FragDepth = DEPTH;\\n#include <colorspace_fragment>\\n}',
  });
  const scene = new THREE.Scene();
  const cube = new THREE.Mesh(new THREE.BoxGeometry(SIDE, SIDE, SIDE), new THREE.MeshBasicMaterial({ color: 0xff00ff }));
  cube.position.set(...PLACE);
  const quad = new THREE.Mesh(new THREE.PlaneGeometry(2, 2), material);
  quad.frustumCulled = false;
  scene.add(cube, quad);
  window.set = (name, value) => { uniforms[name].value = value; };
  window.draw = (shown, cubed) => { quad.visible = shown; cube.visible = cubed; renderer.render(scene, camera); };`;

const HOSTS = {
  three: { package: 'three', renderer: 'WebGPURenderer', gpu: true, script: three('three/webgpu', 'WebGPURenderer') },
  babylon: { package: '@babylonjs/core', renderer: 'WebGPUEngine', gpu: true, script: babylon },
  playcanvas: { package: 'playcanvas', renderer: 'WebGPU', gpu: true, script: playcanvas },
  'three-webgl': { package: 'three', renderer: 'WebGLRenderer', script: three('three', 'WebGLRenderer') },
  godot: { ending: 'gdshader', script: godot },
  'wgpu-py': { ending: 'py', draw: drawByPython },
};
if (!work || chosen.some((name) => !HOSTS[name] && !SCENES[name])) {
  console.error(`usage: node engines.mjs PROGRAM FOLDER [${[...Object.keys(HOSTS), ...Object.keys(SCENES)].join('|')}]`);
  process.exit(2);
}
mkdirSync(work, { recursive: true });

const IMPORTS = {
  three: '/three/build/three.module.js',
  'three/webgpu': '/three/build/three.webgpu.js',
  'three/tsl': '/three/build/three.tsl.js',
  '@babylonjs/core': '/@babylonjs/core/index.js',
  playcanvas: '/playcanvas/build/playcanvas.mjs',
};
const TYPES = { '.js': 'text/javascript', '.mjs': 'text/javascript' };

const surefoot = (...words) => execFileSync(program, words, { stdio: ['ignore', 'pipe', 'pipe'] });
const pixels = (path) => PNG.sync.read(readFileSync(path)).data;

// The share of pixels for which `same` holds, which gets where their three numbers stand.
function share(same) {
  let count = 0;
  for (let at = 0; at < 4 * width * height; at += 4) count += same(at) ? 1 : 0;
  return count / (width * height);
}
const alike = (a, b) => share((at) => [0, 1, 2].every((i) => Math.abs(a[at + i] - b[at + i]) <= 3));
const marked = (a, at) => a[at] > 200 && a[at + 1] < 60 && a[at + 2] > 200;

// The pictures of the program: the scene, the scene with the cube as a part of it, the scene with the parameter set.
function own(name) {
  const { cube: [x, y, z, side], set, text } = SCENES[name];
  const folder = join(work, name);
  mkdirSync(folder, { recursive: true });
  let file = join(root, 'examples', `${name}.sdf`);
  if (text || name === 'balls_bowl') {
    const written = text ?? readFileSync(file, 'utf8').replace(/^(balls \w+|physics) \{[^}]*\}\n/gm, '');
    file = join(folder, `${name}.sdf`);
    writeFileSync(file, written);
  }
  // The cube shines in a colour that no light changes. Parts that are imported lie beside the scene.
  const marked = `${readFileSync(file, 'utf8').replace(/^scene = /m, 'let all_but_the_cube = ').replaceAll('"parts/', `"${join(root, 'examples', 'parts')}/`)}
material of_the_cube { color: #000000, emission: (60, 0, 60) }
scene = all_but_the_cube | box(${side}).translate(${x}, ${y}, ${z}).material(of_the_cube)
`;
  writeFileSync(join(folder, 'marked.sdf'), marked);
  const draw = (file, picture, ...more) => {
    surefoot('render', file, '-o', join(folder, picture), '--size', `${width}x${height}`, '--samples', '1', '--device', 'gpu', ...more);
    return pixels(join(folder, picture));
  };
  // Its camera, as a module for an engine says it.
  const camera = JSON.parse(surefoot('compile', file, '--for', 'three').toString().match(/^ {2}camera: (.*),$/m)[1]);
  return { file, camera, plain: draw(file, 'plain.png'), marked: draw(join(folder, 'marked.sdf'), 'marked.png'), moved: draw(file, 'moved.png', '--set', set.join('=')) };
}

// Draws a scene in a host. The answer: what is to be compared with `truth`, and how long the first picture took.
async function draw(host, name, truth) {
  const folder = join(work, name, host);
  mkdirSync(folder, { recursive: true });
  const module = join(folder, `${name}.${HOSTS[host].ending ?? 'js'}`);
  surefoot('compile', truth.file, '--for', host, '-o', module);
  const { plain, both, cube, moved, turned, first } = await (HOSTS[host].draw ?? drawInPage)(host, name, truth, module);
  return {
    same: alike(plain, truth.plain),
    depth: share((at) => marked(both, at) === marked(truth.marked, at)),
    seen: share((at) => marked(both, at)),
    hidden: share((at) => marked(cube, at) && !marked(both, at)),
    moved: alike(moved, truth.moved),
    changed: 1 - alike(moved, plain),
    turned: alike(turned, moved),
    first,
  };
}

// The pictures of a program of Python.
function drawByPython(host, name, truth, module) {
  const { cube, set } = SCENES[name];
  const drawn = execFileSync(process.env.PYTHON ?? 'python3', [join(root, 'tests', 'readers', 'draw.py'), module, width, height, ...cube, ...set].map(String), { stdio: ['ignore', 'pipe', 'pipe'] });
  const picture = (title) => {
    const data = readFileSync(join(dirname(module), `${title}.rgba`));
    writeFileSync(join(dirname(module), `${title}.png`), PNG.sync.write(Object.assign(new PNG({ width, height }), { data })));
    return data;
  };
  return { plain: picture('plain'), both: picture('with'), cube: picture('cube'), moved: picture('moved'), turned: picture('turned'), first: Number(drawn) };
}

// The pictures of a page.
async function drawInPage(host, name, truth, module) {
  const { cube: [x, y, z, side], set } = SCENES[name];
  const folder = dirname(module);
  const profile = mkdtempSync(join(tmpdir(), 'surefoot-engines-'));
  const browser = await chromium.launchPersistentContext(profile, {
    executablePath: process.env.CHROMIUM ?? '/usr/bin/chromium',
    headless: true,
    viewport: { width, height },
    ignoreDefaultArgs: ['--disable-gpu'],
    args: [
      '--no-sandbox', '--disable-quic', '--no-first-run', '--disable-background-networking', '--disable-component-update',
      '--disable-sync', '--disable-default-apps', '--disable-gpu-watchdog',
      // WebGPU is shown only where the rest of the page is drawn by the same software driver; WebGL has one of its own.
      ...(HOSTS[host].gpu
        ? ['--enable-unsafe-webgpu', '--enable-features=Vulkan', '--use-vulkan=swiftshader', '--use-angle=vulkan']
        : ['--use-angle=swiftshader', '--enable-unsafe-swiftshader', '--ignore-gpu-blocklist']),
    ],
  });
  const script = HOSTS[host].script.replaceAll('WIDTH', width).replaceAll('HEIGHT', height).replaceAll('PLACE', `[${[x, y, z]}]`).replaceAll('SIDE', side).replaceAll('CAMERA', JSON.stringify(truth.camera));
  const page = `<!doctype html><link rel="icon" href="data:,"><style>body { margin: 0 } canvas { display: block; width: ${width}px; height: ${height}px }</style>
<script type="importmap">${JSON.stringify({ imports: { scene: '/scene.js', ...IMPORTS } })}</script><body><script type="module">${script}
  window.ready = true;</script>`;
  const tab = await browser.newPage();
  const failed = [];
  let wrong;
  const broken = new Promise((_, reject) => { wrong = reject; });
  broken.catch(() => {});
  // A driver may take for ever with a shader.
  const late = setTimeout(() => wrong(new Error(`no pictures within ${longest(host)} s`)), 1000 * longest(host));
  tab.on('pageerror', wrong);
  tab.on('console', (message) => message.type() === 'error' && failed.push(message.text()));
  // Nothing is asked of the net: files of the packages are answered from the disk.
  await tab.route('**/*', (route) => {
    const path = decodeURIComponent(new URL(route.request().url()).pathname);
    if (path === '/') return route.fulfill({ body: page, contentType: 'text/html' });
    const found = path === '/scene.js' ? module : join(packages, path);
    if (!existsSync(found)) {
      failed.push(`it asks for ${path}`);
      return route.fulfill({ status: 404 });
    }
    return route.fulfill({ body: readFileSync(found), contentType: TYPES[extname(found)] ?? 'application/octet-stream' });
  });
  try {
    await tab.goto('http://localhost/');
    await Promise.race([tab.waitForFunction('window.ready', null, { timeout: 240_000 }), broken]);
    const shot = async (picture, shown, cubed) => {
      // Twice: what is compiled on the way is there the second time.
      for (let i = 0; i < 2; i += 1) {
        await Promise.race([tab.evaluate(([shown, cubed]) => window.draw(shown, cubed), [shown, cubed]), broken]);
        await Promise.race([tab.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))), broken]);
      }
      await Promise.race([tab.locator('canvas').screenshot({ path: join(folder, `${picture}.png`), timeout: 1000 * longest(host) }), broken]);
      return pixels(join(folder, `${picture}.png`));
    };
    const began = Date.now();
    const plain = await shot('plain', true, false);
    const first = (Date.now() - began) / 1000;
    const both = await shot('with', true, true);
    const cube = await shot('cube', false, true);
    await tab.evaluate(([name, value]) => window.set(name, value), set);
    const moved = await shot('moved', true, false);
    // Where the host moves the object and the camera with it, nothing else is seen.
    await tab.evaluate(() => window.turn?.());
    const turned = await shot('turned', true, false);
    if (failed.length) throw new Error(failed.join('; '));
    return { plain, both, cube, moved, turned, first };
  } finally {
    clearTimeout(late);
    await browser.close();
    rmSync(profile, { recursive: true, force: true });
  }
}

// What does not hold of a picture.
function wrongs({ same, depth, seen, hidden, moved, changed, turned }) {
  const words = [];
  if (same < SAME) words.push('the picture is another');
  if (depth < SAME) words.push('the cube is seen elsewhere');
  if (seen < 0.002 || hidden < 0.002) words.push('the cube is not on both sides');
  if (moved < SAME || changed < 0.002) words.push('the parameter changes another thing');
  if (turned < SAME) words.push('the object is not where the host has moved it');
  return words;
}

const HEAD = `# Engines

Written by \`SUREFOOT_ENGINES=write tests/run engines\`; \`tests/run engines\` holds two small pictures to the same. Each engine opens the module
that \`surefoot compile SCENE.sdf --for HOST\` wrote. Its page has a camera where the scene's own is, a cube of its own triangles, and no
line more for the field than the one that adds it: \`scene.add(new Field())\`.

Each cell has three shares of the pixels, in percent:

- those that are the same as in the program's picture, within 3 levels of 255 in each channel;
- those where the host's cube is seen or hidden as it is where the scene itself holds such a cube. It stands half within a
  solid, so that each hides a part of the other;
- those that are the same as in the program's picture after the host has set a parameter.

Then the host moves, turns and scales the object, and the camera with it: the picture stays the same. The light is the scene's own.
\`wgpu-py\` is no page but a program, which draws with the same driver as ours. At least ${100 * SAME} % of each are asked for. Pixels at edges differ: two drivers round differently, and rasterisers of triangles know no footprint.
`;
const TAIL = `
## What is not in the table

- \`html\` and \`shadertoy\`: \`tests/run hosts\` compares their pictures; they have no triangles of others.
- \`godot\`: no registry of packages has the engine. The row shows its text as GLSL, which it is but for its first lines, in a page that gives it what
  Godot's documents say that Godot gives. Whether Godot takes it is not tried here.
- \`bevy\`: \`tests/run shaders\` composes it with naga_oil, as Bevy does. The engine itself is not built here.
- \`vulkan\`: \`tests/run shaders\` asks spirv-val and glslangValidator. \`hlsl\`: glslangValidator reads it, but not where it has
  tables; Microsoft's compiler is in no registry that is asked here. \`msl\`: Metal's compiler runs on Apple's machines alone, so nothing but naga has seen it.
`;

const of = (all, usual) => (all.some((name) => chosen.includes(name)) ? all.filter((name) => chosen.includes(name)) : usual);
const names = of(Object.keys(SCENES), whole ? Object.keys(SCENES) : ['csg', 'parallel']);
const hosts = of(Object.keys(HOSTS), Object.keys(HOSTS));
// What was seen before of other hosts stays in the table.
const known = join(work, 'results.json');
const results = whole && existsSync(known) ? JSON.parse(readFileSync(known, 'utf8')) : {};
let failures = 0;
const truths = Object.fromEntries(names.map((name) => [name, own(name)]));
for (const host of hosts) {
  for (const name of names) {
    let result;
    try {
      result = await draw(host, name, truths[name]);
      result.wrong = wrongs(result);
    } catch (error) {
      result = { wrong: [error.message.split('\n')[0]] };
    }
    (results[host] ??= {})[name] = result;
    failures += result.wrong.length ? 1 : 0;
    if (whole) writeFileSync(known, JSON.stringify(results));
    console.log(`${host} ${name}: ${JSON.stringify(result)}`);
  }
}
if (whole) writeFileSync(join(root, 'docs', 'engines.md'), document());
process.exitCode = failures ? 1 : 0;

function wgpuVersion() {
  return execFileSync(process.env.PYTHON ?? 'python3', ['-c', 'import wgpu; print(wgpu.__version__)']).toString().trim();
}

function chromeVersion() {
  return execFileSync(process.env.CHROMIUM ?? '/usr/bin/chromium', ['--version'], { stdio: ['ignore', 'pipe', 'ignore'] }).toString().match(/[\d.]+/)[0];
}

// The page: a row for each host, a column for each scene.
function document() {
  const scenes = Object.keys(SCENES);
  const percent = (number) => `${(Math.floor(number * 1e4) / 100).toFixed(2)}`;
  const cell = (result) => (result.same === undefined
    ? `no: ${result.wrong[0]}`
    : `${percent(result.same)} / ${percent(result.depth)} / ${percent(result.moved)}${result.wrong.length ? ` (${result.wrong.join(', ')})` : ''}`);
  const version = (name) => JSON.parse(readFileSync(join(packages, name, 'package.json'), 'utf8')).version;
  const row = (first, rest) => `| ${[first, ...rest].join(' | ')} |`;
  const about = (host) => ({ godot: '`godot`: its text as GLSL, in a page', 'wgpu-py': `\`wgpu-py\`: wgpu ${wgpuVersion()}, a program of Python` }[host] ?? `\`${host}\`: ${HOSTS[host].package} ${version(HOSTS[host].package)}, ${HOSTS[host].renderer}`);
  const table = (value) => [row('', scenes.map((name) => `\`${name}\``)), row('---', scenes.map(() => '---')), ...Object.keys(HOSTS).filter((host) => results[host]).map((host) => row(about(host), scenes.map((name) => value(results[host][name] ?? { wrong: ['not tried'] }))))].join('\n');
  const settings = scenes.map((name) => `\`${name}\`: ${SCENES[name].set[0]} = ${SCENES[name].set[1]}`).join(', ');
  return `${HEAD}
${table(cell)}

The parameters that were set: ${settings}. Seconds until the first picture stood, with the shader's compile by a software driver:

${table((result) => (result.first === undefined ? '' : result.first.toFixed(1)))}

Pictures of ${width}×${height} in Chromium ${chromeVersion()}, drawn by SwiftShader; ours, and wgpu-py's, by Mesa's llvmpipe; on ${cpus().length} cores.
${TAIL}`;
}
