
'use strict';
const scene = JSON.parse(document.getElementById('scene').textContent);
const canvas = document.querySelector('canvas');
const says = document.getElementById('says');

// The uniform block, and where each of its values stands.
const block = new Float32Array(new Uint32Array(scene.start).buffer);
const at = (name) => scene.fields[name];
const set = (name, values) => {
  if (at(name) !== undefined) block.set(values, at(name));
};
const three = (name) => Array.from(block.subarray(at(name), at(name) + 3));

// A picture while something moves takes no longer than this, in milliseconds; else it has fewer pixels.
const LONGEST = 40;

// What is packed in a text: zlib's form, in base 64.
const unpacked = (text) => {
  const bytes = Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
  return new Response(new Blob([bytes]).stream().pipeThrough(new DecompressionStream('deflate')));
};

// Each of the two ways to draw gives how to draw a picture of so many pixels, which ends when it is drawn, and how wide or high one may be.

async function webgpu() {
  const adapter = await navigator.gpu?.requestAdapter();
  if (!adapter) throw new Error('This browser offers no WebGPU. Chrome, Edge, Safari 26 and Firefox 141 do on most devices.');
  const device = await adapter.requestDevice();
  device.lost.then((why) => { says.textContent = `The graphics device is gone: ${why.message}`; });
  const code = await unpacked(document.getElementById('module').textContent).text();
  const module = device.createShaderModule({ code });
  const errors = (await module.getCompilationInfo()).messages.filter((m) => m.type === 'error');
  if (errors.length) throw new Error(errors.map((m) => `${m.lineNum}: ${m.message}`).join('\n'));
  const format = navigator.gpu.getPreferredCanvasFormat();
  const depthFormat = 'depth24plus';
  const pipeline = await device.createRenderPipelineAsync({
    layout: 'auto',
    vertex: { module, entryPoint: 'sf_vertex' },
    fragment: { module, entryPoint: 'sf_fragment', targets: [{ format }] },
    depthStencil: { format: depthFormat, depthWriteEnabled: true, depthCompare: 'always' },
  });
  const buffer = (bytes, usage) => {
    const made = device.createBuffer({ size: bytes.byteLength, usage: usage | GPUBufferUsage.COPY_DST });
    device.queue.writeBuffer(made, 0, bytes);
    return made;
  };
  const uniforms = buffer(block, GPUBufferUsage.UNIFORM);
  const numbers = await Promise.all(scene.buffers.map((text) => unpacked(text).arrayBuffer()));
  const tables = numbers.map((bytes) => buffer(bytes, GPUBufferUsage.STORAGE));
  const group = device.createBindGroup({
    layout: pipeline.getBindGroupLayout(0),
    entries: [uniforms, ...tables].map((made, binding) => ({ binding, resource: { buffer: made } })),
  });
  const context = canvas.getContext('webgpu');
  context.configure({ device, format });
  let depth = null;
  async function draw(width, height) {
    if (depth?.width !== width || depth?.height !== height) {
      depth?.destroy();
      depth = device.createTexture({ size: [width, height], format: depthFormat, usage: GPUTextureUsage.RENDER_ATTACHMENT });
    }
    device.queue.writeBuffer(uniforms, 0, block);
    const encoder = device.createCommandEncoder();
    const pass = encoder.beginRenderPass({
      colorAttachments: [{ view: context.getCurrentTexture().createView(), loadOp: 'clear', storeOp: 'store' }],
      depthStencilAttachment: { view: depth.createView(), depthClearValue: 1, depthLoadOp: 'clear', depthStoreOp: 'discard' },
    });
    pass.setPipeline(pipeline);
    pass.setBindGroup(0, group);
    pass.draw(3);
    pass.end();
    device.queue.submit([encoder.finish()]);
    await device.queue.onSubmittedWorkDone();
  }
  return { draw, most: device.limits.maxTextureDimension2D };
}

const next = () => new Promise((go) => { setTimeout(go, 1); });

async function webgl() {
  const packed = document.getElementById('glsl')?.textContent;
  if (!packed) throw new Error('This scene is drawn by WebGPU alone.');
  const text = await unpacked(packed).text();
  const gl = canvas.getContext('webgl2', { alpha: false, antialias: false, depth: false, preserveDrawingBuffer: true });
  if (!gl) throw new Error('This browser offers no WebGL 2 either.');
  canvas.addEventListener('webglcontextlost', () => { says.textContent = 'The graphics device is gone. Load the page again.'; });
  const parallel = gl.getExtension('KHR_parallel_shader_compile');
  const program = gl.createProgram();
  const vertex = '#version 300 es\nvoid main() { gl_Position = vec4(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0, 0.0, 1.0); }';
  const shaders = [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, text]].map(([type, source]) => {
    const shader = gl.createShader(type);
    gl.shaderSource(shader, source);
    gl.compileShader(shader);
    gl.attachShader(program, shader);
    return shader;
  });
  gl.linkProgram(program);
  while (parallel && !gl.getProgramParameter(program, parallel.COMPLETION_STATUS_KHR)) await next();
  if (!gl.getProgramParameter(program, gl.LINK_STATUS)) {
    throw new Error([...shaders.map((shader) => gl.getShaderInfoLog(shader)), gl.getProgramInfoLog(program)].filter(Boolean).join('\n'));
  }
  gl.useProgram(program);
  gl.bindBuffer(gl.UNIFORM_BUFFER, gl.createBuffer());
  gl.bindBufferBase(gl.UNIFORM_BUFFER, 0, gl.getParameter(gl.UNIFORM_BUFFER_BINDING));
  gl.uniformBlockBinding(program, 0, 0);
  async function draw(width, height) {
    gl.viewport(0, 0, width, height);
    gl.bufferData(gl.UNIFORM_BUFFER, block, gl.DYNAMIC_DRAW);
    gl.drawArrays(gl.TRIANGLES, 0, 3);
    const drawn = gl.fenceSync(gl.SYNC_GPU_COMMANDS_COMPLETE, 0);
    gl.flush();
    while (gl.clientWaitSync(drawn, 0, 0) === gl.TIMEOUT_EXPIRED) await next();
    gl.deleteSync(drawn);
  }
  return { draw, most: gl.getParameter(gl.MAX_RENDERBUFFER_SIZE) };
}

