// Opens what `surefoot compile --for` wrote in Chromium without a screen, and writes what it shows:
//
//     node hosts.mjs scene.html picture.png        a page, from its file, as a person opens it
//     node hosts.mjs scene.html picture.png webgl  the same where the browser has no WebGPU
//     node hosts.mjs scene.glsl picture.png [X,Y]  a shader for shadertoy.com, with what that page gives it: no mouse, or one dragged so far
//
// CHROMIUM names the browser, /usr/bin/chromium where it does not.

import { mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join, resolve } from 'node:path';
import { pathToFileURL } from 'node:url';
import { chromium } from 'playwright-core';

const [file, picture, how = '0,0'] = process.argv.slice(2);
if (!picture) {
  console.error('usage: node hosts.mjs scene.html|scene.glsl picture.png [X,Y]');
  process.exit(2);
}
const folder = mkdtempSync(join(tmpdir(), 'surefoot-hosts-'));

// What shadertoy.com puts before a shader and behind it, and draws once.
function shadertoy(text) {
  const before = '#version 300 es\nprecision highp float;\nprecision highp int;\nuniform vec3 iResolution;\nuniform float iTime;\nuniform vec4 iMouse;\nout vec4 color;\n';
  const after = '\nvoid main() { vec4 c = vec4(1e20); mainImage(c, gl_FragCoord.xy); color = vec4(c.rgb, 1.0); }\n';
  const script = `
    const gl = document.querySelector('canvas').getContext('webgl2', { preserveDrawingBuffer: true });
    const program = gl.createProgram();
    for (const [type, text] of [[gl.VERTEX_SHADER, '#version 300 es\\nin vec2 at; void main() { gl_Position = vec4(at, 0.0, 1.0); }'], [gl.FRAGMENT_SHADER, ${JSON.stringify(before + text + after)}]]) {
      const shader = gl.createShader(type);
      gl.shaderSource(shader, text);
      gl.compileShader(shader);
      if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) throw new Error(gl.getShaderInfoLog(shader));
      gl.attachShader(program, shader);
    }
    gl.linkProgram(program);
    if (!gl.getProgramParameter(program, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(program));
    gl.useProgram(program);
    gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer());
    gl.bufferData(gl.ARRAY_BUFFER, new Float32Array([-1, -1, 3, -1, -1, 3]), gl.STATIC_DRAW);
    const at = gl.getAttribLocation(program, 'at');
    gl.enableVertexAttribArray(at);
    gl.vertexAttribPointer(at, 2, gl.FLOAT, false, 0, 0);
    gl.uniform3f(gl.getUniformLocation(program, 'iResolution'), 640, 360, 1);
    gl.uniform1f(gl.getUniformLocation(program, 'iTime'), 0);
    const [x, y] = [${how}];
    gl.uniform4f(gl.getUniformLocation(program, 'iMouse'), 320 + x, 180 + y, 320, -180);
    gl.drawArrays(gl.TRIANGLES, 0, 3);
    gl.finish();
    document.body.dataset.state = 'drawn';`;
  const page = join(folder, 'shadertoy.html');
  writeFileSync(page, `<!doctype html><body style="margin:0"><canvas width="640" height="360"></canvas><p id="says"></p><script>${script.replaceAll('</', '<\\/')}</script>`);
  return page;
}

const page = file.endsWith('.html') ? resolve(file) : shadertoy(readFileSync(file, 'utf8'));
const browser = await chromium.launchPersistentContext(join(folder, 'profile'), {
  executablePath: process.env.CHROMIUM ?? '/usr/bin/chromium',
  headless: true,
  viewport: { width: 640, height: 360 },
  ignoreDefaultArgs: ['--disable-gpu'],
  args: [
    '--no-sandbox', '--disable-quic', '--no-first-run', '--disable-background-networking', '--disable-component-update',
    '--disable-sync', '--disable-default-apps',
    // WebGPU is shown only where the rest of the page is drawn by the same software driver; WebGL has one of its own.
    ...(file.endsWith('.html') && how !== 'webgl'
      ? ['--enable-unsafe-webgpu', '--enable-features=Vulkan', '--use-vulkan=swiftshader', '--use-angle=vulkan']
      : ['--use-angle=swiftshader', '--enable-unsafe-swiftshader', '--ignore-gpu-blocklist']),
  ],
});
const failed = [];
try {
  const tab = await browser.newPage();
  tab.on('pageerror', (error) => failed.push(error.message));
  tab.on('console', (message) => message.type() === 'error' && failed.push(message.text()));
  tab.on('request', (request) => /^(file|data|blob):/.test(request.url()) || failed.push(`it asks for ${request.url()}`));
  const wrong = new Promise((_, reject) => tab.on('pageerror', reject));
  await tab.goto(pathToFileURL(page).href);
  await Promise.race([tab.waitForSelector('body[data-state]', { timeout: 240_000 }), wrong]);
  const says = await tab.textContent('#says');
  if (says) failed.push(says);
  const by = await tab.evaluate(() => document.body.dataset.by);
  if (by) console.log(`first picture after ${((await tab.evaluate(() => Number(document.body.dataset.first))) / 1000).toFixed(1)} s, by ${by}`);
  if (by && (by === 'webgl') !== (how === 'webgl')) failed.push(`it is drawn by ${by}`);
  // A page whose time goes on draws again and again, with fewer pixels; the space bar stops it, and Home puts it back. Parameters stand over its picture.
  for (const key of [' ', 'Home']) await tab.evaluate((key) => document.querySelector('canvas').dispatchEvent(new KeyboardEvent('keydown', { key })), key);
  if (by) await tab.waitForSelector('canvas[data-sharp=true]', { timeout: 240_000 });
  await tab.evaluate(() => document.querySelector('details')?.remove());
  await tab.locator('canvas').screenshot({ path: picture, timeout: 240_000 });
} catch (error) {
  failed.push(error.message);
} finally {
  await browser.close();
  rmSync(folder, { recursive: true, force: true });
}
if (failed.length) {
  console.error(`hosts: ${failed.join('\nhosts: ')}`);
  process.exitCode = 1;
}
