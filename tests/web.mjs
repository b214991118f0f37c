// Opens the web page of examples/hosts in Chromium without a screen, waits until it has drawn, and writes what the canvas shows:
//
//     node web.mjs scene.wgsl picture.png 'eye=4,3,6&target=0,0,0&fov=40'
//
// The rest of the last argument is the page's own. CHROMIUM names the browser, /usr/bin/chromium where it does not.

import { createReadStream, existsSync, mkdtempSync, rmSync } from 'node:fs';
import { createServer } from 'node:http';
import { tmpdir } from 'node:os';
import { extname, join, normalize } from 'node:path';
import { fileURLToPath } from 'node:url';
import { chromium } from 'playwright-core';

const [scene, picture, query = ''] = process.argv.slice(2);
if (!picture) {
  console.error('usage: node web.mjs scene.wgsl picture.png [QUERY]');
  process.exit(2);
}

const root = fileURLToPath(new URL('../examples/hosts', import.meta.url));
const types = { '.html': 'text/html', '.js': 'text/javascript', '.wgsl': 'text/plain' };
const server = createServer((request, response) => {
  const path = normalize(new URL(request.url, 'http://localhost').pathname);
  const file = path === '/scene.wgsl' ? scene : join(root, path.endsWith('/') ? `${path}index.html` : path);
  if (!existsSync(file)) {
    response.writeHead(404).end();
    return;
  }
  response.writeHead(200, { 'content-type': types[extname(file)] ?? 'application/octet-stream' });
  createReadStream(file).pipe(response);
});
await new Promise((ready) => server.listen(0, '127.0.0.1', ready));

const profile = mkdtempSync(join(tmpdir(), 'surefoot-web-'));
const browser = await chromium.launchPersistentContext(profile, {
  executablePath: process.env.CHROMIUM ?? '/usr/bin/chromium',
  headless: true,
  viewport: { width: 1280, height: 800 },
  ignoreDefaultArgs: ['--disable-gpu'],
  args: [
    '--no-sandbox', '--disable-quic', '--no-first-run', '--disable-background-networking', '--disable-component-update',
    '--disable-sync', '--disable-default-apps',
    // A canvas shows what WebGPU draws only where the rest of the page is drawn by the same software driver.
    '--enable-unsafe-webgpu', '--enable-features=Vulkan', '--use-vulkan=swiftshader', '--use-angle=vulkan',
  ],
});
let failed = [];
try {
  const page = await browser.newPage();
  page.on('pageerror', (error) => failed.push(error.message));
  page.on('console', (message) => message.type() === 'error' && failed.push(message.text()));
  await page.goto(`http://127.0.0.1:${server.address().port}/web/?${query}`);
  await page.waitForSelector('body[data-state]', { timeout: 120_000 });
  const says = await page.textContent('#says');
  if (says) failed.push(says);
  await page.locator('canvas').screenshot({ path: picture, timeout: 120_000 });
} catch (error) {
  failed.push(error.message);
} finally {
  await browser.close();
  server.close();
  rmSync(profile, { recursive: true, force: true });
}
if (failed.length) {
  console.error(`web: ${failed.join('\nweb: ')}`);
  process.exitCode = 1;
}
