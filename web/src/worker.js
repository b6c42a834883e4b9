// The compiler in a worker. A page has two: one answers the editor, the other runs models; a run is cancelled by ending its worker.
//
// In: {id, call, args}. Out: {id, value} or {id, fault}, and {progress} in between.
import initialize, { Data, Editor, Model, targets } from "sidc-bindings";

/** Bytes at the start of a data file that contain its header. */
const HEADER = 1 << 16;

const NO_DATA =
  "error[no-data]: there are no data\n  = help: choose a table under `Data`, drop one on the page, or take an example; a link brings a model without its data";

/** A cancelled run ended the worker together with the results of an earlier run. */
const GONE = "what was found went when a later run was cancelled; run the model again for its report and code";

let editor;
let data;
let found;

const progress = (words) => postMessage({ progress: words });

async function read(files) {
  const all = new Data();
  for (const file of files) {
    progress(`reading ${file.name}`);
    all.add(file.name, new Uint8Array(await file.arrayBuffer()));
  }
  return all;
}

const calls = {
  async start(module) {
    await initialize({ module_or_path: module });
    return targets();
  },
  message(text) {
    editor ??= new Editor();
    return editor.receive(text);
  },
  async tables(files) {
    editor ??= new Editor();
    editor.clear();
    for (const file of files) {
      editor.table(file.name, new Uint8Array(await file.slice(0, HEADER).arrayBuffer()));
    }
  },
  async draft(files) {
    return (await read(files.slice(0, 1))).draft();
  },
  async identify(model, files, holdout) {
    // Mistakes in the model are reported before the data, which take long to read.
    const compiled = new Model(model.name, model.text);
    if (files.length === 0) throw NO_DATA;
    data = await read(files);
    found = compiled.identify(data, holdout, progress);
    return { answer: found.answer(), passes: found.passes(), document: found.document() };
  },
  report() {
    if (!found) throw GONE;
    return found.report(data, progress);
  },
  export(target) {
    if (!found) throw GONE;
    return found.export(target);
  },
};

onmessage = async ({ data: { id, call, args } }) => {
  try {
    postMessage({ id, value: await calls[call](...args) });
  } catch (fault) {
    // The compiler's faults are strings; anything else crashed the worker, usually exhausted memory.
    postMessage(typeof fault === "string" ? { id, fault } : { id, fault: String(fault), broken: true });
  }
};
