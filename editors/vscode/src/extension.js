// Starts `sidc lsp`, and runs the program on the model in the editor. The server implements the language itself.
const fs = require("node:fs");
const os = require("node:os");
const path = require("node:path");
const vscode = require("vscode");
const { LanguageClient } = require("vscode-languageclient/node");
const { fitted } = require("./page.js");
const { absent, missing, options, program, run } = require("./program.js");
const { tables } = require("./tables.js");

let client;
let output;
/** Starts are queued. */
let served = Promise.resolve();

async function activate(context) {
  output = vscode.window.createOutputChannel("sidc");
  context.subscriptions.push(
    output,
    vscode.commands.registerCommand("sidc.identify", identify),
    vscode.commands.registerCommand("sidc.check", check),
    vscode.commands.registerCommand("sidc.report", report),
    vscode.workspace.onDidChangeConfiguration((change) => {
      if (change.affectsConfiguration("sidc.path")) served = served.then(serve);
    }),
  );
  served = serve();
  await served;
}

/** Starts the language server with the program in the settings, replacing an earlier one. */
async function serve() {
  const before = client;
  client = undefined;
  await before?.dispose();
  const why = await absent();
  if (why !== undefined) {
    missing(why);
    return;
  }
  const server = { command: program(), args: ["lsp"] };
  client = new LanguageClient("sidc", "sidc language server", server, { documentSelector: [{ language: "sid" }] });
  // The client reports its own failures.
  await client.start().catch(() => {});
}

function deactivate() {
  return client?.dispose();
}

/** The saved model in the editor, and the tables that the user chooses for it. */
async function inputs() {
  const document = vscode.window.activeTextEditor?.document;
  if (document?.languageId !== "sid") {
    vscode.window.showErrorMessage("Open a model (.sid) first");
    return undefined;
  }
  if (document.uri.scheme !== "file") {
    vscode.window.showErrorMessage("Save the model first: the program reads it from its file");
    return undefined;
  }
  if (!(await document.save())) return undefined;
  const model = document.uri.fsPath;
  const data = await tables(model);
  return data && { model, data, folder: path.dirname(model) };
}

function show({ code, text, cancelled }, args) {
  output.clear();
  output.appendLine(`$ sidc ${args.join(" ")}`);
  output.append(text);
  if (cancelled) output.appendLine("cancelled");
  output.show(true);
  if (typeof code === "string") missing(code);
}

async function check() {
  const files = await inputs();
  if (!files) return;
  const args = ["check", files.model, ...files.data];
  show(await run("Checking", args, files.folder), args);
}

async function identify() {
  const files = await inputs();
  if (!files) return;
  const args = ["identify", files.model, ...files.data, ...options()];
  show(await run("Identifying", args, files.folder), args);
}

async function report() {
  const files = await inputs();
  if (!files) return;
  const folder = fs.mkdtempSync(path.join(os.tmpdir(), "sidc-"));
  try {
    const result = path.join(folder, "result.json");
    const page = path.join(folder, "report.html");
    const found = ["identify", files.model, ...files.data, "-o", result, ...options()];
    const identified = await run("Identifying", found, files.folder);
    // Equations with doubts have a report too.
    if (identified.cancelled || !fs.existsSync(result)) return show(identified, found);
    const args = ["report", result, ...files.data, "-o", page];
    const written = await run("Writing the report", args, files.folder);
    if (!fs.existsSync(page)) return show(written, args);
    const title = `${path.basename(files.model, ".sid")}: report`;
    const panel = vscode.window.createWebviewPanel("sidc.report", title, vscode.ViewColumn.Beside, {
      enableScripts: true,
      retainContextWhenHidden: true,
    });
    panel.webview.html = fitted(fs.readFileSync(page, "utf8"));
  } finally {
    fs.rmSync(folder, { recursive: true, force: true });
  }
}

module.exports = { activate, deactivate };
