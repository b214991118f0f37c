// Opens what `surefoot compile --for` wrote for an engine of the web in a page of that engine, in Chromium without a screen, and writes what it shows:
//
//     node engines.mjs three scene.js FOLDER [WIDTHxHEIGHT] [X,Y,Z,SIZE] [NAME=VALUE]
//
// plain.png: the field alone; with.png: with a cube of the host's triangles at that place of the scene, magenta, which no light changes; cube.png: the cube
// alone; moved.png: after the host has set that parameter. The page only adds the object to its scene; its camera is that of the scene.
//
// CHROMIUM names the browser, /usr/bin/chromium where it does not.

import { existsSync, mkdirSync, mkdtempSync, readFileSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { dirname, extname, join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { chromium } from 'playwright-core';

const [host, file, folder, size = '320x180', place = '0,0,0,1', moved = ''] = process.argv.slice(2);
const [width, height] = size.split('x').map(Number);

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
  window.draw = (shown, cubed) => { field.enabled = shown; cube.enabled = cubed; app.renderNextFrame = true; };`;

const HOSTS = {
  three: { gpu: true, script: three('three/webgpu', 'WebGPURenderer') },
  babylon: { gpu: true, script: babylon },
  playcanvas: { gpu: true, script: playcanvas },
  'three-webgl': { script: three('three', 'WebGLRenderer') },
};
if (!HOSTS[host] || !folder) {
  console.error(`usage: node engines.mjs ${Object.keys(HOSTS).join('|')} scene.js FOLDER [WIDTHxHEIGHT] [X,Y,Z,SIZE] [NAME=VALUE]`);
  process.exit(2);
}

const packages = process.env.ENGINES ?? join(dirname(fileURLToPath(import.meta.url)), 'node_modules');
const imports = {
  scene: '/scene.js',
  three: '/three/build/three.module.js',
  'three/webgpu': '/three/build/three.webgpu.js',
  'three/tsl': '/three/build/three.tsl.js',
  '@babylonjs/core': '/@babylonjs/core/index.js',
  playcanvas: '/playcanvas/build/playcanvas.mjs',
};
const [x, y, z, side] = place.split(',').map(Number);
const script = HOSTS[host].script.replaceAll('WIDTH', width).replaceAll('HEIGHT', height).replaceAll('PLACE', `[${[x, y, z]}]`).replaceAll('SIDE', side);
const page = `<!doctype html><link rel="icon" href="data:,"><style>body { margin: 0 } canvas { display: block; width: ${width}px; height: ${height}px }</style>
<script type="importmap">${JSON.stringify({ imports })}</script><body><script type="module">${script}
  window.ready = true;</script>`;
const TYPES = { '.js': 'text/javascript', '.mjs': 'text/javascript', '.wasm': 'application/wasm' };

mkdirSync(folder, { recursive: true });
const profile = mkdtempSync(join(tmpdir(), 'surefoot-engines-'));
const browser = await chromium.launchPersistentContext(profile, {
  executablePath: process.env.CHROMIUM ?? '/usr/bin/chromium',
  headless: true,
  viewport: { width, height },
  ignoreDefaultArgs: ['--disable-gpu'],
  args: [
    '--no-sandbox', '--disable-quic', '--no-first-run', '--disable-background-networking', '--disable-component-update',
    '--disable-sync', '--disable-default-apps',
    // WebGPU is shown only where the rest of the page is drawn by the same software driver; WebGL has one of its own.
    ...(HOSTS[host].gpu
      ? ['--enable-unsafe-webgpu', '--enable-features=Vulkan', '--use-vulkan=swiftshader', '--use-angle=vulkan']
      : ['--use-angle=swiftshader', '--enable-unsafe-swiftshader', '--ignore-gpu-blocklist']),
  ],
});
const failed = [];
try {
  const tab = await browser.newPage();
  let wrong;
  const broken = new Promise((_, reject) => { wrong = reject; });
  broken.catch(() => {});
  tab.on('pageerror', wrong);
  tab.on('console', (message) => {
    if (process.env.VERBOSE) console.error(message.type(), message.text());
    if (message.type() === 'error') failed.push(message.text());
  });
  await tab.route('**/*', (route) => {
    const path = decodeURIComponent(new URL(route.request().url()).pathname);
    if (path === '/') return route.fulfill({ body: page, contentType: 'text/html' });
    const found = path === '/scene.js' ? file : join(packages, path);
    if (!existsSync(found)) {
      failed.push(`it asks for ${path}`);
      return route.fulfill({ status: 404 });
    }
    return route.fulfill({ body: readFileSync(found), contentType: TYPES[extname(found)] ?? 'application/octet-stream' });
  });
  await tab.goto('http://localhost/');
  await Promise.race([tab.waitForFunction('window.ready', null, { timeout: 120_000 }), broken]);
  const shot = async (name, shown, cubed) => {
    const began = Date.now();
    // Twice: what is compiled on the way is there the second time.
    for (let i = 0; i < 2; i += 1) {
      await Promise.race([tab.evaluate(([shown, cubed]) => window.draw(shown, cubed), [shown, cubed]), broken]);
      await tab.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));
    }
    await tab.locator('canvas').screenshot({ path: join(folder, `${name}.png`), timeout: 300_000 });
    console.log(`${name} ${Date.now() - began} ms`);
  };
  await shot('plain', true, false);
  await shot('with', true, true);
  await shot('cube', false, true);
  if (moved) {
    await tab.evaluate(([name, value]) => window.set(name, Number(value)), moved.split('='));
    await shot('moved', true, false);
  }
} catch (error) {
  failed.push(error.message);
} finally {
  await browser.close();
  rmSync(profile, { recursive: true, force: true });
}
if (failed.length) {
  console.error(`engines: ${failed.join('\nengines: ')}`);
  process.exitCode = 1;
}
