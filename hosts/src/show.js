// Shows a scene on a canvas: draws when something changed, turns the view, moves the time, and has a slider for each parameter.
//
// `scene` is what `compile --for html` writes of it: `start` and `fields` of its uniforms, `parameters`, and whether it `moves`. `uniforms` adds its `block`.

// A picture while something moves takes no longer than this, in milliseconds; else it has fewer pixels.
const LONGEST = 40;

// The uniforms of a scene, and where each of them stands.
export function uniforms(scene) {
  scene.block ??= new Float32Array(new Uint32Array(scene.start).buffer);
  const at = (name) => scene.fields[name];
  return {
    block: scene.block,
    at,
    set: (name, values) => {
      if (at(name) !== undefined) scene.block.set(values, at(name));
    },
    three: (name) => Array.from(scene.block.subarray(at(name), at(name) + 3)),
  };
}

// Draws a scene that is ready. `way` and `picture` are those of `open` in draw.js. `form` takes the sliders, `pause` is a button; each may be null. `signal` ends
// it. `before` is what `kept()` of the scene before gave: what a person moved stays, unless the text moved it too. `began` is told of the first picture.
// Gives `kept`, and `rests`, which waits for a picture with all its pixels.
export function show(canvas, way, picture, scene, { form = null, pause = null, signal, before = null, began = () => {} } = {}) {
  const known = uniforms(scene);
  const { block, at, set } = known;
  const begin = at('time') === undefined ? 0 : block[at('time')];
  if (before) restore(scene, known, before);
  async function draw(scale) {
    const pixels = devicePixelRatio * scale;
    const side = (length) => Math.min(Math.max(1, Math.round(length * pixels)), way.most);
    const [width, height] = [side(canvas.clientWidth), side(canvas.clientHeight)];
    if (canvas.width !== width || canvas.height !== height) Object.assign(canvas, { width, height });
    set('view_size', [width, height]);
    const since = performance.now();
    await picture.draw(width, height);
    return performance.now() - since;
  }

  // What changed is drawn at once, with fewer pixels where that takes long, and once more with all of them when it rests.
  let due = false, moved = 0, changes = 0, scale = before?.scale ?? 0.5, busy = true, sharp = false, last = null;
  let running = scene.moves && (before?.running ?? true);
  const change = () => {
    moved = performance.now();
    changes += 1;
    canvas.dataset.sharp = sharp = false;
    if (!due) requestAnimationFrame(turn);
    due = true;
  };
  async function turn(now) {
    due = false;
    if (busy || signal?.aborted) return;
    busy = true;
    if (running && last !== null) set('time', [block[at('time')] + (now - last) / 1000]);
    last = running ? now : null;
    const seen = changes;
    const rests = !running && performance.now() - moved > 150;
    const took = await draw(rests ? 1 : scale);
    if (!rests) scale = Math.min(1, Math.max(0.2, scale * Math.min(1.2, Math.max(0.5, Math.sqrt(LONGEST / Math.max(took, 1))))));
    // What changed while this was drawn is drawn next.
    sharp = seen === changes && (rests || scale === 1);
    busy = false;
    if (signal?.aborted) return;
    canvas.dataset.sharp = sharp;
    if ((running || !sharp) && !due) {
      due = true;
      requestAnimationFrame(turn);
    }
  }
  const label = () => {
    if (pause) pause.textContent = running ? 'Pause' : 'Play';
  };
  const play = () => {
    running = !running;
    last = null;
    label();
    change();
  };
  if (pause) pause.hidden = at('time') === undefined;
  if (at('time') !== undefined) {
    label();
    pause?.addEventListener('click', play, { signal });
    canvas.addEventListener('keydown', (event) => {
      if (event.key !== ' ') return;
      play();
      event.preventDefault();
    }, { signal });
  }
  if (form) parameters(form, scene, known, change, signal);
  const view = orbit(canvas, known, begin, before?.view, change, signal);
  const resized = new ResizeObserver(change);
  resized.observe(canvas);
  signal?.addEventListener('abort', () => resized.disconnect());
  const first = (async () => {
    // The first picture is small, so that it is there at once; the next one is not.
    await draw(before ? scale : 0.25);
    busy = false;
    if (signal?.aborted) return;
    began();
    change();
  })();
  return {
    kept: () => ({ scale, running, time: at('time') === undefined ? null : block[at('time')], view: view(), parameters: changed(scene, known) }),
    rests: async () => {
      await first;
      while (!(sharp || running) && !signal?.aborted) await new Promise((go) => { setTimeout(go, 20); });
    },
  };
}

