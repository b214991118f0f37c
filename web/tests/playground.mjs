// Opens the playground that web/build.mjs made in Chromium without a screen, and uses it:
//
//     node playground.mjs FOLDER PICTURES          FOLDER is target/web/playground; PICTURES takes what was seen
//     node playground.mjs FOLDER PICTURES webgl    the same where the browser has no WebGPU
//
// `playground.png` among the pictures is docs/playground.png. CHROMIUM names the browser, /usr/bin/chromium where it does not.

import assert from 'node:assert/strict';
import { createReadStream, existsSync, mkdirSync, mkdtempSync, readFileSync, rmSync } from 'node:fs';
import { createServer } from 'node:http';
import { createRequire } from 'node:module';
import { tmpdir } from 'node:os';
import { extname, join, normalize, resolve } from 'node:path';
import { deflateRawSync } from 'node:zlib';

const { chromium } = createRequire(new URL('../../tests/package.json', import.meta.url))('playwright-core');
const { PNG } = createRequire(new URL('../../tests/package.json', import.meta.url))('pngjs');
const [folder, pictures, how = 'webgpu'] = process.argv.slice(2);
if (!pictures) {
  console.error('usage: node playground.mjs FOLDER PICTURES [webgl]');
  process.exit(2);
}
mkdirSync(pictures, { recursive: true });

const types = { '.html': 'text/html', '.js': 'text/javascript', '.css': 'text/css', '.json': 'application/json', '.wasm': 'application/wasm' };
const server = createServer((request, response) => {
  const path = normalize(new URL(request.url, 'http://localhost').pathname);
  const file = join(resolve(folder), path.endsWith('/') ? `${path}index.html` : path);
  if (!existsSync(file)) {
    response.writeHead(404).end();
    return;
  }
  response.writeHead(200, { 'content-type': types[extname(file)] ?? 'application/octet-stream' });
  createReadStream(file).pipe(response);
});
await new Promise((ready) => server.listen(0, '127.0.0.1', ready));
const address = `http://127.0.0.1:${server.address().port}/`;

const profile = mkdtempSync(join(tmpdir(), 'surefoot-playground-'));
const drivers = {
  webgpu: ['--enable-unsafe-webgpu', '--enable-features=Vulkan', '--use-vulkan=swiftshader', '--use-angle=vulkan'],
  webgl: ['--use-angle=swiftshader', '--enable-unsafe-swiftshader', '--ignore-gpu-blocklist'],
  nothing: ['--disable-gpu', '--disable-3d-apis', '--disable-software-rasterizer'],
};
const open = (name, args) => chromium.launchPersistentContext(join(profile, name), {
  executablePath: process.env.CHROMIUM ?? '/usr/bin/chromium',
  headless: true,
  viewport: { width: 1200, height: 700 },
  colorScheme: 'dark',
  acceptDownloads: true,
  ignoreDefaultArgs: ['--disable-gpu'],
  args: ['--no-sandbox', '--disable-quic', '--no-first-run', '--disable-background-networking', '--disable-component-update', '--disable-sync', '--disable-default-apps', ...args],
});

const LONG = { timeout: 240_000 };
const failed = [];
// A page that asks for nothing from elsewhere and throws nothing.
async function page(browser, link = address) {
  const tab = await browser.newPage();
  tab.setDefaultTimeout(120_000);
  tab.on('pageerror', (error) => failed.push(error.message));
  tab.on('console', (message) => message.type() === 'error' && failed.push(message.text()));
  tab.on('request', (request) => request.url().startsWith(address) || /^(data|blob):/.test(request.url()) || failed.push(`it asks for ${request.url()}`));
  await tab.goto(link);
  return tab;
}
const drawn = async (tab) => {
  await tab.waitForSelector('body[data-state=drawn]', LONG);
  await tab.waitForSelector('canvas[data-sharp=true]', LONG);
};
// The picture as it is seen, without what stands over it.
const seen = async (tab, name) => {
  const hide = await tab.addStyleTag({ content: '#panel, #stale { visibility: hidden; }' });
  const png = PNG.sync.read(await tab.locator('canvas').screenshot({ path: join(pictures, `${name}.png`), ...LONG }));
  await hide.evaluate((style) => style.remove());
  return png;
};
// The share of pixels of two pictures whose colours are more than 12 levels apart.
const differ = (a, b) => {
  assert.deepEqual([a.width, a.height], [b.width, b.height]);
  let count = 0;
  for (let i = 0; i < a.data.length; i += 4) count += [0, 1, 2].some((c) => Math.abs(a.data[i + c] - b.data[i + c]) > 12);
  return count / (a.width * a.height);
};
const type = async (tab, text) => {
  await tab.locator('.cm-content').click();
  await tab.keyboard.press('Control+A');
  // As a paste: brackets would close themselves.
  await tab.keyboard.insertText(text);
};
const text = (tab) => tab.evaluate(() => [...document.querySelectorAll('.cm-line')].map((line) => line.textContent).join('\n'));

