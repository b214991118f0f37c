// Checks modules with Tint, the WGSL of Chromium (Dawn in node): `node tint.mjs FOLDER` for every .wgsl file in it. Each module is also
// made into a pipeline that calls every one of its functions; Dawn's null backend takes it where a driver would.

import { readdirSync, readFileSync } from 'node:fs';
import { join } from 'node:path';
import { create, globals } from 'webgpu';

Object.assign(globalThis, globals);

const folder = process.argv[2];
if (!folder) {
  console.error('usage: node tint.mjs FOLDER');
  process.exit(2);
}

// Dawn ends with this object, so it is kept for as long as the device.
const gpu = create(['backend=null']);
const adapter = await gpu.requestAdapter();
const device = await adapter.requestDevice();

/// An entry point that calls what a module offers.
function caller(wgsl) {
  const calls = {
    field: 'sum += sf_field(p);',
    bound: 'sum += sf_bound(p);',
    distance: 'sum += sf_distance(p);',
    gradient: 'sum += sf_gradient(p).w;',
    trace: 'sum += sf_trace(p, normal, 0.0, 9.0, 0.01).t;',
    shadow: 'sum += sf_shadow(p, normal, 0.0, 9.0, 8.0);',
    collision: 'sum += sf_collision(p, 0.5).depth;',
    occlusion: 'sum += sf_occlusion(p, normal);',
    surface: 'sum += sf_surface(p, normal).roughness;',
  };
  const offered = Object.entries(calls).filter(([name]) => wgsl.includes(`fn sf_${name}(`));
  const text = `
@group(1) @binding(0) var<storage, read_write> answers: array<f32>;
@compute @workgroup_size(64) fn call_all(@builtin(global_invocation_id) id: vec3u) {
  let p = vec3f(id) * 0.01;
  let normal = vec3f(0.0, 1.0, 0.0);
  var sum = 0.0;
  ${offered.map(([, call]) => call).join('\n  ')}
  answers[id.x] = sum;
}
`;
  return { count: offered.length, text };
}

/// What Tint says of a module; nothing where all is well.
async function faults(wgsl) {
  const { count, text } = caller(wgsl);
  if (count === 0) return ['the module offers no function'];
  device.pushErrorScope('validation');
  const module = device.createShaderModule({ code: wgsl + text });
  const { messages } = await module.getCompilationInfo();
  const errors = messages.filter((m) => m.type === 'error').map((m) => `${m.lineNum}:${m.linePos}: ${m.message}`);
  if (errors.length === 0) {
    const compute = { module, entryPoint: 'call_all' };
    await device.createComputePipelineAsync({ layout: 'auto', compute }).catch((error) => errors.push(error.message));
  }
  const rest = await device.popErrorScope();
  if (rest && errors.length === 0) errors.push(rest.message);
  return errors;
}

const files = readdirSync(folder).filter((name) => name.endsWith('.wgsl')).sort();
let bad = 0;
for (const name of files) {
  const errors = await faults(readFileSync(join(folder, name), 'utf8'));
  if (errors.length) {
    bad += 1;
    console.error(`${name}: Tint refuses it\n  ${errors.join('\n  ')}`);
  }
}
console.log(`tint: ${files.length - bad} of ${files.length} modules are right`);
device.destroy();
if (bad || files.length === 0) process.exitCode = 1;
