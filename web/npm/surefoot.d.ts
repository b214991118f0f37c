/** A host that takes a file of its own form. */
export type Host =
  | 'html' | 'three' | 'three-webgl' | 'babylon' | 'playcanvas' | 'wgpu-py' | 'godot' | 'bevy' | 'shadertoy' | 'vulkan' | 'hlsl' | 'msl';

/** A language in which the functions of a scene are written. */
export type Language = 'wgsl' | 'glsl' | 'glsl450' | 'hlsl' | 'msl' | 'spirv';

/** A function of a module. */
export type FunctionName = 'field' | 'bound' | 'distance' | 'gradient' | 'trace' | 'shadow' | 'collision' | 'occlusion' | 'surface';

/** How a scene is read. */
export interface SceneOptions {
  /** What the text is called in messages, and its name without the ending in what is written. `scene.sdf` if it is left out. */
  name?: string;
  /** Files that the scene names: imports as text, grids (`.sfgrid`) as bytes. */
  files?: Record<string, string | Uint8Array>;
  /** Fixes parameters that are a choice. */
  set?: Record<string, string | number>;
  /** A factor that is measured and not proven is an error. */
  strict?: boolean;
  /** Uses nothing that earlier calls found. The result is the same; it takes as long as the first time. */
  fresh?: boolean;
}

/** What is written. */
export interface CompileOptions extends SceneOptions {
  /** A host, or a language that takes the scene's functions. `wgsl` if it is left out. `hlsl` and `msl` are hosts unless `functions` or `prefix` is given. */
  for?: Host | Language;
  /** For a language: the functions. All of them if this is left out. */
  functions?: FunctionName[];
  /** For a language: what names begin with; `sf_` if it is left out. */
  prefix?: string;
  /** For a language: adds entry points that draw the scene. */
  draw?: boolean;
  /** For a host: how its file ends, where there are several forms (`vulkan`: `spv`, `frag`, `vert`). */
  ending?: string;
}

/** A part of a text. All numbers but `bytes` count units of UTF-16, as JavaScript does. */
export interface Place {
  /** The name of the text. */
  file: string;
  /** From the beginning of the text, in units of UTF-16. */
  start: number;
  end: number;
  /** The same in bytes of UTF-8. */
  bytes: [start: number, end: number];
  /** From 1. */
  line: number;
  column: number;
  endLine: number;
  endColumn: number;
}

/** What was found in a text. */
export interface Diagnostic extends Place {
  severity: 'error' | 'warning';
  /** The name that `surefoot explain` knows. */
  code: string;
  message: string;
  /** What to do about it. */
  help: string;
  /** Other places that have to do with it. */
  labels: (Place & { message: string })[];
}

/** A parameter of a scene. */
export interface Parameter {
  name: string;
  type: 'float' | 'int' | 'bool' | 'vec2' | 'vec3' | 'vec4' | 'color' | 'choice';
  default: number | number[] | string | null;
  min?: number | number[];
  max?: number | number[];
  /** Whether it is an angle, which a person reads in degrees. Numbers are radians. */
  degrees?: boolean;
  /** The unit in which the text writes it. */
  unit?: string | null;
  choices?: string[];
  description: string | null;
}

/** What was written. */
export interface Compiled {
  /** The file: text, or bytes of SPIR-V. */
  output: string | Uint8Array;
  /** A name for it. */
  file: string;
  /** Files that go with it, by their names. */
  beside: Record<string, string | Uint8Array>;
  warnings: Diagnostic[];
  /** What of the scene was left out. */
  notes: string[];
  parameters: Parameter[];
}

/** What a page draws a scene from. */
export interface Drawn {
  /** Where values stand in the uniform block, counted in numbers of 32 bits: `view_eye`, `time`, `parameter melt`, … */
  fields: Record<string, number>;
  /** The uniform block at the start, as words of 32 bits. */
  start: number[];
  parameters: Parameter[];
  /** Whether the scene reads the time. */
  moves: boolean;
  /** A module with the entry points `sf_vertex` and `sf_fragment`. */
  wgsl: string;
  /** A fragment shader for WebGL 2; null where that can't draw the scene. */
  glsl: string | null;
  /** Storage buffers, bound after the uniforms. */
  buffers: Uint8Array[];
}

/** The scene has errors. */
export class SceneError extends Error {
  diagnostics: Diagnostic[];
}

/** The compiler itself stopped, for lack of memory or by a mistake of its own. The next call starts it anew. */
export class CompilerError extends Error {}

/** A compiler with a memory of its own. */
export class Compiler {
  /** `source` is the module of WebAssembly, its bytes or its address; else it is `surefoot.wasm` beside this module. */
  constructor(source?: WebAssembly.Module | ArrayBuffer | Uint8Array | URL | string);
  compile(text: string, options?: CompileOptions): Promise<Compiled>;
  check(text: string, options?: SceneOptions): Promise<Diagnostic[]>;
  draw(text: string, options?: SceneOptions): Promise<{ scene: Drawn | null; diagnostics: Diagnostic[]; parameters: Parameter[]; notes: string[] }>;
  format(text: string): Promise<string | null>;
  tokens(text: string): Promise<[start: number, end: number, kind: string][]>;
}

/** Writes a scene for a host or in a language. Throws a {@link SceneError} where it has errors. */
export function compile(text: string, options?: CompileOptions): Promise<Compiled>;
/** What is wrong with a scene: errors and warnings in their order. */
export function check(text: string, options?: SceneOptions): Promise<Diagnostic[]>;
/** What a page draws the scene from; `scene` is null where it has errors. */
export function draw(text: string, options?: SceneOptions): Promise<{ scene: Drawn | null; diagnostics: Diagnostic[]; parameters: Parameter[]; notes: string[] }>;
/** The text in the usual form; null where it can't be read. */
export function format(text: string): Promise<string | null>;
/** The tokens of a text, each with its kind: `keyword`, `name`, `number`, … */
export function tokens(text: string): Promise<[start: number, end: number, kind: string][]>;
