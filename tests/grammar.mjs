// The grammar for VS Code colours every token of every scene as the window does.
//
//     node tests/grammar.mjs PROGRAM FILE…
//
// PROGRAM is `surefoot`: it says what the window's classes are. A token is right if each of its characters has the token's class.

import { execFileSync } from "node:child_process";
import { readFileSync } from "node:fs";
import { createRequire } from "node:module";

const require = createRequire(import.meta.url);
const oniguruma = require("vscode-oniguruma");
const { Registry, INITIAL } = require("vscode-textmate");

const [program, ...files] = process.argv.slice(2);
const root = new URL("..", import.meta.url);
const grammarPath = new URL("editor/vscode/syntaxes/surefoot.tmLanguage.json", root);

// A scope's class; the innermost scope that has one counts.
const CLASSES = [
  ["comment.line.documentation", "doc"],
  ["comment", "comment"],
  ["string", "text"],
  ["constant.character.escape", "text"],
  ["constant.other.color", "color"],
  ["constant.numeric", "number"],
  ["keyword.control", "keyword"],
  ["keyword.operator", "operator"],
  ["storage.type", "kind"],
  ["entity.name", "name"],
  ["variable", "name"],
];

function classOf(scopes) {
  for (const scope of [...scopes].reverse()) {
    const known = CLASSES.find(([prefix]) => scope.startsWith(prefix));
    if (known) return known[1];
  }
  return "none";
}

await oniguruma.loadWASM(readFileSync(require.resolve("vscode-oniguruma/release/onig.wasm")));
const registry = new Registry({
  onigLib: Promise.resolve({
    createOnigScanner: (patterns) => new oniguruma.OnigScanner(patterns),
    createOnigString: (text) => new oniguruma.OnigString(text),
  }),
  loadGrammar: async () => JSON.parse(readFileSync(grammarPath, "utf8")),
});
const grammar = await registry.loadGrammar("source.surefoot");
const json = execFileSync(program, ["reference", "--grammar"], { encoding: "utf8" });
let wrong = json === readFileSync(grammarPath, "utf8") ? 0 : 1;
if (wrong) console.log("the grammar's file is not what `surefoot reference --grammar` writes");

let count = 0;
for (const file of files) {
  const text = readFileSync(file, "utf8");
  // The class of each unit of UTF-16.
  const found = [];
  let stack = INITIAL;
  for (const line of text.split("\n")) {
    const { tokens, ruleStack } = grammar.tokenizeLine(line, stack);
    stack = ruleStack;
    const start = found.length;
    for (const token of tokens) {
      for (let at = token.startIndex; at < Math.min(token.endIndex, line.length); at++) found[start + at] = classOf(token.scopes);
    }
    found.length = start + line.length;
    found.push("end");
  }
  const bytes = Buffer.from(text, "utf8");
  const expected = JSON.parse(execFileSync(program, ["reference", "--tokens", file], { encoding: "utf8", maxBuffer: 1 << 28 }));
  for (const [first, last, wanted] of expected) {
    const start = bytes.subarray(0, first).toString("utf8").length;
    const token = bytes.subarray(first, last).toString("utf8");
    count++;
    const bad = [...Array(token.length).keys()].find((at) => token[at] !== "\n" && found[start + at] !== wanted && !(found[start + at] === "none" && token[at].trim() === ""));
    if (bad !== undefined) {
      wrong++;
      const line = text.slice(0, start).split("\n").length;
      console.log(`${file}:${line}: \`${token}\` is ${found[start + bad]} and should be ${wanted}`);
    }
  }
}
console.log(`${count} tokens of ${files.length} files, ${wrong} wrong`);
process.exit(wrong === 0 && count > 1000 ? 0 : 1);
