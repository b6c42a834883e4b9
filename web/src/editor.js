// The model editor: CodeMirror with the language server.
import { isolateHistory } from "@codemirror/commands";
import { EditorState } from "@codemirror/state";
import { EditorView, keymap } from "@codemirror/view";
import { setDiagnostics } from "@codemirror/lint";
import { LSPClient, LSPPlugin, languageServerExtensions } from "@codemirror/lsp-client";
import { Broken, Cancelled } from "./compiler.js";
import { listMistakes, mistakeKeys, mistakeTaps, speakMistakes } from "./mistakes.js";
import { setup } from "./setup.js";
import { serverMarks, unmarked } from "./server_marks.js";

const URI = "file:///model.sid";

/** Elements in the server's explanations; all others, which could come from a model's text, become plain text. */
const ALLOWED = new Set(["P", "PRE", "CODE", "EM", "STRONG", "UL", "OL", "LI", "BR", "SPAN", "TABLE", "THEAD", "TBODY", "TR", "TH", "TD", "HR"]);

function sanitized(html) {
  const { body } = new DOMParser().parseFromString(html, "text/html");
  for (const element of body.querySelectorAll("*")) {
    if (!ALLOWED.has(element.tagName)) element.replaceWith(element.textContent);
    else for (const { name } of [...element.attributes]) if (name !== "class") element.removeAttribute(name);
  }
  return body.innerHTML;
}

/** The language server in a worker, as a transport for CodeMirror's client; `lost` is called when the worker crashed. */
class Transport {
  #compiler;
  #lost;
  #broken = false;
  #handlers = new Set();

  constructor(compiler, lost) {
    this.#compiler = compiler;
    this.#lost = lost;
  }

  send(message) {
    if (this.#broken) return this.#silence(message);
    const failed = (error) => {
      this.#silence(message);
      if (this.#broken || !(error instanceof Broken || error instanceof Cancelled)) return;
      this.#broken = true;
      // Pending calls are answered first.
      setTimeout(this.#lost);
    };
    this.#compiler.call("message", message).then((answers) => this.#tell(answers), failed);
  }

  /** Answers a request with null. */
  #silence(message) {
    const { id, method } = JSON.parse(message);
    if (id === undefined || method === "initialize") return;
    setTimeout(() => this.#tell([JSON.stringify({ jsonrpc: "2.0", id, result: null })]));
  }

  #tell(answers) {
    for (const answer of answers) for (const handler of this.#handlers) handler(answer);
  }

  subscribe(handler) {
    this.#handlers.add(handler);
  }

  unsubscribe(handler) {
    this.#handlers.delete(handler);
  }
}

const SEVERITIES = ["error", "error", "warning", "info", "hint"];

/** Shows diagnostics, each with its fixes. */
async function show(client, { uri, version, diagnostics }) {
  const file = client.workspace.getFile(uri);
  const view = file?.getView();
  const plugin = view && LSPPlugin.get(view);
  if (!plugin || (version ?? file.version) !== file.version) return;
  const ask = ({ range }) =>
    client.request("textDocument/codeAction", { textDocument: { uri }, range, context: { diagnostics: [] } });
  const fixes = await Promise.all(diagnostics.map(ask));
  if (version !== undefined && version !== file.version) return;
  const offset = (position) => plugin.unsyncedChanges.mapPos(plugin.fromPosition(position, plugin.syncedDoc));
  const action = ({ title, edit }) => ({
    name: title,
    apply(view) {
      const changes = edit.changes[uri].map(({ range, newText }) => ({
        from: offset(range.start),
        to: offset(range.end),
        insert: newText,
      }));
      view.dispatch({ changes });
    },
  });
  const found = diagnostics.map((d, place) => ({
    from: offset(d.range.start),
    to: offset(d.range.end),
    severity: SEVERITIES[d.severity ?? 1],
    message: d.message,
    source: d.code,
    actions: (fixes[place] ?? []).filter((fix) => fix.diagnostics.some((of) => of.message === d.message)).map(action),
  }));
  view.dispatch(setDiagnostics(view.state, found));
  listMistakes(view);
  speakMistakes(view);
}

export class Editor {
  #view;
  #client;
  #compiler;
  #broken;
  #restarted = false;

  /** `changed` is called after each change of the text, `run` when the user requests a run by keyboard, `broken` after the language
   * server crashed, with whether there is a new one. */
  constructor(parent, compiler, { changed, run, broken }) {
    this.#compiler = compiler;
    this.#broken = broken;
    const publish = (client, params) => (show(client, params), true);
    this.#client = new LSPClient({
      sanitizeHTML: sanitized,
      timeout: 30000,
      extensions: languageServerExtensions(),
      notificationHandlers: { "textDocument/publishDiagnostics": publish },
    });
    this.#connect();
    const changes = EditorView.updateListener.of((update) => {
      if (update.docChanged) changed();
    });
    this.#view = new EditorView({
      parent,
      state: EditorState.create({
        extensions: [
          keymap.of([{ key: "Mod-Enter", run: () => (run(), true) }, ...mistakeKeys]),
          setup,
          EditorView.lineWrapping,
          EditorView.contentAttributes.of({ "aria-label": "Model", "aria-describedby": "keys" }),
          this.#client.plugin(URI, "sid"),
          serverMarks(this.#client, URI),
          mistakeTaps,
          changes,
        ],
      }),
    });
  }

  #connect() {
    this.#client.connect(new Transport(this.#compiler, () => this.#lost()));
  }

  /** A crashed server is restarted once; after a second crash the text is probably the cause. */
  #lost() {
    const again = !this.#restarted;
    this.#restarted = true;
    if (again) {
      this.#client.disconnect();
      this.#connect();
    } else {
      this.#view.dispatch(setDiagnostics(this.#view.state, []), { effects: unmarked });
    }
    this.#broken(again);
  }

  get text() {
    return this.#view.state.doc.toString();
  }

  /** Replaces the text; undo restores the previous one. */
  set text(text) {
    const changes = { from: 0, to: this.#view.state.doc.length, insert: text };
    this.#view.dispatch({ changes, annotations: isolateHistory.of("full") });
  }
}
