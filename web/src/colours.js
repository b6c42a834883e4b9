// Colours by meaning: the semantic tokens of the language server as marks in the text.
import { RangeSetBuilder, StateEffect, StateField } from "@codemirror/state";
import { Decoration, EditorView, ViewPlugin } from "@codemirror/view";
import { LSPPlugin } from "@codemirror/lsp-client";

/** Milliseconds without a change after which the text goes to the server, and with it the question for colours; until then the old ones move
 * with the text. */
const PAUSE = 50;

const marked = StateEffect.define();

const marks = StateField.define({
  create: () => Decoration.none,
  update(value, transaction) {
    for (const effect of transaction.effects) if (effect.is(marked)) return effect.value;
    return value.map(transaction.changes);
  },
  provide: (field) => EditorView.decorations.from(field),
});

/** Tokens as the protocol packs them: each place relative to the one before. */
function decorations(doc, data, kinds) {
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

export function colours(client, uri) {
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
      this.pause = setTimeout(() => this.ask(), PAUSE);
    }

    async ask() {
      await client.initializing;
      client.sync();
      const { doc } = this.view.state;
      const tokens = await client.request("textDocument/semanticTokens/full", { textDocument: { uri } });
      if (!tokens || doc !== this.view.state.doc || !LSPPlugin.get(this.view)) return;
      const { tokenTypes } = client.serverCapabilities.semanticTokensProvider.legend;
      this.view.dispatch({ effects: marked.of(decorations(doc, tokens.data, tokenTypes)) });
    }

    destroy() {
      clearTimeout(this.pause);
    }
  };
  return [marks, ViewPlugin.fromClass(plugin)];
}
