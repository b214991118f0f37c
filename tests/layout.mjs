// Whether the descriptions of modules that `surefoot compile --layout` writes are as docs/layout.schema.json says:
//
//     node layout.mjs FILE.json…

import { readFileSync } from 'node:fs';
import { dirname, join } from 'node:path';
import { fileURLToPath } from 'node:url';
import Ajv from 'ajv/dist/2020.js';

const schema = JSON.parse(readFileSync(join(dirname(fileURLToPath(import.meta.url)), '..', 'docs', 'layout.schema.json'), 'utf8'));
const fits = new Ajv({ allErrors: true, strict: true, allowUnionTypes: true, strictRequired: false }).compile(schema);
const files = process.argv.slice(2);
if (!files.length) {
  console.error('usage: node layout.mjs FILE.json…');
  process.exit(2);
}
let wrong = 0;
for (const file of files) {
  const layout = JSON.parse(readFileSync(file, 'utf8'));
  if (!fits(layout)) {
    wrong += 1;
    for (const error of fits.errors) console.error(`${file}: ${error.instancePath || '/'} ${error.message}`);
  }
}
// A schema that took everything would say nothing.
const broken = [{}, { ...JSON.parse(readFileSync(files[0], 'utf8')), version: 2 }, { ...JSON.parse(readFileSync(files[0], 'utf8')), more: 1 }];
if (broken.some((layout) => fits(layout))) {
  wrong += 1;
  console.error('the schema takes what it should not');
}
console.log(`${files.length} descriptions, ${wrong} wrong`);
process.exitCode = wrong ? 1 : 0;
