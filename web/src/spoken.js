// What a screen reader says without being asked: the status line, the mistakes once typing pauses.

/** Milliseconds between two words on progress, so that they do not talk over what is read. */
const PROGRESS = 5000;
/** Milliseconds for which the region is empty, so that words are heard a second time too. */
const EMPTY = 50;

let told = 0;
let next;

export function speak(words) {
  told = Date.now();
  const region = document.getElementById("spoken");
  region.textContent = "";
  clearTimeout(next);
  next = setTimeout(() => (region.textContent = words), EMPTY);
}

/** Speaks of work under way, now and then. */
export function speakProgress(words) {
  if (Date.now() - told > PROGRESS) speak(words);
}