// Draws by what the browser offers.
async function device() {
  const failed = [];
  for (const [name, make] of [['webgpu', webgpu], ['webgl', webgl]]) {
    try {
      const made = await make();
      document.body.dataset.by = name;
      return made;
    } catch (error) {
      failed.push(error.message);
    }
  }
  throw new Error(failed.join('\n'));
}

async function start() {
  const by = await device();
  async function draw(scale) {
    const pixels = devicePixelRatio * scale;
    const side = (length) => Math.min(Math.max(1, Math.round(length * pixels)), by.most);
    const [width, height] = [side(canvas.clientWidth), side(canvas.clientHeight)];
    if (canvas.width !== width || canvas.height !== height) Object.assign(canvas, { width, height });
    set('view_size', [width, height]);
    const began = performance.now();
    await by.draw(width, height);
    return performance.now() - began;
  }

  // What changed is drawn at once, with fewer pixels where that takes long, and once more with all of them when it rests.
  let due = false, moved = 0, changes = 0, scale = 0.5, busy = true, sharp = false, running = scene.moves, before = null;
  const change = () => {
    moved = performance.now();
    changes += 1;
    canvas.dataset.sharp = sharp = false;
    if (!due) requestAnimationFrame(turn);
    due = true;
  };
  async function turn(now) {
    due = false;
    if (busy) return;
    busy = true;
    if (running && before !== null) set('time', [block[at('time')] + (now - before) / 1000]);
    before = running ? now : null;
    const known = changes;
    const rests = !running && performance.now() - moved > 150;
    const took = await draw(rests ? 1 : scale);
    if (!rests) scale = Math.min(1, Math.max(0.2, scale * Math.min(1.2, Math.max(0.5, Math.sqrt(LONGEST / Math.max(took, 1))))));
    // What changed while this was drawn is drawn next.
    canvas.dataset.sharp = sharp = known === changes && (rests || scale === 1);
    busy = false;
    if ((running || !sharp) && !due) {
      due = true;
      requestAnimationFrame(turn);
    }
  }
  const pause = document.getElementById('pause');
  const play = () => {
    running = !running;
    before = null;
    if (pause) pause.textContent = running ? 'Pause' : 'Play';
    change();
  };
  if (at('time') !== undefined) {
    pause?.addEventListener('click', play);
    canvas.addEventListener('keydown', (event) => {
      if (event.key !== ' ') return;
      play();
      event.preventDefault();
    });
  } else {
    pause?.remove();
  }
  parameters(change);
  orbit(change);
  new ResizeObserver(change).observe(canvas);
  // The first picture is small, so that it is there at once; the next one is not.
  await draw(0.25);
  document.body.dataset.first = Math.round(performance.now());
  busy = false;
  change();
  while (!sharp && !running) await new Promise((go) => { setTimeout(go, 20); });
}

// The eye goes around what it looks at: drag, or two fingers or the wheel to go nearer; a double click goes back. The key Home does so, and puts the time
// back, too.
function orbit(change) {
  const home = { eye: three('view_eye'), aim: three('view_look_at'), height: at('view_height') === undefined ? 0 : block[at('view_height')] };
  const began = at('time') === undefined ? 0 : block[at('time')];
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
  const fingers = new Map();
  const apart = () => {
    const [a, b] = [...fingers.values()];
    return Math.hypot(a.x - b.x, a.y - b.y);
  };
  canvas.addEventListener('pointerdown', (event) => {
    canvas.setPointerCapture(event.pointerId);
    fingers.set(event.pointerId, { x: event.clientX, y: event.clientY });
  });
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
  });
  for (const end of ['pointerup', 'pointercancel']) canvas.addEventListener(end, (event) => fingers.delete(event.pointerId));
  canvas.addEventListener('wheel', (event) => {
    event.preventDefault();
    zoom(Math.exp(event.deltaY * (event.deltaMode ? 0.05 : 0.0015)));
  }, { passive: false });
  canvas.addEventListener('dblclick', () => { reset(); place(); });
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
  });
}

// A slider, a box or a colour for each parameter that the module reads.
function parameters(change) {
  const form = document.querySelector('form');
  if (!form) return;
  form.addEventListener('submit', (event) => event.preventDefault());
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

// Who drives this page waits for one of the two.
start().then(
  () => { document.body.dataset.state = 'drawn'; },
  (error) => { says.textContent = error.message; document.body.dataset.state = 'failed'; },
);
