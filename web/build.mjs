// Builds Surefoot for the web below target/web, or below $CARGO_TARGET_DIR/web:
//
//     node web/build.mjs           npm/, the package `surefoot`, and playground/, a folder of static files
//     node web/build.mjs npm       the package alone
//
// The module of WebAssembly is built by Rust's own target where rustup has it (`rustup target add wasm32-unknown-unknown`), else by Debian's compiler
// (packages rustc-web, rust-web-src, cargo-web, lld). wasm-opt (package binaryen) makes it smaller; npm installs what the playground stands on.

import { spawnSync } from 'node:child_process';
import { createHash } from 'node:crypto';
import { cpSync, existsSync, mkdirSync, readFileSync, readdirSync, rmSync, statSync, writeFileSync } from 'node:fs';
import { dirname, join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { gzipSync } from 'node:zlib';

const web = dirname(fileURLToPath(import.meta.url));
const root = dirname(web);
const out = join(process.env.CARGO_TARGET_DIR ?? join(root, 'target'), 'web');
const wanted = process.argv.slice(2);
const TARGET = 'wasm32-unknown-unknown';

function run(command, args, more = {}) {
  const { status, error } = spawnSync(command, args, { stdio: 'inherit', ...more, env: { ...process.env, ...more.env } });
  if (error || status !== 0) {
    console.error(`web: ${command} ${args.join(' ')}: ${error?.message ?? `it ends with ${status}`}`);
    process.exit(1);
  }
}
// What comes over the network is tried again, as it may be away for a moment.
function fetched(command, args, more) {
  for (const pause of [5, 20, 60, 0]) {
    const { status } = spawnSync(command, args, { stdio: 'inherit', ...more });
    if (status === 0) return;
    if (!pause) break;
    console.error(`web: ${command} ${args.join(' ')} ends with ${status}; again in ${pause} s`);
    Atomics.wait(new Int32Array(new SharedArrayBuffer(4)), 0, 0, pause * 1000);
  }
  process.exit(1);
}
const says = (command, ...args) => spawnSync(command, args, { encoding: 'utf8' }).stdout?.trim() ?? '';

// The module as the Rust compiler writes it.
function compiled() {
  const folder = join(out, 'cargo');
  // The compiler recurses as deep as a text nests: most of it fits where Rust gives a thread of its own 8 MiB.
  const flags = '-C link-arg=-zstack-size=8388608';
  const common = ['build', '--locked', '--release', '--manifest-path', join(web, 'Cargo.toml'), '--target', TARGET, '--target-dir', folder];
  const env = { CARGO_TARGET_WASM32_UNKNOWN_UNKNOWN_RUSTFLAGS: flags };
  if (existsSync(join(says('rustc', '--print', 'sysroot'), 'lib/rustlib', TARGET))) {
    run('cargo', common, { env });
  } else {
    const own = { RUSTC: '/usr/bin/rustc', RUSTC_BOOTSTRAP: '1', CARGO_TARGET_WASM32_UNKNOWN_UNKNOWN_LINKER: '/usr/bin/wasm-ld' };
    run('/usr/bin/cargo', [...common, '-Z', 'build-std=std,panic_abort'], { env: { ...env, ...own } });
  }
  return join(folder, TARGET, 'release', 'surefoot.wasm');
}

// The package: what stands in web/npm, the module, and the licences.
function npm() {
  const folder = join(out, 'npm');
  const raw = compiled();
  rmSync(folder, { recursive: true, force: true });
  cpSync(join(web, 'npm'), folder, { recursive: true });
  for (const name of ['LICENSE-MIT', 'LICENSE-APACHE']) cpSync(join(root, name), join(folder, name));
  // It takes a minute: what is newer than the module is kept.
  const small = join(out, 'surefoot.wasm');
  // What Rust's compiler uses of WebAssembly's newer instructions.
  const features = ['bulk-memory', 'sign-ext', 'nontrapping-float-to-int', 'mutable-globals', 'multivalue', 'reference-types'];
  const isKept = existsSync(small) && statSync(small).mtimeMs > statSync(raw).mtimeMs;
  if (!isKept) run('wasm-opt', ['-O2', '--strip-debug', '--strip-producers', ...features.map((name) => `--enable-${name}`), raw, '-o', small]);
  cpSync(small, join(folder, 'surefoot.wasm'));
  const bytes = readFileSync(small);
  console.log(`surefoot.wasm: ${statSync(raw).size} bytes as compiled, ${bytes.length} after wasm-opt, ${gzipSync(bytes, { level: 9 }).length} packed by gzip`);
  return folder;
}

// Modules of npm that the page imports by name, each in a file of its own, and the map of their names.
function vendored(folder) {
  const modules = join(web, 'node_modules');
  const imports = {};
  const licences = [];
  const add = (name) => {
    if (imports[name]) return;
    const { exports, dependencies = {}, license, version } = JSON.parse(readFileSync(join(modules, name, 'package.json'), 'utf8'));
    const file = `vendor/${name.replace('@', '').replace('/', '-')}.js`;
    imports[name] = `./${file}`;
    cpSync(join(modules, name, exports.import), join(folder, file));
    const licence = readdirSync(join(modules, name)).find((file) => /^licen[cs]e/i.test(file));
    licences.push(`${name} ${version}, ${license}\n\n${licence ? readFileSync(join(modules, name, licence), 'utf8') : ''}`);
    Object.keys(dependencies).forEach(add);
  };
  mkdirSync(join(folder, 'vendor'));
  ['codemirror', '@codemirror/state', '@codemirror/view', '@codemirror/language', '@codemirror/lint'].forEach(add);
  writeFileSync(join(folder, 'vendor', 'LICENSES.txt'), licences.join('\n----\n\n'));
  return imports;
}

// The examples that a page can show: those that name no file but other texts, which the page has too.
async function examples(compiler) {
  const folder = join(root, 'examples');
  const files = Object.fromEntries(readdirSync(join(folder, 'parts')).filter((name) => /\.(sdf|glsl)$/.test(name)).map((name) => [`parts/${name}`, readFileSync(join(folder, 'parts', name), 'utf8')]));
  const scenes = [];
  const left = [];
  for (const file of readdirSync(folder).filter((name) => name.endsWith('.sdf')).sort()) {
    const text = readFileSync(join(folder, file), 'utf8');
    const words = (await compiler.tokens(text)).filter(([, , kind]) => kind === 'text').map(([from, to]) => text.slice(from + 1, to - 1));
    const outer = words.filter((word) => /\.\w+$|\/$/.test(word) && !(word in files));
    const { scene } = outer.length ? {} : await compiler.draw(text, { name: file, files });
    if (scene) scenes.push({ name: file.slice(0, -4), text });
    else left.push(`${file.slice(0, -4)} (${outer.join(', ') || 'it has errors'})`);
  }
  console.log(`${scenes.length} examples; without ${left.join(', ')}`);
  return { scenes, files };
}

// The playground: its own files, the package, the renderer of exported pages, and CodeMirror.
async function playground(npm) {
  const folder = join(out, 'playground');
  if (!existsSync(join(web, 'node_modules', '.package-lock.json')) || statSync(join(web, 'package-lock.json')).mtimeMs > statSync(join(web, 'node_modules', '.package-lock.json')).mtimeMs) {
    fetched('npm', ['ci', '--ignore-scripts', '--no-audit', '--no-fund', '--loglevel=error'], { cwd: web });
  }
  rmSync(folder, { recursive: true, force: true });
  cpSync(join(web, 'playground'), folder, { recursive: true });
  mkdirSync(join(folder, 'surefoot'));
  for (const name of ['surefoot.js', 'surefoot.wasm']) cpSync(join(npm, name), join(folder, 'surefoot', name));
  for (const name of ['draw.js', 'show.js']) cpSync(join(root, 'hosts', 'src', name), join(folder, 'surefoot', name));
  const imports = JSON.stringify({ imports: vendored(folder) });
  const digest = `sha256-${createHash('sha256').update(imports).digest('base64')}`;
  const index = join(folder, 'index.html');
  writeFileSync(index, readFileSync(index, 'utf8').replace('%%IMPORTS%%', () => imports).replace('%%DIGEST%%', () => digest));
  const { Compiler } = await import(join(npm, 'surefoot.js'));
  writeFileSync(join(folder, 'examples.json'), JSON.stringify(await examples(new Compiler(readFileSync(join(npm, 'surefoot.wasm'))))));
}

const built = npm();
if (!wanted.includes('npm')) await playground(built);
console.log(`written: ${wanted.includes('npm') ? built : `${built} and ${join(out, 'playground')}`}`);
