// A page that `compile --for html` writes: finds its scene in itself and shows it. draw.js and show.js stand before this in the same script.

const scene = JSON.parse(document.getElementById('scene').textContent);
const canvas = document.querySelector('canvas');
const says = document.getElementById('says');

// What is packed in a text: zlib's form, in base 64.
const unpacked = (text) => {
  const bytes = Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
  return new Response(new Blob([bytes]).stream().pipeThrough(new DecompressionStream('deflate')));
};
const packed = scene.buffers;
scene.code = () => unpacked(document.getElementById('module').textContent).text();
scene.glsl = () => {
  const text = document.getElementById('glsl')?.textContent;
  return text ? unpacked(text).text() : null;
};
scene.buffers = () => Promise.all(packed.map((text) => unpacked(text).arrayBuffer()));

async function start() {
  uniforms(scene);
  const { way, picture } = await open(canvas, scene, (why) => { says.textContent = why; });
  document.body.dataset.by = way.name;
  const pause = document.getElementById('pause');
  const began = () => { document.body.dataset.first = Math.round(performance.now()); };
  await show(canvas, way, picture, scene, { form: document.querySelector('form'), pause, began }).rests();
  if (pause?.hidden) pause.remove();
}

// Who drives this page waits for one of the two.
start().then(
  () => { document.body.dataset.state = 'drawn'; },
  (error) => { says.textContent = error.message; document.body.dataset.state = 'failed'; },
);
