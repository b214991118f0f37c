// Packs the package that web/build.mjs made, installs it into an empty folder, and uses it there as a person would:
//
//     node npm.mjs PROGRAM PACKAGE FOLDER
//
// PROGRAM is surefoot, whose files the package's are compared with; PACKAGE is target/web/npm.

import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { copyFileSync, mkdirSync, readFileSync, readdirSync, rmSync, writeFileSync } from 'node:fs';
import { dirname, join, resolve } from 'node:path';
import { fileURLToPath, pathToFileURL } from 'node:url';
import { gunzipSync, gzipSync } from 'node:zlib';

const [program, packed, folder] = process.argv.slice(2).map((path) => resolve(path));
if (!folder) {
  console.error('usage: node npm.mjs PROGRAM PACKAGE FOLDER');
  process.exit(2);
}
const here = dirname(fileURLToPath(import.meta.url));
const examples = join(here, '..', '..', 'examples');
const run = (command, args, more) => {
  const { status, stdout, stderr, error } = spawnSync(command, args, { maxBuffer: 1 << 28, ...more });
  assert.equal(status, 0, `${command} ${args.join(' ')}: ${error?.message ?? `${stdout}${stderr}`}`);
  return stdout;
};

rmSync(folder, { recursive: true, force: true });
mkdirSync(folder, { recursive: true });
const tarball = run('npm', ['pack', packed, '--pack-destination', folder, '--loglevel=error'], { encoding: 'utf8' }).trim().split('\n').at(-1);
writeFileSync(join(folder, 'package.json'), '{ "private": true, "type": "module" }\n');
run('npm', ['install', '--offline', '--no-audit', '--no-fund', '--loglevel=error', join(folder, tarball)], { cwd: folder });
const { Compiler, CompilerError, SceneError, check, compile, draw, format, tokens } = await import(pathToFileURL(join(folder, 'node_modules/surefoot/surefoot.js')));

// What is loaded is small.
const small = gzipSync(readFileSync(join(folder, 'node_modules/surefoot/surefoot.wasm')), { level: 9 }).length;
assert(small < 3e6, `${small} bytes packed`);

// Errors as data, with places as JavaScript and as bytes count.
const wrong = '// ünïcödé 🦆\nscene = bax(1)';
const [found, ...others] = await check(wrong);
assert.deepEqual(others, []);
const { severity, code, message, help, line, column, endLine, endColumn, start, end, bytes } = found;
assert.deepEqual({ severity, code, message, help }, { severity: 'error', code: 'unknown-name', message: 'nothing is named `bax`', help: 'did you mean `box`?' });
assert.deepEqual([line, column, endLine, endColumn], [2, 9, 2, 12]);
assert.equal(wrong.slice(start, end), 'bax');
assert.equal(Buffer.from(wrong).subarray(...bytes).toString(), 'bax');
assert.deepEqual(await check('scene = box(1)'), []);
await assert.rejects(compile(wrong, { name: 'duck.sdf' }), (error) => error instanceof SceneError && error.message === 'duck.sdf:2:9: nothing is named `bax`' && error.diagnostics.length === 1);
await assert.rejects(compile('scene = box(1)', { for: 'nothing' }), /no host or language `nothing`/);
await assert.rejects(compile('scene = box(1)', { set: { a: 1 } }), /no parameter `a`/);

// The same bytes as the program writes, for every host and of every example.
const files = Object.fromEntries(readdirSync(join(examples, 'parts')).map((name) => [`parts/${name}`, readFileSync(join(examples, 'parts', name))]));
const text = (name) => readFileSync(join(examples, name), 'utf8');
// naga orders the variables of a function in SPIR-V by a hash, which is another one where addresses have 32 bits: there the words are the same, not their order.
const words = (bytes) => new Uint32Array(Uint8Array.from(bytes).buffer).sort();
// In these the sine of an angle has another last digit in WebAssembly. Then other terms are found to be the same, and the text differs.
const OTHER_SINES = ['along.sdf', 'gearbox.sdf'];
const same = async (name, options, args, ending) => {
  const file = join(folder, `${name.slice(0, -4)}.${ending}`);
  run(program, ['compile', name, '-o', file, ...args], { cwd: examples });
  const { output, beside } = await compile(text(name), { name, files, ...options });
  const theirs = readFileSync(file);
  const isSame = ending === 'spv' ? Buffer.from(words(theirs).buffer).equals(Buffer.from(words(output).buffer)) : theirs.equals(Buffer.from(output));
  assert(isSame, `${name} ${JSON.stringify(options)}: not what the program writes`);
  for (const [other, data] of Object.entries(beside)) assert(readFileSync(join(folder, other)).equals(Buffer.from(data)), `${name}: ${other}`);
};
let compared = 0;
for (const name of readdirSync(examples).filter((name) => name.endsWith('.sdf') && name !== 'ducks.sdf')) {
  if (OTHER_SINES.includes(name)) {
    assert((await compile(text(name), { name, files })).output.length > 0);
    continue;
  }
  await same(name, {}, [], 'wgsl');
  compared += 1;
}
assert(compared > 20);
const hosts = [['three', 'js'], ['three-webgl', 'js'], ['babylon', 'js'], ['playcanvas', 'js'], ['wgpu-py', 'py'], ['godot', 'gdshader'], ['bevy', 'wgsl'], ['shadertoy', 'glsl'], ['vulkan', 'spv'], ['hlsl', 'hlsl'], ['msl', 'metal']];
for (const [host, ending] of hosts) await same('still_life.sdf', { for: host }, ['--for', host], ending);
await same('csg.sdf', { for: 'glsl', functions: ['field'], prefix: 'a_' }, ['--target', 'glsl', '--functions', 'field', '--prefix', 'a_'], 'glsl');
// A page packs its shaders; what they unpack to is the same.
const unpacked = (page) => [...page.matchAll(/<script type="application\/octet-stream" id="\w+">([^<]+)/g)].map(([, text]) => spawnSync('python3', ['-c', 'import sys,zlib,base64;sys.stdout.buffer.write(zlib.decompress(base64.b64decode(sys.stdin.read())))'], { input: text }).stdout.toString());
run(program, ['compile', 'csg.sdf', '--for', 'html', '-o', join(folder, 'csg.html')], { cwd: examples });
const ours = (await compile(text('csg.sdf'), { name: 'csg.sdf', for: 'html' })).output;
const theirs = readFileSync(join(folder, 'csg.html'), 'utf8');
assert.equal(unpacked(ours).length, 2);
assert.deepEqual(unpacked(ours), unpacked(theirs));

