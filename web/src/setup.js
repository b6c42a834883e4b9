// What an editor of text has anyway: the basic setup of CodeMirror, without its gutter of folds, which knows no server.
import { autocompletion, closeBrackets, closeBracketsKeymap, completionKeymap } from "@codemirror/autocomplete";
import { defaultKeymap, history, historyKeymap } from "@codemirror/commands";
import { bracketMatching, foldKeymap, indentOnInput } from "@codemirror/language";
import { lintKeymap } from "@codemirror/lint";
import { highlightSelectionMatches, searchKeymap } from "@codemirror/search";
import { EditorState } from "@codemirror/state";
import * as view from "@codemirror/view";

/** Parts a name from what it is, for those who hear both: in the order of an option, the name has place 50 and its detail 80. */
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