// The components of the parameters that the module reads, each with its place in the block and its range.
function* components(scene, { at }) {
  for (const p of scene.parameters) {
    const place = at(`parameter ${p.name}`);
    if (place === undefined) continue;
    const [least, most] = [[p.min].flat(), [p.max].flat()];
    for (let i = 0; i < (p.type === 'color' ? 3 : least.length); i++) yield { name: `${p.name}.${i}`, place: place + i, least: least[i] ?? 0, most: most[i] ?? 1 };
  }
}

// The components that are not as the text has them: what the text has, and what they are.
function changed(scene, known) {
  const start = new Float32Array(new Uint32Array(scene.start).buffer);
  const all = [...components(scene, known)].filter(({ place }) => start[place] !== known.block[place]);
  return Object.fromEntries(all.map(({ name, place }) => [name, [start[place], known.block[place]]]));
}

// Puts back what a person changed, where the text still has what it had, and the time.
function restore(scene, known, before) {
  const { block, at } = known;
  if (at('time') !== undefined && Number.isFinite(before.time)) block[at('time')] = before.time;
  for (const { name, place, least, most } of components(scene, known)) {
    const [was, is] = before.parameters?.[name] ?? [];
    if (was === block[place] && Number.isFinite(is)) block[place] = Math.min(Math.max(is, least), most);
  }
}

// The eye goes around what it looks at: drag, or two fingers or the wheel to go nearer; a double click goes back. The key Home does so, and puts the time
// back, too.
function orbit(canvas, { block, at, set, three }, began, kept, change, signal) {
  const home = { eye: three('view_eye'), aim: three('view_look_at'), height: at('view_height') === undefined ? 0 : block[at('view_height')] };
  const way = home.eye.map((c, i) => c - home.aim[i]);
  let turn, rise, far, nearer;
  const reset = () => {
    far = Math.hypot(...way);
    turn = Math.atan2(way[0], way[2]);
    rise = Math.asin(Math.max(-1, Math.min(1, way[1] / Math.max(far, 1e-9))));
    nearer = 1;
  };
  const place = () => {
    const [c, s, cr, sr] = [Math.cos(turn), Math.sin(turn), Math.cos(rise), Math.sin(rise)];
    const parallel = at('view_height') !== undefined;
    const away = parallel ? far : far * nearer;
    set('view_eye', [home.aim[0] + away * s * cr, home.aim[1] + away * sr, home.aim[2] + away * c * cr]);
    if (parallel) set('view_height', [home.height * nearer]);
    change();
  };
  const zoom = (by) => {
    nearer = Math.min(20, Math.max(0.05, nearer * by));
    place();
  };
  reset();
  // The view that a person chose stays as long as the scene's own camera does.
  const stays = kept && JSON.stringify(kept.home) === JSON.stringify(home);
  if (stays && [turn !== kept.turn, rise !== kept.rise, nearer !== kept.nearer].some(Boolean)) {
    ({ turn, rise, nearer } = kept);
    place();
  }
  const fingers = new Map();
  const apart = () => {
    const [a, b] = [...fingers.values()];
    return Math.hypot(a.x - b.x, a.y - b.y);
  };
  canvas.addEventListener('pointerdown', (event) => {
    canvas.setPointerCapture(event.pointerId);
    fingers.set(event.pointerId, { x: event.clientX, y: event.clientY });
  }, { signal });
  canvas.addEventListener('pointermove', (event) => {
    const known = fingers.get(event.pointerId);
    if (!known) return;
    const before = fingers.size === 2 ? apart() : 0;
    const [dx, dy] = [event.clientX - known.x, event.clientY - known.y];
    Object.assign(known, { x: event.clientX, y: event.clientY });
    if (fingers.size === 2) {
      zoom(before / Math.max(apart(), 1));
    } else {
      turn -= dx * 0.008;
      rise = Math.min(1.55, Math.max(-1.55, rise + dy * 0.008));
      place();
    }
  }, { signal });
  for (const end of ['pointerup', 'pointercancel']) canvas.addEventListener(end, (event) => fingers.delete(event.pointerId), { signal });
  canvas.addEventListener('wheel', (event) => {
    event.preventDefault();
    zoom(Math.exp(event.deltaY * (event.deltaMode ? 0.05 : 0.0015)));
  }, { passive: false, signal });
  canvas.addEventListener('dblclick', () => { reset(); place(); }, { signal });
  const keys = {
    ArrowLeft: () => { turn -= 0.1; },
    ArrowRight: () => { turn += 0.1; },
    ArrowUp: () => { rise = Math.min(1.55, rise + 0.1); },
    ArrowDown: () => { rise = Math.max(-1.55, rise - 0.1); },
    '+': () => { nearer = Math.max(0.05, nearer / 1.1); },
    '-': () => { nearer = Math.min(20, nearer * 1.1); },
    Home: () => {
      reset();
      set('time', [began]);
    },
  };
  canvas.addEventListener('keydown', (event) => {
    if (!keys[event.key] || event.ctrlKey || event.metaKey) return;
    keys[event.key]();
    place();
    event.preventDefault();
  }, { signal });
  return () => ({ home, turn, rise, nearer });
}

