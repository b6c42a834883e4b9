// The page: inputs, a run, its results.
import { Cancelled, Compiler, Refusal } from "./compiler.js";
import { Editor } from "./editor.js";
import { pack, unpack } from "./link.js";
import { Results } from "./results.js";
import { speak, speakProgress } from "./spoken.js";

const element = (id) => document.getElementById(id);

/** Name of a model without a name. */
const OWN = "model.sid";
const START = "state x\n\ndx ~ poly(x; 3)\n";

const module = compiled();
const language = new Compiler(module);
const runner = new Compiler(module, progress);
const results = new Results(runner, say);

/** The data files, in the order of their runs. */
let files = [];
/** The example whose data are shown, until the user changes them. */
let example = "";
/** The example opened last, `{name, text}`; undefined once another model replaced it. */
let opened;
let name = OWN;
/** The examples, `{model, data}`. */
let examples = [];
/** Counts openings, so that of two concurrent downloads the later one is shown. */
let openings = 0;
/** Counts the changes of model, data and settings. */
let changes = 0;

/** The compiler, decompressed and compiled while it downloads. */
async function compiled() {
  const { body } = await fetched("sidc.wasm.gz");
  const unpacked = body.pipeThrough(new DecompressionStream("gzip"));
  return WebAssembly.compileStreaming(new Response(unpacked, { headers: { "content-type": "application/wasm" } }));
}

/** Shows words in the status line and announces them; `more` is only announced. */
function say(words, more = "") {
  element("status").textContent = words;
  speak(words + more);
}

function progress(words) {
  element("status").textContent = `${words} …`;
  speakProgress(words);
}

const editor = new Editor(element("editor"), language, { changed, run, broken });

/** The model, the data or a setting has changed. */
function changed() {
  changes += 1;
  results.outdate();
  nameModel();
}

/** The editor's compiler crashed; a new one needs the headers of the data again. */
function broken(again) {
  if (again) {
    tell();
    say("the editor's compiler broke and was started anew; the text is as it was");
  } else {
    const lost = "The editor's compiler broke again: mistakes, completion and colours are gone until the page is loaded anew. Runs still work.";
    element("keys").textContent = lost;
    element("count").hidden = true;
    element("mistakes").hidden = true;
    say(lost);
  }
}

/** Passes the data files to the editor. */
function tell() {
  language.call("tables", files).catch(() => {});
}

// Data

function setFiles(given) {
  files = given;
  const items = files.map((file, place) => {
    const item = document.createElement("li");
    const remove = document.createElement("button");
    remove.type = "button";
    remove.textContent = "Remove";
    remove.setAttribute("aria-label", `Remove ${file.name}`);
    remove.addEventListener("click", () => changeFiles(files.filter((_, other) => other !== place)));
    item.append(`${file.name}, ${size(file.size)} `, remove);
    return item;
  });
  element("tables").replaceChildren(...items);
  element("draft").hidden = files.length === 0;
  changed();
  tell();
}

function size(bytes) {
  if (bytes < 1e6) return `${(bytes / 1e3).toPrecision(2)} kB`;
  return `${(bytes / 1e6).toPrecision(3)} MB`;
}

function changeFiles(given) {
  example = "";
  setFiles(given);
}

/** Takes files that were chosen or dropped: a model is opened; tables replace those of an example. */
async function take(given) {
  const models = given.filter((file) => file.name.endsWith(".sid"));
  const tables = given.filter((file) => !file.name.endsWith(".sid"));
  if (models.length > 0) {
    const text = await models[0].text();
    leave();
    setModel(models[0].name, text);
  }
  if (tables.length > 0) changeFiles(example === "" ? [...files, ...tables] : tables);
}

element("files").addEventListener("change", ({ target }) => {
  take([...target.files]);
  target.value = "";
});
addEventListener("dragover", (event) => event.preventDefault());
addEventListener("drop", (event) => {
  if (event.dataTransfer.files.length === 0) return;
  event.preventDefault();
  take([...event.dataTransfer.files]);
}, true);

element("draft").addEventListener("click", () =>
  work(async () => {
    setModel(OWN, await runner.call("draft", files));
    say("a first model, guessed from the data; read it before you run it");
  }),
);

// Models

function setName(given) {
  name = given;
  element("model-name").textContent = name;
}

/** Shows a model that is not an example. */
function setModel(given, text) {
  openings += 1;
  opened = undefined;
  setName(given);
  editor.text = text;
}

/** A changed example gets the name of the user's own model until the change is undone. */
function nameModel() {
  const same = opened?.text === editor.text;
  if (opened) setName(same ? opened.name : OWN);
  element("examples").value = same && opened.name === example ? example : "";
}

/** Ends work on a model that is about to be replaced. */
function leave() {
  if (working()) runner.cancel("cancelled: another model was opened");
}

