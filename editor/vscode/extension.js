// Starts `surefoot lsp` for the scenes that are open.

const vscode = require("vscode");
const { spawn } = require("node:child_process");
const { LanguageClient } = require("vscode-languageclient/node");

let client;

function program() {
  return vscode.workspace.getConfiguration("surefoot").get("path") || "surefoot";
}

async function start() {
  const run = { command: program(), args: ["lsp"] };
  client = new LanguageClient("surefoot", "Surefoot", { run, debug: run }, { documentSelector: [{ language: "surefoot" }] });
  try {
    await client.start();
  } catch (error) {
    const choice = await vscode.window.showErrorMessage(`Surefoot: can't start \`${program()} lsp\`: ${error.message}`, "Set the path");
    if (choice) {
      vscode.commands.executeCommand("workbench.action.openSettings", "surefoot.path");
    }
  }
}

async function stop() {
  const old = client;
  client = undefined;
  if (old) {
    // One that never started can't be stopped.
    await old.stop().catch(() => {});
  }
}

async function restart() {
  await stop();
  await start();
}

// The live window shows what is on disk, and follows it.
async function view() {
  const editor = vscode.window.activeTextEditor;
  if (!editor || editor.document.isUntitled) {
    return;
  }
  await editor.document.save();
  const child = spawn(program(), [editor.document.uri.fsPath], { detached: true, stdio: "ignore" });
  child.on("error", (error) => vscode.window.showErrorMessage(`Surefoot: can't start \`${program()}\`: ${error.message}`));
  child.unref();
}

exports.activate = async function activate(context) {
  context.subscriptions.push(
    vscode.commands.registerCommand("surefoot.restart", restart),
    vscode.commands.registerCommand("surefoot.view", view),
    vscode.workspace.onDidChangeConfiguration((event) => {
      if (event.affectsConfiguration("surefoot.path")) {
        restart();
      }
    }),
  );
  await start();
};

exports.deactivate = stop;
