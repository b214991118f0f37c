// The playground: a text, what the compiler says of it, and its picture.

import { Compiler } from './surefoot/surefoot.js';
import { open } from './surefoot/draw.js';
import { show } from './surefoot/show.js';
import { Compiling } from './compiling.js';
import { editor } from './editor.js';
import { packed, unpacked } from './link.js';

// How long a text rests before it is compiled, in milliseconds.
const REST = 120;
// The file of a host that a person most likely wants first stands first.
const HOSTS = {
  html: 'a page', three: 'three.js, WebGPU', 'three-webgl': 'three.js, WebGL', babylon: 'Babylon.js', playcanvas: 'PlayCanvas', 'wgpu-py': 'Python, wgpu-py', godot: 'Godot', bevy: 'Bevy',
  shadertoy: 'shadertoy.com', wgsl: 'WGSL functions', glsl450: 'GLSL 4.50', vulkan: 'Vulkan, SPIR-V', hlsl: 'Direct3D, HLSL', msl: 'Metal, MSL',
};
const KEPT = 'surefoot.text';

const of = (id) => document.getElementById(id);
const [canvas, cover, stale, status, problems] = [document.querySelector('canvas'), of('cover'), of('stale'), of('status'), of('problems')];
const element = (name, more, ...children) => {
  const made = Object.assign(document.createElement(name), more);
  made.append(...children);
  return made;
};
// What a browser keeps between visits; some keep nothing.
const storage = {
  get: (key) => { try { return localStorage.getItem(key); } catch { return null; } },
  set: (key, value) => { try { localStorage.setItem(key, value); } catch { /* Then it is not kept. */ } },
};

function themes() {
  const root = document.documentElement;
  const known = storage.get('surefoot.theme');
  if (known) root.dataset.theme = known;
  of('theme').addEventListener('click', () => {
    const isDark = (root.dataset.theme ?? (matchMedia('(prefers-color-scheme: light)').matches ? 'light' : 'dark')) === 'dark';
    root.dataset.theme = isDark ? 'light' : 'dark';
    storage.set('surefoot.theme', root.dataset.theme);
  });
}

async function loaded() {
  const get = async (path) => {
    const response = await fetch(new URL(path, import.meta.url));
    if (!response.ok) throw new Error(`${path}: ${response.status} ${response.statusText}`);
    return response;
  };
  const [module, examples] = await Promise.all([
    get('surefoot/surefoot.wasm').then((response) => response.arrayBuffer()).then((bytes) => WebAssembly.compile(bytes)),
    get('examples.json').then((response) => response.json()),
  ]);
  return { module, examples };
}

// The picture: what is drawn on the canvas, and what a person moved in it.
class Picture {
  #way = null;
  #picture = null;
  #shown = null;
  #ending = null;