async function fetched(path) {
  const answer = await fetch(path);
  if (!answer.ok) throw new Error(`${path}: ${answer.status}`);
  return answer;
}

/** Opens an example: its data and its model, or another text. */
async function open({ model, data }, text) {
  openings += 1;
  const opening = openings;
  const read = async (file) => new File([await (await fetched(`gallery/${file}`)).arrayBuffer()], file);
  const [own, ...tables] = await Promise.all([read(model), ...data.map(read)]);
  const lines = (await own.text()).replaceAll("\r\n", "\n");
  if (opening !== openings) return;
  leave();
  opened = { name: model, text: lines };
  example = model;
  editor.text = text ?? lines;
  setFiles(tables);
}

// Runs

const working = () => element("cancel").ariaDisabled === "false";

/** Marks which button is active. Neither is disabled, since a disabled button would lose the focus of a user who just pressed it. */
function setWorking(now) {
  element("run").ariaDisabled = String(now);
  element("cancel").ariaDisabled = String(!now);
}

/** Does one piece of work, and reports its end in the status line. */
async function work(piece) {
  if (working()) return;
  setWorking(true);
  document.body.classList.add("working");
  const [model, before] = [name, changes];
  try {
    await piece();
  } catch (error) {
    if (error instanceof Cancelled) say(error.message);
    else if (error instanceof Refusal) {
      results.refuse(error.message, model);
      say("no answer: see the message");
    } else {
      say(`a fault of this page: ${error.message}`);
      throw error;
    }
  } finally {
    if (changes !== before) results.outdate();
    setWorking(false);
    document.body.classList.remove("working");
  }
}

function run() {
  work(async () => {
    say("running …");
    const began = performance.now();
    const model = { name, text: editor.text };
    const before = changes;
    const found = await runner.call("identify", model, files, Number(element("holdout").value));
    const seconds = (performance.now() - began) / 1000;
    results.show(found, model.name);
    const outdated = changes === before ? "" : "; outdated, there was a change meanwhile";
    const answer = "; the answer is under the heading Results";
    say(`${found.passes ? "found" : "found, with doubts"}, in ${seconds.toPrecision(2)} s${outdated}`, answer);
  });
}

element("run").addEventListener("click", run);
element("cancel").addEventListener("click", () => working() && runner.cancel());
element("holdout").addEventListener("change", changed);
element("share").addEventListener("click", async () => {
  const hash = await pack({ text: editor.text, holdout: Number(element("holdout").value), example });
  history.replaceState(null, "", hash);
  try {
    await navigator.clipboard.writeText(location.href);
    say("the link is copied; it holds the model and the settings, not the data");
  } catch {
    say("the link is in the address bar; it holds the model and the settings, not the data");
  }
});

const byName = (model) => examples.find((e) => e.model === model);

/** Shows the model in a link. A link has no data, so tables that the user chose are kept. */
async function follow({ text, holdout, example: named }) {
  setHoldOut(holdout);
  const chosen = byName(named);
  if (chosen) return open(chosen, text);
  leave();
  setModel(OWN, text);
  if (example !== "") changeFiles([]);
}

/** Sets the held-out part, which in a link may differ from the choices on this page. */
function setHoldOut(part) {
  const select = element("holdout");
  const value = String(part);
  const known = [...select.options].some((option) => option.value === value);
  if (!known) select.add(new Option(`the last ${Number((100 * part).toPrecision(3))} %`, value));
  select.value = value;
  changed();
}

/** A link was entered in the address of the open page. */
async function linkChanged() {
  const { hash } = location;
  const linked = await unpack(hash);
  if (hash !== location.hash || hash === "") return;
  if (!linked) return say("this link cannot be read; the model is as it was");
  await follow(linked);
  say("the model is that of the link");
}

/** Starts the page with its link or the first example. */
async function begin() {
  examples = await (await fetched("gallery/index.json")).json();
  for (const { model } of examples) element("examples").add(new Option(model.slice(0, -4), model));
  setFiles([]);
  const linked = await unpack(location.hash);
  if (linked) await follow(linked);
  else if (examples.length > 0) await open(examples[0]);
  else setModel(OWN, START);
  results.setTargets(await runner.ready);
  say("ready");
}

/** A download failed: everything stays as it was, including the field of examples. */
function notLoaded({ message }) {
  nameModel();
  say(`this could not be loaded: ${message}`);
}

element("examples").addEventListener("change", ({ target }) => {
  const chosen = byName(target.value);
  if (chosen) open(chosen).catch(notLoaded);
  else changeFiles(files);
});
addEventListener("hashchange", () => linkChanged().catch(notLoaded));

begin().catch((error) => say(`this page could not be loaded: ${error.message}`));
