// Draws a module that `surefoot compile` wrote. Nothing else of Surefoot is needed: the module names its own live values.
//
// The address may say what is drawn and from where: ?scene=../scene.wgsl&eye=4,3,6&target=0,0,0&fov=40&width=960&height=540
// and &view=normals for the normals alone.

const query = new URLSearchParams(location.search);
const numbers = (name, otherwise) => (query.get(name) ?? otherwise).split(',').map(Number);
const says = document.getElementById('says');
const canvas = document.getElementById('canvas');
[canvas.width] = numbers('width', '960');
[canvas.height] = numbers('height', '540');

// The module's head has a table of its live values:
//
//     offset  type   name    default  range
//          0  vec3f  origin  0, 0, 0
//         12  f32    melt    0.22     0.02..0.6  how warm the day is
//         16  f32    swing   0                   computed: see below
//          -  f32    time    0                   seconds
//
// What has no offset is needed for what is computed, and stands in no place of the block.
function liveValues(wgsl) {
  const lines = wgsl.split('\n');
  const top = lines.findIndex((line) => /^\/\/ +offset +type +name +default +range$/.test(line));
  if (top < 0) return [];
  const columns = ['type', 'name', 'default', 'range'].map((word) => lines[top].indexOf(word));
  const end = lines.findIndex((line, i) => i > top && !line.startsWith('//  '));
  return lines.slice(top + 1, end).map((row) => {
    const cell = (i) => row.slice(columns[i], columns[i + 1]).trim();
    const range = cell(3).match(/^(-?[\d.e-]+?)\.\.(-?[\d.e-]+)/);
    return {
      offset: row.slice(2, columns[0]).trim() === '-' ? null : parseInt(row.slice(2), 10),
      name: cell(1),
      values: cell(2).split(', ').map(Number),
      range: cell(0) === 'f32' && range ? range.slice(1).map(Number) : null,
    };
  });
}

// Below the table stand formulas, `swing = 0.5 * sin(time)`, of what is computed from parameters and time once a frame.
function formulas(wgsl) {
  return [...wgsl.matchAll(/^\/\/   (\w+) = (.+)$/gm)].map(([, name, formula]) => [name, formula]);
}

const list = (...numbers) => numbers;
const functions = {
  ...Object.fromEntries(Object.getOwnPropertyNames(Math).map((name) => [name, Math[name]])),
  square: (a) => a * a,
  div: (a, b) => (b === 0 ? 0 : a / b),
  sqrt: (a) => Math.sqrt(Math.max(a, 0)),
  exp: (a) => Math.exp(Math.min(a, 88)),
  log: (a) => Math.log(Math.max(a, 1e-37)),
  pow: (a, b) => (a > 0 ? Math.min(a ** b, 1e30) : Number(b === 0)),
  asin: (a) => Math.asin(Math.min(Math.max(a, -1), 1)),
  acos: (a) => Math.acos(Math.min(Math.max(a, -1), 1)),
  // Halves go to the even number.
  round: (a) => Math.round(a) - (Math.round(a) - a === 0.5 && Math.round(a) % 2 !== 0),
  select: (c, a, b) => (c ? a : b),
  turn_u: (u, v, t) => u * Math.cos(t) - v * Math.sin(t),
  turn_v: (u, v, t) => u * Math.sin(t) + v * Math.cos(t),
  length2: Math.hypot, length3: Math.hypot, length4: Math.hypot,
  both: (a, b) => a && b, either: (a, b) => a || b, no: (a) => !a,
  vec2: list, vec3: list, vec4: list,
};

// The block's numbers, of all live values and what is computed from them.
function fill(block, live, computed) {
  const known = { ...functions };
  for (const { name, values: [x, y, z, w] } of live) known[name] = y === undefined ? x : { x, y, z, w };
  for (const [name, formula] of computed) {
    known[name] = new Function(...Object.keys(known), `return ${formula};`)(...Object.values(known));
  }
  const isComputed = new Set(computed.map(([name]) => name));
  for (const { name, offset, values } of live) {
    if (offset !== null) block.set(isComputed.has(name) ? [known[name]].flat().map(Number) : values, offset / 4);
  }
}

async function text(address) {
  const answer = await fetch(address);
  if (!answer.ok) throw new Error(`${address}: ${answer.status} ${answer.statusText}`);
  return answer.text();
}

