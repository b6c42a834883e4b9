// Announcements for screen readers: the status line, and mistakes when typing pauses.

/** Milliseconds between progress announcements, so that they do not interrupt other reading. */
const PROGRESS = 5000;
/** Milliseconds for which the region is empty, so that repeated words are announced again. */
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

/** Announces progress from time to time. */
export function speakProgress(words) {
  if (Date.now() - told > PROGRESS) speak(words);
}
