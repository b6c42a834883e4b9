// Marks from the language server: semantic colours, numbers of terms, foldable ranges.
import { foldGutter, foldService } from "@codemirror/language";
import { RangeSetBuilder, StateEffect, StateField } from "@codemirror/state";
import { Decoration, EditorView, ViewPlugin, WidgetType } from "@codemirror/view";
import { LSPPlugin } from "@codemirror/lsp-client";

/** Milliseconds without a change before the text and the requests go to the server; until then old marks move with
 * the text. */
const PAUSE = 50;

const answered = StateEffect.define();

const NOTHING = { colours: Decoration.none, hints: Decoration.none, folds: [] };

/** Removes all marks from a text whose server has ended. */
export const unmarked = answered.of(NOTHING);

/** `{colours, hints, folds}`: sets of ranges. */
const marks = StateField.define({
  create: () => NOTHING,
  update(value, transaction) {
    for (const effect of transaction.effects) if (effect.is(answered)) return effect.value;
    if (!transaction.docChanged) return value;
    const { changes } = transaction;
    const moved = ({ from, to }) => ({ from: changes.mapPos(from, 1), to: changes.mapPos(to, -1) });
    return { colours: value.colours.map(changes), hints: value.hints.map(changes), folds: value.folds.map(moved) };
  },
  provide: (field) => [
    EditorView.decorations.from(field, ({ colours }) => colours),
    EditorView.decorations.from(field, ({ hints }) => hints),
  ],
});

/** Semantic tokens in the packed form of the protocol: each position is relative to the one before. */
function colours(doc, data, kinds) {
  const builder = new RangeSetBuilder();
  let line = 0;
  let start = 0;
  for (let at = 0; at < data.length; at += 5) {
    const [down, right, length, kind] = data.slice(at, at + 4);
    line += down;
    start = down === 0 ? start + right : right;
    const from = doc.line(line + 1).from + start;
    builder.add(from, from + length, Decoration.mark({ class: `sid-${kinds[kind]}` }));
  }
  return builder.finish();
}

/** An inlay hint after a statement. */
class Hint extends WidgetType {
  constructor(label, about) {
    super();
    this.label = label;
    this.about = about;
  }

  eq(other) {
    return other.label === this.label && other.about === this.about;
  }

  toDOM() {
    const element = document.createElement("span");
    element.className = "sid-hint";
    element.textContent = this.label;
    element.title = this.about;
    return element;
  }
}

function hints(doc, found) {
  const at = ({ line, character }) => doc.line(line + 1).from + character;
  const widget = ({ position, label, tooltip }) =>
    Decoration.widget({ widget: new Hint(label, tooltip ?? ""), side: 1 }).range(at(position));
  return Decoration.set(found.map(widget), true);
}

const folds = (doc, found) => found.map(({ startLine, endLine }) => ({ from: doc.line(startLine + 1).to, to: doc.line(endLine + 1).to }));

const folding = foldService.of((state, start, end) => {
  const here = ({ from, to }) => start <= from && from <= end && to > end;
  return state.field(marks).folds.find(here) ?? null;
});

/** The fold gutter, which is redrawn when the server has answered. */
const gutter = foldGutter({
  foldingChanged: ({ transactions }) => transactions.some(({ effects }) => effects.some((effect) => effect.is(answered))),
});

/** Queries the server after each change, and shows its answers. */
export function serverMarks(client, uri) {
  const plugin = class {
    constructor(view) {
      this.view = view;
      this.later();
    }

    update(update) {
      if (update.docChanged) this.later();
    }

    later() {
      clearTimeout(this.pause);
      // Without an answer there are no marks.
      this.pause = setTimeout(() => this.ask().catch(() => {}), PAUSE);
    }

    async ask() {
      await client.initializing;
      client.sync();
      const { doc } = this.view.state;
      const textDocument = { uri };
      const range = { start: { line: 0, character: 0 }, end: { line: doc.lines, character: 0 } };
      const [tokens, numbers, ranges] = await Promise.all([
        client.request("textDocument/semanticTokens/full", { textDocument }),
        client.request("textDocument/inlayHint", { textDocument, range }),
        client.request("textDocument/foldingRange", { textDocument }),
      ]);
      if (!tokens || doc !== this.view.state.doc || !LSPPlugin.get(this.view)) return;
      const { tokenTypes } = client.serverCapabilities.semanticTokensProvider.legend;
      const value = { colours: colours(doc, tokens.data, tokenTypes), hints: hints(doc, numbers ?? []), folds: folds(doc, ranges ?? []) };
      this.view.dispatch({ effects: answered.of(value) });
    }

    destroy() {
      clearTimeout(this.pause);
    }
  };
  return [marks, folding, gutter, ViewPlugin.fromClass(plugin)];
}
