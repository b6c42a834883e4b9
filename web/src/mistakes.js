// Mistakes as text, for users who cannot see underlines, and for those without a hovering pointer or F8.
import { forEachDiagnostic, nextDiagnostic, previousDiagnostic } from "@codemirror/lint";
import { EditorView } from "@codemirror/view";
import { speak } from "./spoken.js";

/** Milliseconds without a change before mistakes are announced: half-typed words are usually wrong. */
const PAUSE = 1500;

let pause;
let told = "";

/** Errors and warnings in the order of the text. */
function mistakes(state) {
  const found = [];
  forEachDiagnostic(state, (d, from, to) => {
    if (d.severity === "error" || d.severity === "warning") found.push({ ...d, from, to });
  });
  return found;
}

const line = (state, { from }) => state.doc.lineAt(from).number;

const count = ({ length }) => ["no mistakes", "1 mistake"][length] ?? `${length} mistakes`;

/** A mistake as a sentence. */
const words = (state, mistake) => `${mistake.severity}, line ${line(state, mistake)}: ${mistake.message}`;

/** The number of mistakes, and the one nearest to the cursor. */
function summary(state) {
  const found = mistakes(state);
  if (found.length === 0) return "";
  const here = line(state, { from: state.selection.main.head });
  const far = (mistake) => Math.abs(line(state, mistake) - here);
  const near = found.reduce((a, b) => (far(b) < far(a) ? b : a));
  return `${count(found)}; line ${line(state, near)}: ${near.message.split("\n", 1)[0]}`;
}

/** Announces the mistakes when typing pauses, if they have changed. */
export function speakMistakes(view) {
  clearTimeout(pause);
  pause = setTimeout(() => {
    const said = summary(view.state);
    const here = view.hasFocus || document.activeElement === button();
    if (said !== told && here) speak(said || count([]));
    told = said;
  }, PAUSE);
}

const button = () => document.getElementById("count");
const list = () => document.getElementById("mistakes");

/** A mistake with a button for each of its fixes; `fix` is called with the index of the fix. */
function item(state, mistake, fix) {
  const said = document.createElement("p");
  said.textContent = words(state, mistake);
  const fixes = mistake.actions.map(({ name }, which) => {
    const press = document.createElement("button");
    press.type = "button";
    press.textContent = name;
    press.addEventListener("click", () => fix(which));
    return press;
  });
  const entry = document.createElement("li");
  entry.append(said, ...fixes);
  return entry;
}

/** Lists the current mistakes. */
export function listMistakes(view) {
  const found = mistakes(view.state);
  button().textContent = count(found);
  button().classList.toggle("some", found.length > 0);
  const fix = (place) => (which) => {
    mistakes(view.state)[place]?.actions[which]?.apply(view);
    // The list will be replaced. Until then no fix may be applied twice, and the focus moves to an element that stays.
    for (const old of list().querySelectorAll("button")) old.disabled = true;
    button().focus();
  };
  const fresh = list().cloneNode();
  fresh.append(...found.map((mistake, place) => item(view.state, mistake, fix(place))));
  // An unchanged list is kept, so that a user reading it does not lose the place.
  if (!fresh.isEqualNode(list())) list().replaceChildren(...fresh.children);
}

function open(shown) {
  list().hidden = !shown;
  button().ariaExpanded = String(shown);
}

button().addEventListener("click", () => open(list().hidden));

/** Tapping a mistake opens the list, since touch screens have no hovering pointer. */
export const mistakeTaps = EditorView.domEventHandlers({
  pointerup({ pointerType, target }) {
    if (pointerType !== "touch" || !target.closest(".cm-lintRange-error, .cm-lintRange-warning, .cm-lintPoint")) return;
    open(true);
    list().scrollIntoView({ block: "nearest" });
  },
});

/** Moves to a mistake and announces it. */
const going = (go) => (view) => {
  const went = go(view);
  const { from, to } = view.state.selection.main;
  let here;
  forEachDiagnostic(view.state, (d, start, end) => {
    if (start === from && end === to) here ??= { ...d, from: start };
  });
  speak(here ? words(view.state, here) : count([]));
  return went;
};

export const mistakeKeys = [
  { key: "F8", run: going(nextDiagnostic) },
  { key: "Shift-F8", run: going(previousDiagnostic) },
];
