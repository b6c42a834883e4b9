// CodeMirror's basic setup without its fold gutter, which does not know the server.
import { autocompletion, closeBrackets, closeBracketsKeymap, completionKeymap } from "@codemirror/autocomplete";
import { defaultKeymap, history, historyKeymap } from "@codemirror/commands";
import { bracketMatching, foldKeymap, indentOnInput } from "@codemirror/language";
import { lintKeymap } from "@codemirror/lint";
import { highlightSelectionMatches, searchKeymap } from "@codemirror/search";
import { EditorState } from "@codemirror/state";
import * as view from "@codemirror/view";

/** Separates a name from its detail for screen readers: in an option, the name has position 50 and its detail 80. */
const comma = {
  position: 60,
  render() {
    const element = document.createElement("span");
    element.className = "unseen";
    element.textContent = ", ";
    return element;
  },
};

export const setup = [
  view.lineNumbers(),
  view.highlightActiveLineGutter(),
  view.highlightSpecialChars(),
  history(),
  view.drawSelection(),
  view.dropCursor(),
  EditorState.allowMultipleSelections.of(true),
  indentOnInput(),
  bracketMatching(),
  closeBrackets(),
  autocompletion({ addToOptions: [comma] }),
  view.rectangularSelection(),
  view.crosshairCursor(),
  view.highlightActiveLine(),
  highlightSelectionMatches(),
  view.keymap.of([
    ...closeBracketsKeymap,
    ...defaultKeymap,
    ...searchKeymap,
    ...historyKeymap,
    ...foldKeymap,
    ...completionKeymap,
    ...lintKeymap,
  ]),
];
