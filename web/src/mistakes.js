// Mistakes, for those who do not see them underlined.
import { forEachDiagnostic, nextDiagnostic, previousDiagnostic } from "@codemirror/lint";
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

/** How many mistakes there are, and what the one nearest to the cursor is. */
function summary(state) {
  const found = mistakes(state);
  if (found.length === 0) return "";
  const here = line(state, { from: state.selection.main.head });
  const far = (mistake) => Math.abs(line(state, mistake) - here);
  const near = found.reduce((a, b) => (far(b) < far(a) ? b : a));
  const count = found.length === 1 ? "1 mistake" : `${found.length} mistakes`;
  return `${count}; line ${line(state, near)}: ${near.message.split("\n", 1)[0]}`;
}

/** Tells the mistakes once nothing was typed for a while; nothing if they are as they were. */
export function speakMistakes(view) {
  clearTimeout(pause);
  pause = setTimeout(() => {
    const words = summary(view.state);
    if (words !== told && view.hasFocus) speak(words || "no mistakes");
    told = words;
  }, PAUSE);
}

/** Goes to a mistake and tells it. */
const going = (go) => (view) => {
  const went = go(view);
  const { from, to } = view.state.selection.main;
  let here;
  forEachDiagnostic(view.state, (d, start, end) => {
    if (start === from && end === to) here ??= { ...d, from: start };
  });
  speak(here ? `${here.severity}, line ${line(view.state, here)}: ${here.message}` : "no mistakes");
  return went;
};

export const mistakeKeys = [
  { key: "F8", run: going(nextDiagnostic) },
  { key: "Shift-F8", run: going(previousDiagnostic) },
];
