// Surefoot's compiler, which is a module of WebAssembly, for Node and browsers. surefoot.d.ts says what each function takes and gives.

/** A scene with errors: `diagnostics` has all that was found. */
export class SceneError extends Error {
  constructor(diagnostics) {
    const errors = diagnostics.filter((one) => one.severity === 'error');
    const first = errors[0];
    const more = errors.length > 1 ? ` (and ${errors.length - 1} more)` : '';
    super(first ? `${first.file}:${first.line}:${first.column}: ${first.message}${more}` : 'the scene has errors');
    this.name = 'SceneError';
    this.diagnostics = diagnostics;
  }
}

/** The compiler itself stopped, for lack of memory or by a mistake of its own. The next call starts it anew. */
export class CompilerError extends Error {
  constructor(message, options) {
    super(message, options);
    this.name = 'CompilerError';
  }
}

// A module whose memory has grown beyond this is given up after its answer: memory of WebAssembly never shrinks.
const MOST_KEPT = 256 << 20;
const encoder = new TextEncoder();
const decoder = new TextDecoder();

/** A compiler of its own. Without `source`, it is the file beside this one. */
export class Compiler {
  #module;
  #instance = null;

  constructor(source = new URL('./surefoot.wasm', import.meta.url)) {
    this.#module = module(source);
    // Whoever asks hears of it.
    this.#module.catch(() => {});
  }

  async compile(text, options = {}) {
    const { for: host, name, files, set, strict, fresh, functions, prefix, draw, ending } = options;
    const answer = await this.#ask({ do: 'compile', for: host, name, set, strict, fresh, functions, prefix, draw, ending }, text, files);
    if (!answer.compiled) throw new SceneError(answer.diagnostics);
    const [output, ...rest] = answer.blobs.map((bytes, i) => (answer.text && !answer.files[i].endsWith('.bin') ? decoder.decode(bytes) : bytes));
    const beside = Object.fromEntries(rest.map((data, i) => [answer.files[i + 1], data]));
    return { output, file: answer.files[0], beside, warnings: answer.diagnostics, notes: answer.notes, parameters: answer.parameters };
  }

  async check(text, { name, files, set, strict, fresh } = {}) {
    return (await this.#ask({ do: 'check', name, set, strict, fresh }, text, files)).diagnostics;
  }

  async draw(text, { name, files, set, strict, fresh } = {}) {
    const { scene = null, diagnostics, parameters, notes = [], blobs } = await this.#ask({ do: 'draw', name, set, strict, fresh }, text, files);
    if (!scene) return { scene, diagnostics, parameters, notes };
    const [wgsl, glsl, ...buffers] = blobs;
    return { scene: { ...scene, wgsl: decoder.decode(wgsl), glsl: glsl.length ? decoder.decode(glsl) : null, buffers }, diagnostics, parameters, notes };
  }

  async format(text) {
    return (await this.#ask({ do: 'format' }, text)).text;
  }

  async tokens(text) {
    return (await this.#ask({ do: 'tokens' }, text)).tokens;
  }

  async #ask(request, text, files = {}) {
    if (typeof text !== 'string') throw new TypeError('the scene is a string');
    const blobs = [encoder.encode(text)];
    const named = Object.entries(files).map(([name, data]) => [name, blobs.push(typeof data === 'string' ? encoder.encode(data) : data) - 1]);
    const json = encoder.encode(JSON.stringify({ ...request, text: 0, files: Object.fromEntries(named), blobs: blobs.map((blob) => blob.length) }));
    this.#instance ??= WebAssembly.instantiate(await this.#module, {});
    const { exports } = await this.#instance;
    try {
      const answer = ask(exports, [Uint32Array.of(json.length), json, ...blobs]);
      if (exports.memory.buffer.byteLength > MOST_KEPT) this.#instance = null;
      if (answer.error) throw new TypeError(answer.error);
      return answer;
    } catch (error) {
      if (error instanceof TypeError) throw error;
      this.#instance = null;
      throw new CompilerError(`the compiler stopped: ${reason(exports) ?? error.message}`, { cause: error });
    }
  }
}

// Writes a request into a module's memory and reads the answer, as web/src/lib.rs says.
function ask({ memory, reserve, run }, parts) {
  const pieces = parts.map((part) => (part instanceof Uint32Array ? new Uint8Array(part.buffer) : part));
  let at = reserve(pieces.reduce((sum, piece) => sum + piece.length, 0)) >>> 0;
  for (const piece of pieces) {
    new Uint8Array(memory.buffer).set(piece, at);
    at += piece.length;
  }
  const start = run() >>> 0;
  const view = new DataView(memory.buffer);
  const length = view.getUint32(start, true);
  const bytes = new Uint8Array(memory.buffer, start + 4, length).slice();
  const end = 4 + view.getUint32(start + 4, true);
  const answer = JSON.parse(decoder.decode(bytes.subarray(4, end)));
  let next = end;
  answer.blobs = answer.blobs.map((size) => bytes.subarray(next, (next += size)));
  return answer;
}

// Why a module trapped, as it wrote itself.
function reason({ memory, trapped }) {
  try {
    const at = trapped() >>> 0;
    return at ? decoder.decode(new Uint8Array(memory.buffer, at + 4, new DataView(memory.buffer).getUint32(at, true))) : null;
  } catch {
    return null;
  }
}

// A compiled module of WebAssembly, of one, of its bytes, or of its address.
async function module(source) {
  if (source instanceof WebAssembly.Module) return source;
  if (source instanceof ArrayBuffer || ArrayBuffer.isView(source)) return WebAssembly.compile(source);
  const url = new URL(source, globalThis.location?.href);
  if (url.protocol === 'file:' && globalThis.process?.versions?.node) {
    const { readFile } = await import(/* webpackIgnore: true */ /* @vite-ignore */ 'node:fs/promises');
    return WebAssembly.compile(await readFile(url));
  }
  const response = await fetch(url);
  if (!response.ok) throw new CompilerError(`can't load ${url}: ${response.status} ${response.statusText}`);
  return WebAssembly.compile(await response.arrayBuffer());
}

let shared = null;
const usual = () => (shared ??= new Compiler());

export const compile = (text, options) => usual().compile(text, options);
export const check = (text, options) => usual().check(text, options);
export const draw = (text, options) => usual().draw(text, options);
export const format = (text) => usual().format(text);
export const tokens = (text) => usual().tokens(text);