  get by() { return this.#way?.name; }

  // What a person moved.
  kept() { return this.#shown?.kept() ?? null; }

  // Shows a scene in place of the one before, once it is ready.
  async show(drawn, before) {
    const scene = { ...drawn, code: () => drawn.wgsl, glsl: () => drawn.glsl, buffers: () => drawn.buffers };
    const block = new Float32Array(new Uint32Array(scene.start).buffer);
    scene.block = block;
    const lost = (why) => { cover.textContent = `${why}\nLoad the page again.`; };
    let picture;
    if (this.#way) picture = await this.#way.prepare(scene);
    else ({ way: this.#way, picture } = await open(canvas, scene, lost));
    const kept = before ?? this.kept();
    this.#ending?.abort();
    // The one before may still be drawn.
    const old = this.#picture;
    if (old) setTimeout(() => old.free(), 2000);
    this.#picture = picture;
    this.#ending = new AbortController();
    this.#shown = show(canvas, this.#way, picture, scene, { form: of('sliders'), pause: of('pause'), signal: this.#ending.signal, before: kept });
    await this.#shown.rests();
  }
}

function list(found, text) {
  problems.replaceChildren(...found.map((one) => {
    const place = one.file === name() ? `${one.line}:${one.column}` : one.file;
    const button = element('button', { type: 'button', className: one.severity },
      element('span', { className: 'place', textContent: place }),
      element('span', { className: 'message', textContent: one.message }),
      element('span', { className: 'help', textContent: one.help }));
    button.addEventListener('click', () => one.file === name() && text.go(one.start));
    return element('li', {}, button);
  }));
}

// Which example the text was, and what its file is called.
let title = 'scene';
const name = () => `${title}.sdf`;

// A list for each parameter that is a choice: another choice is another module.
function choices(parameters, set, change) {
  const all = parameters.filter((parameter) => parameter.type === 'choice');
  const known = [...of('choices').querySelectorAll('select')].map((select) => select.name + [...select.options].map((option) => option.value)).join();
  if (known === all.map((parameter) => parameter.name + parameter.choices).join()) return;
  of('choices').replaceChildren(...all.map((parameter) => {
    const select = element('select', { name: parameter.name }, ...parameter.choices.map((choice) => element('option', { value: choice, textContent: choice })));
    select.value = set[parameter.name] ?? parameter.default;
    select.addEventListener('change', () => {
      set[parameter.name] = select.value;
      change();
    });
    return element('label', {}, parameter.name, select);
  }));
}

function download(file, data) {
  const link = element('a', { href: URL.createObjectURL(new Blob([data])), download: file });
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10_000);
}

async function start() {
  themes();
  // Where the picture is small, the sliders over it are folded away at first.
  of('panel').open = !matchMedia('(max-width: 760px)').matches;
  for (const [value, words] of Object.entries(HOSTS)) of('host').append(element('option', { value, textContent: words }));
  const { module, examples } = await loaded();
  const compiling = new Compiling(module);
  const picture = new Picture();
  let set = {}, before = null, timer = 0, blind = null;

  const options = () => {
    // Only what the text may still choose is said.
    const known = of('choices').querySelectorAll('select');
    const chosen = Object.fromEntries([...known].filter((select) => select.name in set).map((select) => [select.name, set[select.name]]));
    return { name: name(), files: examples.files, set: before?.set ?? chosen };
  };
  async function compile() {
    const words = text.text();
    storage.set(KEPT, JSON.stringify({ title, text: words }));
    document.body.dataset.state = 'busy';
    const slow = setTimeout(() => { status.textContent = 'Compiling …'; }, 300);
    const since = performance.now();
    let answer;
    try {
      answer = await compiling.latest('draw', words, options());
    } catch (error) {
      // A choice that the text no longer has is forgotten.
      if (Object.keys(options().set).length) {
        of('choices').replaceChildren();
        [set, before] = [{}, null];
        return compile();
      }
      answer = { scene: null, diagnostics: [], parameters: [], notes: [], failed: error.message };
    } finally {
      clearTimeout(slow);
    }
    if (!answer || words !== text.text()) return;
    const took = performance.now() - since;
    const { scene, diagnostics } = answer;
    text.underline(diagnostics, name());
    list(diagnostics, text);
    const errors = diagnostics.filter((one) => one.severity === 'error').length;
    let failed = answer.failed ?? (errors || scene ? null : 'Nothing in this text can be drawn.');
    of('download').disabled = !scene;
    if (scene) {
      choices(answer.parameters, set, again);
      try {
        cover.textContent = picture.by ? '' : 'The picture is made …';
        await picture.show(scene, before?.kept);
        before = null;
        cover.textContent = '';
        canvas.dataset.by = picture.by;
      } catch (error) {
        failed = error.message;
        // Where nothing draws, that stays to be said.
        if (!picture.by) blind = failed;
      }
    }
    if (words !== text.text()) return;
    if (failed && !picture.by) cover.textContent = failed;
    else if (!picture.by) cover.textContent = blind ?? 'The picture comes when the text has no errors.';
    stale.hidden = Boolean(scene && !failed) || !picture.by;
    const notes = (answer.notes ?? []).map((note) => `left out: ${note}`);
    const count = (n, what) => `${n} ${what}${n === 1 ? '' : 's'}`;
    const said = failed ?? (errors ? count(errors, 'error') : [`Compiled in ${took < 1000 ? `${Math.round(took)} ms` : `${(took / 1000).toFixed(1)} s`}, drawn by ${picture.by === 'webgl' ? 'WebGL 2' : 'WebGPU'}`, ...notes].join(' · '));
    status.textContent = said;
    status.title = said;
    document.body.dataset.state = failed || errors ? 'wrong' : 'drawn';
  }
  const again = () => {
    clearTimeout(timer);
    document.body.dataset.state = 'busy';
    timer = setTimeout(compile, REST);
  };
  const text = editor(of('text'), new Compiler(module), again);

  for (const example of examples.scenes) of('examples').append(element('option', { value: example.name, textContent: example.name.replaceAll('_', ' ') }));
  const see = (scene) => {
    title = scene.title ?? 'scene';
    of('examples').value = examples.scenes.some((example) => example.name === title) ? title : '';
    of('choices').replaceChildren();
    [set, before] = [scene.set ?? {}, scene.kept || scene.set ? { kept: scene.kept ?? { parameters: {} }, set: scene.set ?? {} } : { kept: { parameters: {} }, set: {} }];
    text.write(scene.text);
    again();
  };
  const example = (wanted) => examples.scenes.find((scene) => scene.name === wanted) ?? examples.scenes[0];
  of('examples').addEventListener('change', () => {
    const chosen = examples.scenes.find((scene) => scene.name === of('examples').value);
    if (!chosen) return;
    history.replaceState(null, '', location.pathname + location.search);
    see({ title: chosen.name, text: chosen.text });
  });
  of('share').addEventListener('click', async () => {
    const { scale, ...kept } = picture.kept() ?? {};
    const link = new URL(await packed({ title, text: text.text(), kept, set: options().set }), location.href);
    history.replaceState(null, '', link);
    try {
      await navigator.clipboard.writeText(link.href);
      status.textContent = 'The link with this scene is copied. It stands in the address bar, too.';
    } catch {
      status.textContent = 'The address bar has the link with this scene.';
    }
  });
  of('download').addEventListener('click', async () => {
    const host = of('host').value;
    status.textContent = 'Writing …';
    try {
      const { output, file, beside } = await compiling.ask('compile', text.text(), { ...options(), for: host });
      download(file, output);
      for (const [name, data] of Object.entries(beside)) download(name, data);
      status.textContent = `Written: ${[file, ...Object.keys(beside)].join(', ')}`;
    } catch (error) {
      status.textContent = error.message;
    }
  });
  async function opened() {
    let linked = null;
    try {
      linked = await unpacked(location.hash);
    } catch (error) {
      status.textContent = `The link can't be read: ${error.message}`;
    }
    return linked;
  }
  addEventListener('hashchange', async () => {
    const linked = await opened();
    if (linked) see(linked);
  });
  const last = () => {
    try {
      const kept = JSON.parse(storage.get(KEPT) ?? 'null');
      return typeof kept?.text === 'string' && kept.text.trim() ? kept : null;
    } catch {
      return null;
    }
  };
  const first = example('still_life');
  see((await opened()) ?? last() ?? { title: first.name, text: first.text });
}

start().catch((error) => {
  cover.textContent = `The playground can't start: ${error.message}`;
  document.body.dataset.state = 'failed';
});