const scene = (body) => `param size = 0.5 in 0.2..1\nmaterial red { color: #d04030 }\nscene = plane(y) | ${body}\ncamera { eye: (2, 2, 4), target: (0, 0.5, 0) }`;
const red = (png) => {
  let count = 0;
  for (let i = 0; i < png.data.length; i += 4) count += png.data[i] > 90 && png.data[i] > 1.8 * png.data[i + 1] && png.data[i] > 1.8 * png.data[i + 2];
  return count / (png.width * png.height);
};

try {
  const browser = await open('one', drivers[how]);
  const tab = await page(browser);
  // It opens with an example, which is drawn.
  await drawn(tab);
  assert.equal(await tab.evaluate(() => document.querySelector('canvas').dataset.by), how);
  assert((await text(tab)).includes('//! '));
  await tab.screenshot({ path: join(pictures, 'open.png'), ...LONG });
  const before = await seen(tab, 'example');

  // A scene that is wrong: a squiggle, a message with its advice in a list and where the pointer is, and the picture stays.
  await type(tab, scene('sphre(size).translate(0, 0.5, 0).material(red)'));
  await tab.waitForSelector('body[data-state=wrong]', LONG);
  assert.equal(await tab.locator('.cm-lintRange-error').first().textContent(), 'sphre');
  const item = await tab.locator('#problems li').first().innerText();
  assert(item.includes('3:20') && item.includes('nothing is named `sphre`') && item.includes('did you mean `sphere`?'), item);
  await tab.locator('.cm-lintRange-error').first().hover();
  assert((await tab.locator('.cm-tooltip .cm-diagnostic').innerText()).includes('did you mean `sphere`?'));
  await tab.screenshot({ path: join(pictures, 'wrong.png'), ...LONG });
  await tab.mouse.move(900, 500);
  assert.equal(differ(before, await seen(tab, 'stays')), 0);

  // Mended: a red ball is seen, and nothing is underlined.
  await type(tab, scene('sphere(size).translate(0, 0.5, 0).material(red)'));
  await drawn(tab);
  assert.equal(await tab.locator('.cm-lintRange-error').count(), 0);
  assert.equal(await tab.locator('#problems li').count(), 0);
  const small = await seen(tab, 'ball');
  assert(red(small) > 0.02, `${red(small)} of the picture is red`);

  // The slider makes it larger: by the arrow keys, as the mouse does.
  const slider = tab.locator('#sliders input[type=range]');
  const box = await slider.boundingBox();
  await tab.mouse.move(box.x + box.width * 0.4, box.y + box.height / 2);
  await tab.mouse.down();
  await tab.mouse.move(box.x + box.width * 0.95, box.y + box.height / 2, { steps: 5 });
  await tab.mouse.up();
  assert(Number(await slider.inputValue()) > 0.85);
  await tab.mouse.move(900, 600);
  await drawn(tab);
  const large = await seen(tab, 'large');
  assert(red(large) > 1.5 * red(small), `${red(small)} and then ${red(large)} is red`);

  // A change of the text leaves the slider where it is.
  await type(tab, scene('sphere(size).translate(0, 0.5, 0).material(red) // a ball'));
  await drawn(tab);
  assert(differ(large, await seen(tab, 'kept')) < 0.001);

  // The link opens the same text and picture elsewhere.
  await tab.locator('#share').click();
  await tab.waitForFunction(() => location.hash.startsWith('#s='));
  const link = tab.url();
  const other = await page(browser, link);
  await drawn(other);
  assert.equal(await text(other), await text(tab));
  const again = differ(large, await seen(other, 'link'));
  assert(again < 0.001, `${again} of the picture differ`);
  await other.close();
  await tab.bringToFront();

  // A link with nonsense beside its text shows the text; one that can't be read says so.
  const nonsense = { text: 'scene = sphere(1)', title: 5, set: [1, {}], kept: { parameters: { 'size.0': 5, 'a.0': ['x', null] }, view: { turn: 'x' }, time: 'never' } };
  const odd = await page(browser, `${address}#s=${deflateRawSync(JSON.stringify(nonsense)).toString('base64url')}`);
  await drawn(odd);
  assert.equal(await text(odd), nonsense.text);
  await odd.evaluate(() => { location.hash = '#s=AAAA'; });
  await odd.waitForFunction(() => document.getElementById('status').textContent.startsWith("The link can't be read"));
  await odd.close();
  await tab.bringToFront();

  // What is downloaded is what the package writes.
  await tab.selectOption('#host', 'godot');
  const [download] = await Promise.all([tab.waitForEvent('download'), tab.locator('#download').click()]);
  assert(readFileSync(await download.path(), 'utf8').includes('shader_type spatial'));

  // Typing does not wait for a compilation: a key is seen at once while one runs that takes long.
  const costly = `scene = ${Array.from({ length: 24 }, (_, i) => `box(1).twist(y, 0.${i + 1}).twist(x, 0.${i + 1}).twist(z, 0.${i + 1}).translate(${3 * i}, 0, 0)`).join(' | ')}`;
  // A state that the page has for a short time only is noticed too.
  await tab.evaluate(() => {
    new MutationObserver(() => { window.busy ||= document.body.dataset.state === 'busy'; }).observe(document.body, { attributeFilter: ['data-state'] });
  });
  await type(tab, costly);
  await tab.waitForFunction(() => window.busy);
  const since = Date.now();
  await tab.keyboard.type('/');
  await tab.waitForFunction(() => document.querySelector('.cm-content').textContent.endsWith('/'));
  const waited = Date.now() - since;
  assert(waited < 1000, `a key takes ${waited} ms`);

  // An example, dark and light; on a telephone's width nothing is cut off.
  await tab.selectOption('#examples', 'still_life');
  await drawn(tab);
  await tab.screenshot({ path: join(pictures, 'dark.png'), ...LONG });
  const still = (await tab.evaluate(async () => (await fetch('examples.json')).json())).scenes.find((example) => example.name === 'still_life').text;
  await type(tab, still.replace('octahedron(', 'octahedrn('));
  await tab.keyboard.press('Control+Home');
  await tab.waitForSelector('body[data-state=wrong]', LONG);
  await tab.locator('.cm-lintRange-error').first().hover();
  await tab.waitForSelector('.cm-tooltip .cm-diagnostic');
  await tab.screenshot({ path: join(pictures, 'playground.png'), ...LONG });
  await type(tab, still);
  await tab.keyboard.press('Control+Home');
  await drawn(tab);
  await tab.locator('#theme').click();
  await tab.screenshot({ path: join(pictures, 'light.png'), ...LONG });
  await tab.setViewportSize({ width: 390, height: 780 });
  await tab.reload();
  await drawn(tab);
  assert(await tab.evaluate(() => document.documentElement.scrollWidth <= innerWidth && document.documentElement.scrollHeight <= innerHeight));
  await tab.screenshot({ path: join(pictures, 'phone.png'), ...LONG });
  await browser.close();

  // Without WebGPU and WebGL 2 the text is still checked, and the page says what is missing.
  if (how === 'webgl') {
    const blind = await open('two', drivers.nothing);
    const tab = await page(blind);
    await tab.waitForFunction(() => /no WebGL 2/.test(document.getElementById('cover').textContent), null, LONG);
    await type(tab, 'scene = bax(1)');
    await tab.waitForSelector('.cm-lintRange-error', LONG);
    await tab.screenshot({ path: join(pictures, 'nothing.png'), ...LONG });
    await blind.close();
  }
} catch (error) {
  failed.push(error.stack);
} finally {
  server.close();
  rmSync(profile, { recursive: true, force: true });
}
if (failed.length) {
  console.error(`playground: ${failed.join('\nplayground: ')}`);
  process.exit(1);
}
console.log(`the playground draws by ${how}`);
process.exit(0);
