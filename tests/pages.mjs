// Pages of all examples, as `surefoot export` writes them: how large each is, how soon a browser without WebGPU shows its first picture, and how many
// pixels of it differ from the program's.
//
//     node pages.mjs PROGRAM FOLDER       writes docs/pages.md
//
// PROGRAM is surefoot, with `alike` beside it; FOLDER takes the files and pictures. A time is one run on the machine as it was: pages are small, and
// nearly all of it is the compilation of their shader.

import { spawnSync } from 'node:child_process';
import { mkdirSync, readdirSync, statSync, writeFileSync } from 'node:fs';
import { dirname, join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { cpus } from 'node:os';

const [program, work] = process.argv.slice(2);
const tests = dirname(fileURLToPath(import.meta.url));
const examples = join(tests, '..', 'examples');
mkdirSync(work, { recursive: true });

const run = (command, ...args) => {
  const { status, stdout, stderr } = spawnSync(command, args, { encoding: 'utf8' });
  return { fine: status === 0, says: `${stdout}${stderr}`.trim() };
};
const rows = [];
for (const file of readdirSync(examples).filter((name) => name.endsWith('.sdf')).sort()) {
  const name = file.slice(0, -4);
  const scene = join(examples, file);
  const [page, ours, theirs] = ['html', 'ours.png', 'theirs.png'].map((end) => join(work, `${name}.${end}`));
  const made = run(program, 'export', scene, '-o', page, '--no-poster', '--bare');
  const drawn = run(program, 'render', scene, '-o', ours, '--size', '640x360', '--samples', '1', '--device', 'gpu');
  if (!made.fine || !drawn.fine) throw new Error(`${name}: ${made.says}\n${drawn.says}`);
  const left = [...made.says.matchAll(/left out: ([^;]+);/g)].map((match) => match[1]);
  const opened = run('node', join(tests, 'hosts.mjs'), page, theirs, 'webgl');
  const seconds = opened.says.match(/first picture after ([\d.]+) s/)?.[1];
  const differ = opened.fine ? run(join(dirname(program), 'alike'), ours, theirs).says.match(/([\d.]+) % of/)?.[1] : undefined;
  const why = opened.says.includes('by WebGPU alone') ? 'WebGPU alone' : opened.says.split('\n')[0];
  rows.push([name, Math.round(statSync(page).size / 1000), seconds ?? why, differ ?? '', left.join(', ')]);
  console.log(rows.at(-1).join('  '));
}
const table = [['scene', 'page, KB', 'first picture, s', 'pixels that differ, %', 'left out'], ['---', '--:', '--:', '--:', '---'], ...rows];
writeFileSync(join(tests, '..', 'docs', 'pages.md'), `# Pages of the examples

\`surefoot export SCENE.sdf -o PAGE.html\` writes one page. These were opened in Chromium without a screen and without WebGPU: WebGL 2 by
SwiftShader, a program, on ${cpus().length} cores, with whatever else the machine did. The first picture stands there once the shader is
compiled; it is small, and the next one is not. A pixel differs if a colour is more than 12 of 255 levels from the picture of \`surefoot render --samples 1\`. Where
something is left out, that is what differs. Pages with a poster are larger by its 20 to 60 KB.

\`node tests/pages.mjs target/debug/surefoot FOLDER\` writes this page.

${table.map((row) => `| ${row.join(' | ')} |`).join('\n')}
`);