async function start() {
  const adapter = await navigator.gpu?.requestAdapter();
  if (!adapter) throw new Error('This browser offers no WebGPU.');
  const device = await adapter.requestDevice();
  const scene = await text(query.get('scene') ?? '../scene.wgsl');
  const code = `${scene}\n${await text('../picture.wgsl')}`;
  const module = device.createShaderModule({ code });
  const errors = (await module.getCompilationInfo()).messages.filter((m) => m.type === 'error');
  if (errors.length) throw new Error(errors.map((m) => `${m.lineNum}: ${m.message}`).join('\n'));

  const context = canvas.getContext('webgpu');
  const format = navigator.gpu.getPreferredCanvasFormat();
  context.configure({ device, format });
  const pipeline = await device.createRenderPipelineAsync({
    layout: 'auto',
    vertex: { module, entryPoint: 'corner' },
    fragment: { module, entryPoint: query.get('view') ?? 'picture', targets: [{ format }] },
  });

  const live = liveValues(scene);
  const computed = formulas(scene);
  const end = Math.max(0, ...live.map((l) => (l.offset === null ? 0 : l.offset + 4 * l.values.length)));
  const values = new Float32Array(Math.max(4, Math.ceil(end / 16) * 4));
  fill(values, live, computed);
  const camera = new Float32Array(16);
  const uniforms = [values, camera].map((data, group) => {
    const buffer = device.createBuffer({ size: data.byteLength, usage: GPUBufferUsage.UNIFORM | GPUBufferUsage.COPY_DST });
    // A module without live values has no group 0.
    if (group === 0 && end === 0) return null;
    const layout = pipeline.getBindGroupLayout(group);
    return { data, buffer, group: device.createBindGroup({ layout, entries: [{ binding: 0, resource: { buffer } }] }) };
  });

  function draw() {
    place(camera);
    const encoder = device.createCommandEncoder();
    const pass = encoder.beginRenderPass({
      colorAttachments: [{ view: context.getCurrentTexture().createView(), loadOp: 'clear', storeOp: 'store' }],
    });
    pass.setPipeline(pipeline);
    uniforms.forEach((uniform, group) => {
      if (!uniform) return;
      device.queue.writeBuffer(uniform.buffer, 0, uniform.data);
      pass.setBindGroup(group, uniform.group);
    });
    pass.draw(3);
    pass.end();
    device.queue.submit([encoder.finish()]);
  }

  let due = false;
  function change() {
    if (!due) requestAnimationFrame(() => { due = false; draw(); });
    due = true;
  }
  sliders(live, () => { fill(values, live, computed); change(); });
  orbit(change);
  draw();
  await device.queue.onSubmittedWorkDone();
}

// The eye goes round the target.
const target = numbers('target', '0,0,0');
let distance, turn, height;
{
  const [x, y, z] = numbers('eye', '4,3,6').map((c, i) => c - target[i]);
  distance = Math.hypot(x, y, z);
  turn = Math.atan2(x, z);
  height = Math.asin(y / distance);
}

function place(camera) {
  const half = Math.tan((numbers('fov', '40')[0] * Math.PI) / 360);
  const [c, s, ch, sh] = [Math.cos(turn), Math.sin(turn), Math.cos(height), Math.sin(height)];
  const back = [s * ch, sh, c * ch];
  camera.set([...target.map((t, i) => t + distance * back[i]), (2 * half) / canvas.height], 0);
  camera.set([c * half, 0, -s * half, canvas.width], 4);
  camera.set([-s * sh * half, ch * half, -c * sh * half, canvas.height], 8);
  camera.set([...back.map((b) => -b), 100], 12);
}

function orbit(change) {
  canvas.onpointerdown = (event) => canvas.setPointerCapture(event.pointerId);
  canvas.onpointermove = (event) => {
    if (!canvas.hasPointerCapture(event.pointerId)) return;
    turn -= event.movementX * 0.01;
    height = Math.min(Math.max(height + event.movementY * 0.01, -1.5), 1.5);
    change();
  };
}

function sliders(live, change) {
  for (const { name, values, range } of live) {
    if (!range) continue;
    const label = document.createElement('label');
    const input = Object.assign(document.createElement('input'), { type: 'range', min: range[0], max: range[1], step: 'any', value: values[0] });
    const shown = document.createElement('output');
    shown.value = values[0];
    input.oninput = () => {
      values[0] = input.valueAsNumber;
      shown.value = input.valueAsNumber.toPrecision(3);
      change();
    };
    label.append(name, input, shown);
    document.getElementById('sliders').append(label);
  }
}

// Who drives this page waits for one of the two.
start().then(
  () => { document.body.dataset.state = 'drawn'; },
  (error) => { says.textContent = error.message; document.body.dataset.state = 'failed'; },
);
