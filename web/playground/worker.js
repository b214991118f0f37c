// The compiler, beside the page: typing never waits for it. Answers one request after another, each with its number.

import { Compiler, SceneError } from './surefoot/surefoot.js';

let compiler = null;

onmessage = async ({ data }) => {
  if (data.module) {
    compiler = new Compiler(data.module);
    return;
  }
  const { number, what, text, options } = data;
  try {
    postMessage({ number, answer: await compiler[what](text, options) });
  } catch (error) {
    postMessage({ number, failed: error.message, diagnostics: error instanceof SceneError ? error.diagnostics : null });
  }
};
