import { mkdtempSync, readFileSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { pathToFileURL } from 'node:url';
import { chromium } from 'playwright-core';
const folder = mkdtempSync(join(tmpdir(), 'gl-'));
const limit = Number(process.env.LIMIT ?? 60) * 1000;
for (const file of process.argv.slice(2)) {
  const text = readFileSync(file, 'utf8');
  const before = '#version 300 es\nprecision highp float;\nprecision highp int;\nuniform vec3 iResolution;\nuniform float iTime;\nuniform vec4 iMouse;\nout vec4 color;\n';
  const after = '\nvoid main() { vec4 c = vec4(1e20); mainImage(c, gl_FragCoord.xy); color = vec4(c.rgb, 1.0); }\n';
  const script = `
    window.run = () => { const t0 = performance.now();
    const gl = document.querySelector('canvas').getContext('webgl2', { preserveDrawingBuffer: true });
    const program = gl.createProgram();
    const t = [performance.now()];
    for (const [type, text] of [[gl.VERTEX_SHADER, '#version 300 es\\nin vec2 at; void main() { gl_Position = vec4(at, 0.0, 1.0); }'], [gl.FRAGMENT_SHADER, ${JSON.stringify(before + text + after)}]]) {
      const shader = gl.createShader(type);
      gl.shaderSource(shader, text);
      gl.compileShader(shader);
      if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) throw new Error(gl.getShaderInfoLog(shader));
      gl.attachShader(program, shader);
    }
    { t.push(performance.now()); console.log(t.length); }
    gl.linkProgram(program);
    if (!gl.getProgramParameter(program, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(program));
    { t.push(performance.now()); console.log(t.length); }
    gl.useProgram(program);
    gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer());
    gl.bufferData(gl.ARRAY_BUFFER, new Float32Array([-1, -1, 3, -1, -1, 3]), gl.STATIC_DRAW);
    const at = gl.getAttribLocation(program, 'at');
    gl.enableVertexAttribArray(at);
    gl.vertexAttribPointer(at, 2, gl.FLOAT, false, 0, 0);
    gl.uniform3f(gl.getUniformLocation(program, 'iResolution'), 64, 36, 1);
    gl.uniform1f(gl.getUniformLocation(program, 'iTime'), 0);
    for (let i = 0; i < 2; i++) { gl.drawArrays(gl.TRIANGLES, 0, 3);
    const px = new Uint8Array(4); gl.readPixels(32, 18, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, px);
    { t.push(performance.now()); console.log(t.length); } }
    return t.slice(1).map((x, i) => ((x - t[i]) / 1000).toFixed(2)).join(' '); }`;
  const page = join(folder, 'p.html');
  writeFileSync(page, `<!doctype html><body style="margin:0"><canvas width="64" height="36"></canvas><script>${script.replaceAll('</', '<\\/')}</script>`);
  const browser = await chromium.launchPersistentContext(mkdtempSync(join(tmpdir(), 'gl-')), {
    executablePath: '/usr/bin/chromium', headless: true, ignoreDefaultArgs: ['--disable-gpu'],
    args: ['--no-sandbox', '--use-angle=swiftshader', '--enable-unsafe-swiftshader', '--ignore-gpu-blocklist', '--disable-gpu-watchdog'] });
  try {
    const tab = await browser.newPage(); let ph = 0; tab.on("console", (m) => { ph = m.text(); });
    await tab.goto(pathToFileURL(page).href);
    const r = await Promise.race([tab.evaluate(() => window.run()), new Promise((r) => setTimeout(() => r("TIMEOUT in phase " + ph), limit))]);
    console.log(file.split('/').pop().padEnd(22), r);
  } catch (e) { console.log(file, 'ERR', e.message.slice(0, 300)); }
  await Promise.race([browser.close(), new Promise((r) => setTimeout(r, 3000))]);
}
process.exit(0);
