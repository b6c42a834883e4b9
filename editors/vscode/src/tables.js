// The tables that a model is run on: the user picks some from the model's folder, or opens others.
//
// VS Code's own dialog accepts only one file if the window and the files are on different machines.
const fs = require("node:fs");
const path = require("node:path");
const vscode = require("vscode");

/** Where the language server looks for columns: the model's folder, and its subfolder `data`. */
const FOLDERS = ["", "data"];
const EXTENSIONS = ["csv", "tsv", "txt", "dat"];

/** The paths last chosen for each model. */
const chosen = new Map();

/** The paths of at least one table, or `undefined` if the user cancelled. */
async function tables(model) {
  const found = beside(model);
  const last = chosen.get(model) ?? likely(model, found);
  const files = [...new Set([...last, ...found])];
  const taken = files.length === 0 ? await others(model) : await pick(model, files, last);
  if (!taken?.length) return undefined;
  chosen.set(model, taken);
  return taken;
}

function beside(model) {
  const isTable = (name) => EXTENSIONS.includes(path.extname(name).slice(1).toLowerCase());
  return FOLDERS.flatMap((name) => {
    const folder = path.join(path.dirname(model), name);
    try {
      const entries = fs.readdirSync(folder, { withFileTypes: true });
      const names = entries.filter((e) => !e.isDirectory() && isTable(e.name)).map((e) => e.name);
      return names.sort().map((table) => path.join(folder, table));
    } catch {
      return [];
    }
  });
}

/** The table with the model's name, or the only one. */
function likely(model, found) {
  if (found.length === 1) return found;
  return found.filter((table) => path.parse(table).name === path.parse(model).name);
}

async function pick(model, files, last) {
  const folder = path.dirname(model);
  const items = files.map((file) => {
    const inside = path.relative(folder, file);
    return { label: inside.startsWith("..") ? file : inside, file, picked: last.includes(file) };
  });
  const taken = await vscode.window.showQuickPick([...items, { label: "Other files…" }], {
    canPickMany: true,
    title: `Tables for ${path.basename(model)}`,
    placeHolder: "Each table is a trajectory of its own",
  });
  if (!taken) return undefined;
  const own = taken.filter(({ file }) => file).map(({ file }) => file);
  return own.length === taken.length ? own : [...own, ...((await others(model)) ?? [])];
}

async function others(model) {
  const uris = await vscode.window.showOpenDialog({
    canSelectMany: true,
    defaultUri: vscode.Uri.file(path.dirname(model)),
    filters: { Tables: EXTENSIONS, All: ["*"] },
    openLabel: "Use these data",
  });
  return uris?.map((uri) => uri.fsPath);
}

module.exports = { tables };