// A slider, a box or a colour for each parameter that the module reads.
function parameters(form, scene, { block, at }, change, signal) {
  form.replaceChildren();
  form.addEventListener('submit', (event) => event.preventDefault(), { signal });
  const encode = (c) => (c <= 0.0031308 ? 12.92 * c : 1.055 * c ** (1 / 2.4) - 0.055);
  const decode = (c) => (c <= 0.04045 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4);
  const add = (name, input, shown, take) => {
    const label = document.createElement('label');
    const value = document.createElement('output');
    value.value = shown();
    input.addEventListener('input', () => {
      take();
      value.value = shown();
      change();
    });
    label.append(name, input, value);
    form.append(label);
  };
  const made = (type, more) => Object.assign(document.createElement('input'), { type, ...more });
  for (const p of scene.parameters) {
    const place = at(`parameter ${p.name}`);
    if (place === undefined) continue;
    if (p.type === 'color') {
      const bytes = () => [0, 1, 2].map((i) => Math.round(255 * encode(Math.min(1, Math.max(0, block[place + i])))));
      const hex = () => `#${bytes().map((b) => b.toString(16).padStart(2, '0')).join('')}`;
      const input = made('color', { value: hex() });
      add(p.name, input, hex, () => {
        [1, 3, 5].forEach((from, i) => { block[place + i] = decode(parseInt(input.value.slice(from, from + 2), 16) / 255); });
      });
      continue;
    }
    if (p.type === 'bool') {
      const input = made('checkbox', { checked: block[place] !== 0 });
      add(p.name, input, () => '', () => { block[place] = Number(input.checked); });
      continue;
    }
    const unit = p.degrees ? Math.PI / 180 : 1;
    const [least, most] = [[p.min].flat(), [p.max].flat()];
    least.forEach((_, i) => {
      const input = made('range', { min: least[i] / unit, max: most[i] / unit, step: p.type === 'int' ? 1 : 'any' });
      input.valueAsNumber = block[place + i] / unit;
      const name = least.length > 1 ? `${p.name}.${'xyzw'[i]}` : p.name;
      const shown = () => `${Number((block[place + i] / unit).toPrecision(3))}${p.degrees ? '°' : ''}`;
      add(name, input, shown, () => { block[place + i] = input.valueAsNumber * unit; });
    });
  }
}
