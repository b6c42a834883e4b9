// Mistakes, for those who do not see them underlined, and for those who have neither a pointer that hovers nor F8.
import { forEachDiagnostic, nextDiagnostic, previousDiagnostic } from "@codemirror/lint";
import { EditorView } from "@codemirror/view";
import { speak } from "./spoken.js";

/** Milliseconds without a change after which mistakes are told: half-typed words are wrong most of the time. */
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

/** A mistake in full. */
const words = (state, mistake) => `${mistake.severity}, line ${line(state, mistake)}: ${mistake.message}`;

/** How many mistakes there are, and what the one nearest to the cursor is. */
function summary(state) {
  const found = mistakes(state);
  if (found.length === 0) return "";
  const here = line(state, { from: state.selection.main.head });
  const far = (mistake) => Math.abs(line(state, mistake) - here);
  const near = found.reduce((a, b) => (far(b) < far(a) ? b : a));
  return `${count(found)}; line ${line(state, near)}: ${near.message.split("\n", 1)[0]}`;
}

/** Tells the mistakes once nothing was typed for a while; nothing if they are as they were. */
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

/** A mistake with a button for each of its fixes; `fix` is called with the place of the fix. */
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

/** Lists the mistakes as they are now. */
export function listMistakes(view) {
  const found = mistakes(view.state);
  button().textContent = count(found);
  button().classList.toggle("some", found.length > 0);
  const fix = (place) => (which) => {
    mistakes(view.state)[place]?.actions[which]?.apply(view);
    // The list comes anew; until then nothing is mended twice, and the focus is on what stays.
    for (const old of list().querySelectorAll("button")) old.disabled = true;
    button().focus();
  };
  const fresh = list().cloneNode();
  fresh.append(...found.map((mistake, place) => item(view.state, mistake, fix(place))));
  // Whoever reads the list keeps the place while it stays the same.
  if (!fresh.isEqualNode(list())) list().replaceChildren(...fresh.children);
}

function open(shown) {
  list().hidden = !shown;
  button().ariaExpanded = String(shown);
}

button().addEventListener("click", () => open(list().hidden));

/** A mistake that is tapped opens the list: a finger does not hover. */
export const mistakeTaps = EditorView.domEventHandlers({
  pointerup({ pointerType, target }) {
    if (pointerType !== "touch" || !target.closest(".cm-lintRange-error, .cm-lintRange-warning, .cm-lintPoint")) return;
    open(true);
    list().scrollIntoView({ block: "nearest" });
  },
});

/** Goes to a mistake and tells it. */
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
