// A link that holds a scene in its fragment: JSON, packed by deflate, in the letters of base64url. No server sees it.

const through = async (bytes, stream) => new Uint8Array(await new Response(new Blob([bytes]).stream().pipeThrough(stream)).arrayBuffer());

// The fragment of a scene.
export async function packed(scene) {
  const bytes = await through(new TextEncoder().encode(JSON.stringify(scene)), new CompressionStream('deflate-raw'));
  const letters = Array.from(bytes, (byte) => String.fromCharCode(byte)).join('');
  return `#s=${btoa(letters).replaceAll('+', '-').replaceAll('/', '_').replaceAll('=', '')}`;
}

// A longer text than this in a link is refused: some bytes may unpack to very many.
const MOST = 4 << 20;

// The scene of a fragment; null where it has none, an error where it can't be read.
export async function unpacked(fragment) {
  const letters = fragment.match(/^#s=([\w-]+)$/)?.[1];
  if (!letters) return null;
  const bytes = Uint8Array.from(atob(letters.replaceAll('-', '+').replaceAll('_', '/')), (letter) => letter.charCodeAt(0));
  const pieces = [];
  let length = 0;
  const reader = new Blob([bytes]).stream().pipeThrough(new DecompressionStream('deflate-raw')).getReader();
  for (let piece = await reader.read(); !piece.done; piece = await reader.read()) {
    length += piece.value.length;
    if (length > MOST) throw new Error('the text is too long');
    pieces.push(piece.value);
  }
  const scene = JSON.parse(await new Blob(pieces).text());
  if (typeof scene?.text !== 'string') throw new Error('it holds no text');
  return { text: scene.text, title: typeof scene.title === 'string' ? scene.title : 'scene', set: only(scene.set, (value) => typeof value === 'string'), kept: moved(scene.kept) };
}

// The entries of what may be an object, as far as they fit.
const only = (object, fits) => Object.fromEntries(Object.entries(Object(object)).filter(([, value]) => fits(value)));

// What a person moved, as far as a link says it as `kept` of show.js does: anyone may write a link.
function moved(kept) {
  const numbers = (values) => values.every(Number.isFinite);
  const { view, time, running } = Object(kept);
  const { home, turn, rise, nearer } = Object(view);
  return {
    parameters: only(kept?.parameters, (pair) => Array.isArray(pair) && pair.length === 2 && numbers(pair)),
    time: Number.isFinite(time) ? time : null,
    running: running !== false,
    view: numbers([turn, rise, nearer]) ? { home, turn, rise, nearer: Math.min(20, Math.max(0.05, nearer)) } : undefined,
  };
}
