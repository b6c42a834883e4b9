// Starts `sidc lsp`, and runs the program on the model in the editor. The language itself is the server's.
const path = require("node:path");
const os = require("node:os");
const fs = require("node:fs");
const { execFile } = require("node:child_process");
const vscode = require("vscode");
const { LanguageClient } = require("vscode-languageclient/node");

let client;
let output;
/** The data chosen last for a model, by its path. */
const chosen = new Map();

function settings() {
  return vscode.workspace.getConfiguration("sidc");
}

function program() {
  return settings().get("path") || "sidc";
}

async function activate(context) {
  output = vscode.window.createOutputChannel("sidc");
  const server = { command: program(), args: ["lsp"] };
  const options = { documentSelector: [{ language: "sid" }] };
  client = new LanguageClient("sidc", "sidc", server, options);
  context.subscriptions.push(
    output,
    vscode.commands.registerCommand("sidc.identify", identify),
    vscode.commands.registerCommand("sidc.check", check),
    vscode.commands.registerCommand("sidc.report", report),
  );
  try {
    await client.start();
  } catch (error) {
    const told = `sidc does not start (${error.message}); the setting sidc.path names the program`;
    vscode.window.showErrorMessage(told);
  }
}

function deactivate() {
  return client?.stop();
}

/** The model in the editor, saved, and the tables that the user chooses for it. */
async function inputs() {
  const document = vscode.window.activeTextEditor?.document;
  if (document?.languageId !== "sid") {
    vscode.window.showErrorMessage("Open a model (.sid) first");
    return undefined;
  }
  if (document.isUntitled || !(await document.save())) return undefined;
  const model = document.uri.fsPath;
  const last = chosen.get(model);
  const data = await vscode.window.showOpenDialog({
    canSelectMany: true,
    defaultUri: last?.[0] ?? vscode.Uri.file(path.dirname(model)),
    filters: { Tables: ["csv", "tsv", "txt", "dat"], All: ["*"] },
    openLabel: "Use these data",
  });
  if (!data?.length) return undefined;
  chosen.set(model, data);
  return { model, data: data.map((uri) => uri.fsPath) };
}

/** Runs the program with progress that can be cancelled; status, output and messages. */
function run(title, args, cwd) {
  const options = { location: vscode.ProgressLocation.Notification, title, cancellable: true };
  return vscode.window.withProgress(options, (_, token) =>
    new Promise((resolve) => {
      const limits = { cwd, maxBuffer: 1 << 28 };
      const child = execFile(program(), args, limits, (error, stdout, stderr) =>
        resolve({ status: error ? error.code : 0, stdout, stderr }),
      );
      // The program ends its work and prints what it has.
      token.onCancellationRequested(() => child.kill("SIGINT"));
    }),
  );
}

function show({ status, stdout, stderr }, words) {
  output.clear();
  output.appendLine(`$ ${words.join(" ")}`);
  output.append(stderr + stdout);
  output.show(true);
  if (typeof status !== "number") {
    vscode.window.showErrorMessage(`sidc does not start (${status}); the setting sidc.path names the program`);
  }
}

async function check() {
  const files = await inputs();
  if (!files) return;
  const args = ["check", files.model, ...files.data];
  show(await run("Checking", args, path.dirname(files.model)), ["sidc", ...args]);
}

async function identify() {
  const files = await inputs();
  if (!files) return;
  const args = ["identify", files.model, ...files.data, ...settings().get("arguments")];
  show(await run("Identifying", args, path.dirname(files.model)), ["sidc", ...args]);
}

async function report() {
  const files = await inputs();
  if (!files) return;
  const folder = fs.mkdtempSync(path.join(os.tmpdir(), "sidc-"));
  const cwd = path.dirname(files.model);
  try {
    const result = path.join(folder, "result.json");
    const page = path.join(folder, "report.html");
    const found = ["identify", files.model, ...files.data, "-o", result, ...settings().get("arguments")];
    const identified = await run("Identifying", found, cwd);
    // Equations with doubts have a report too.
    if (!fs.existsSync(result)) return show(identified, ["sidc", ...found]);
    const args = ["report", result, ...files.data, "-o", page];
    const written = await run("Writing the report", args, cwd);
    if (!fs.existsSync(page)) return show(written, ["sidc", ...args]);
    const title = `${path.basename(files.model, ".sid")}: report`;
    const panel = vscode.window.createWebviewPanel("sidc.report", title, vscode.ViewColumn.Beside, {
      enableScripts: true,
    });
    panel.webview.html = fs.readFileSync(page, "utf8");
  } finally {
    fs.rmSync(folder, { recursive: true, force: true });
  }
}

module.exports = { activate, deactivate };