// A choice fixes what is written.
const corpus = join(here, '..', '..', 'tests', 'corpus', 'right');
const choosing = readFileSync(join(corpus, 'choices.sdf'), 'utf8');
const [doric, ionic] = await Promise.all(['doric', 'ionic'].map((style) => compile(choosing, { set: { style } })));
assert.notEqual(doric.output, ionic.output);
await assert.rejects(compile(choosing, { set: { style: 'gothic' } }));

// What editors and pages ask for.
assert.equal(await format('scene=box( 1 )'), 'scene = box(1)\n');
assert.deepEqual((await tokens('scene = 1')).map(([start, end, kind]) => [start, end, kind]), [[0, 5, 'kind'], [6, 7, 'operator'], [8, 9, 'number']]);
const { scene, parameters } = await draw(text('csg.sdf'));
assert(scene.wgsl.includes('fn sf_fragment') && scene.glsl.startsWith('#version 300 es') && scene.fields['parameter drill'] >= 0);
assert.deepEqual(parameters.map(({ name, min, max }) => [name, min, max]), [['drill', 0.1, 0.65], ['round_off', 0, 0.15]]);
assert.equal((await draw(wrong)).scene, null);

// Hostile texts: an answer for each, and no trap.
const deep = (open, close) => `scene = sphere(${open.repeat(10_000)}1${close.repeat(10_000)})`;
for (const [open, close] of [['(', ')'], ['-', ''], ['sin(', ')'], ['1+', ''], ['if true { ', ' } else { 1 }']]) await check(deep(open, close));
assert.equal((await check(deep('(', ')')))[0].code, 'too-deep');
let seed = 1;
const random = (below) => {
  seed = (Math.imul(seed, 1664525) + 1013904223) >>> 0;
  return seed % below;
};
const texts = readdirSync(examples).filter((name) => name.endsWith('.sdf')).map(text);
const strange = ['(', ')', '{', '}', '"', '/*', '.repeat(1)', '.twist(y, 9)', '1e308', '-', '🦆', '\0', 'for i in 0..999 ', '0/0', ' | ', '..', '#', ' in '];
let wrongs = 0;
for (let i = 0; i < 200; i++) {
  let mutated = texts[random(texts.length)];
  for (let cuts = 1 + random(4); cuts > 0; cuts--) {
    const at = random(mutated.length + 1);
    const length = random(3) ? random(8) : random(200);
    mutated = mutated.slice(0, at) + (random(2) ? strange[random(strange.length)] : '') + mutated.slice(at + length);
  }
  wrongs += (await check(mutated)).some((one) => one.severity === 'error') ? 1 : 0;
}
assert(wrongs > 100, `only ${wrongs} of 200 are wrong`);

// A compiler that stops, here for lack of a stack, says so, and the next call works.
writeFileSync(join(folder, 'stops.mjs'), `
import { CompilerError, check } from 'surefoot';
const nested = 'scene = sphere(' + 'sin('.repeat(190) + '1' + ')'.repeat(190) + ')';
try { await check(nested); console.log('it has room'); } catch (error) { console.log(error instanceof CompilerError, error.message.startsWith('the compiler stopped')); }
console.log((await check('scene = bax(1)')).length);
`);
assert.equal(run('node', ['--stack-size=80', 'stops.mjs'], { cwd: folder, encoding: 'utf8' }), 'true true\n1\n');
await assert.rejects(new Compiler(Uint8Array.of(1, 2, 3)).check(''), WebAssembly.CompileError);
assert(CompilerError.prototype instanceof Error && gunzipSync(gzipSync('')).length === 0);

// The types.
writeFileSync(join(folder, 'types.ts'), `
import { check, compile, SceneError, type Diagnostic, type Host } from 'surefoot';
const host: Host = 'godot';
const { output, beside, parameters } = await compile('scene = box(1)', { for: host, set: { style: 'doric' } });
const words: string | Uint8Array = output;
const found: Diagnostic[] = await check('scene = bax(1)', { files: { 'a.sdf': 'x' } });
console.log(words, found[0]?.line.toFixed(), found[0]?.labels[0]?.message, Object.keys(beside), parameters[0]?.name);
export const is = (error: unknown) => error instanceof SceneError && error.diagnostics.length;
// @ts-expect-error: there is no such host.
await compile('', { for: 'nothing' });
`);
copyFileSync(join(here, 'tsconfig.json'), join(folder, 'tsconfig.json'));
run('node', [join(here, '..', 'node_modules', 'typescript', 'bin', 'tsc'), '--project', folder]);
console.log(`npm: ${compared} examples and ${hosts.length + 2} files for hosts as the program writes them; 200 mutated texts, ${wrongs} with errors; ${small} bytes packed`);
