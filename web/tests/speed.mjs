// How long a compilation takes in WebAssembly, beside the same code as a program of this machine:
//
//     node speed.mjs PACKAGE NATIVE [ROUNDS]       writes docs/web.md
//
// PACKAGE is target/web/npm, NATIVE the program of web/examples/native.rs. Both get the request of a page (`draw`) for each example, and remember nothing.
// In each round one answers after the other.

import { spawn } from 'node:child_process';
import { readFileSync, readdirSync, writeFileSync } from 'node:fs';
import { cpus } from 'node:os';
import { dirname, join, resolve } from 'node:path';
import { createInterface } from 'node:readline';
import { fileURLToPath, pathToFileURL } from 'node:url';
import { gzipSync } from 'node:zlib';

const [packed, native, rounds = '7'] = process.argv.slice(2);
const root = join(dirname(fileURLToPath(import.meta.url)), '..', '..');
const examples = join(root, 'examples');
const { Compiler } = await import(pathToFileURL(resolve(packed, 'surefoot.js')));
const bytes = readFileSync(resolve(packed, 'surefoot.wasm'));
const module = await WebAssembly.compile(bytes);

// How long the first thread of a process has run on a core, in milliseconds: what others do on the machine is not in it.
const busy = (pid) => Number(readFileSync(`/proc/${pid}/schedstat`, 'utf8').split(' ')[0]) / 1e6;

// A program that answers a line by a line. It may use one core or all.
function program(args) {
  const child = spawn(...args, { stdio: ['pipe', 'pipe', 'inherit'] });
  const lines = createInterface({ input: child.stdout })[Symbol.asyncIterator]();
  return {
    ask: async (request) => {
      const before = busy(child.pid);
      child.stdin.write(`${JSON.stringify(request)}\n`);
      const wall = Number((await lines.next()).value.split(' ')[0]);
      return [busy(child.pid) - before, wall];
    },
    end: () => child.stdin.end(),
  };
}
const one = program(['taskset', ['-c', '0', native]]);
const all = program([native, []]);
const files = Object.fromEntries(readdirSync(join(examples, 'parts')).map((name) => [`parts/${name}`, readFileSync(join(examples, 'parts', name), 'utf8')]));
const median = (times, which) => times.map((time) => time[which]).toSorted((a, b) => a - b)[times.length >> 1];

const rows = [];
const left = [];
// A compiler that has answered before, as a page's has: V8 has compiled what is used most.
const compiler = new Compiler(module);
const names = readdirSync(examples).filter((name) => name.endsWith('.sdf')).sort();
const texts = Object.fromEntries(names.map((name) => [name, readFileSync(join(examples, name), 'utf8')]));
const fresh = async (name) => {
  const [before, began] = [busy('self'), performance.now()];
  await compiler.draw(texts[name], { name, files, fresh: true });
  return [busy('self') - before, performance.now() - began];
};
const usable = [];
for (const name of names) ((await compiler.draw(texts[name], { name, files })).scene ? usable : left).push(name);
const times = Object.fromEntries(usable.map((name) => [name, { web: [], one: [], all: [] }]));
for (let round = 0; round < Number(rounds); round++) {
  for (const name of usable) {
    const texted = [texts[name], ...Object.values(files)];
    const request = { do: 'draw', name, text: 0, files: Object.fromEntries(Object.keys(files).map((file, i) => [file, i + 1])), texts: texted };
    times[name].web.push(await fresh(name));
    times[name].one.push(await one.ask(request));
    times[name].all.push(await all.ask(request));
  }
}
one.end();
all.end();
for (const name of usable) {
  const { web, one, all } = times[name];
  const [cpu, single, wall, every] = [median(web, 0), median(one, 0), median(web, 1), median(all, 1)];
  rows.push([name.slice(0, -4), cpu.toFixed(0), single.toFixed(0), (cpu / single).toFixed(1), wall.toFixed(0), every.toFixed(0), (wall / every).toFixed(1)]);
  console.log(rows.at(-1).join('  '));
}
const mean = (index) => Math.exp(rows.reduce((sum, row) => sum + Math.log(row[index]), 0) / rows.length).toFixed(1);
const worst = (index) => rows.reduce((most, row) => (Number(row[index]) > Number(most[index]) ? row : most));
const kb = (bytes) => (bytes / 1000).toFixed(0);
const head = ['example', 'WebAssembly, ms of a core', 'program on one core, ms of it', 'times as long', 'WebAssembly, ms of the clock', 'program on all cores, ms of the clock', 'times as long'];
const table = [head, ['---', '--:', '--:', '--:', '--:', '--:', '--:'], ...rows];
writeFileSync(join(root, 'docs', 'web.md'), `# The compiler in a browser

\`node web/build.mjs\` builds it. \`surefoot.wasm\` has ${kb(bytes.length)} KB; packed by gzip, as servers send it, ${kb(gzipSync(bytes, { level: 9 }).length)} KB.

The table compares the times of one compilation. All run the same code (\`web/src/request.rs\`): text in; module in WGSL, its
check, and GLSL for WebGL 2 out. Both are release builds with the same settings (\`web/Cargo.toml\`). WebAssembly runs in Node ${process.versions.node}, whose V8 is that of Chromium, on one thread. Its
module was loaded and warm: each example was compiled once before. Neither remembers what it found then. The program
(\`web/examples/native.rs\`) runs on one core, and on all ${cpus().length}. Times are medians of ${rounds} rounds, in which the three take turns. The machine is used by others
too: so the first times are those that the thread which compiles ran on a core, which waiting is no part of. The others are of the clock, and vary with what others do.

On average (geometric mean) WebAssembly runs ${mean(3)} times as long as the program on one core, at most ${worst(3)[3]} (${worst(3)[0]}). By the clock it takes ${mean(6)} times as long as
the program on all cores, at most ${worst(6)[6]} (${worst(6)[0]}). Left out, because they need files that are not read here: ${left.map((name) => name.slice(0, -4)).join(', ') || 'none'}. Meshes and
images of other examples are named and not read.

\`\`\`
cargo build --locked --release --manifest-path web/Cargo.toml --example native --target-dir target/web/native
node web/tests/speed.mjs target/web/npm target/web/native/release/examples/native ${rounds}
\`\`\`

${table.map((row) => `| ${row.join(' | ')} |`).join('\n')}
`);
