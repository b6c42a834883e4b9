// Every model of the gallery gives the same document in the page and in the program, except for rounding.
import assert from "node:assert/strict";
import { execFile } from "node:child_process";
import { mkdtempSync, readFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after, before, describe, test } from "node:test";
import { promisify } from "node:util";
import { example, root, run, start } from "./page.mjs";

// SIDC is the path of the program; by default that of `cargo test` is used.
const program = process.env.SIDC ?? join(root, "target/debug/sidc");
const folder = mkdtempSync(join(tmpdir(), "sidc-"));

/** Allowed difference relative to a number's size or 1: functions like `sin` differ in the last digit between browsers and the program. */
const SAME = 1e-9;

/** Parts of a document with larger allowed differences relative to a number's size or 1 (Infinity: rounding decides), and why. */
const LOOSER = [
  [/\.(iterations|tried)$/, Infinity, "steps until a search has settled"],
  [/\.without\b/, Infinity, "the answer without a term is no law: many supports are as good, and rounding chooses"],
  [/\.identifiability\.(relations|findings)\b/, Infinity, "of relations that hold to the same digit rounding chooses one to name"],
  [/\.nearest\.(longer|earns)$/, 1e-1, "what is left of exact data is rounding"],
  [/\.stability$/, 0.05, "a share of draws; one of them may be on the edge"],
  [/\.run\.signals\[\d+\]\.(fit_percent|follows)$/, Infinity, "along a chaotic motion any difference grows until it is as large as the signal"],
  [/\.prediction\..*\.(error|linear)\./, 1e-6, "differences themselves, which grow along the horizon"],
  [/\.certificate(_range\[\d+\])?\./, 1e-5, "at unknown constants, which are found to a part of their standard error"],
  [/\.(coefficient|interval\[\d\]|standard_error|value|neighbour\[\d\])$/, 1e-6, "of noisy data: a search ends at a part of the standard error"],
  [/^\.correlations\[\d+\]\.below\[\d+\]$/, 1e-5, "of estimates that end at a part of their standard errors"],
  [/\.(excitation\[\d+\]|isometry|leverage\[\d+\]|channels\[\d+\])\.|\.condition$/, 1e-6, "of states that such a search has found"],
];

/** Allowed difference of coefficients and constants in noisy data, in standard errors. */
const SAME_ERRORS = 1e-4;

let site;
before(async () => (site = await start()));
after(() => site.stop());

/** The program's document. */
async function expected(model, data) {
  const written = join(folder, `${model}.json`);
  const tables = data.map((name) => join(root, "models/data", name));
  try {
    await promisify(execFile)(program, ["identify", join(root, "models", model), ...tables, "-q", "-o", written]);
  } catch (error) {
    // Status 3: an answer with doubts.
    if (error.code !== 3) throw error;
  }
  return JSON.parse(readFileSync(written, "utf8"));
}

/** The claims of a document, which must be equal. */
function claims({ equations, failed, verdict, warnings }) {
  return {
    equations: equations.map(({ target, status, reasons, terms }) => ({
      target,
      status,
      reasons: reasons.map(({ code }) => code),
      terms: terms.map(({ term, mark }) => [term, mark]),
    })),
    failed: failed.map(({ target }) => target),
    verdict: [verdict.law, verdict.prediction?.good, verdict.run?.status],
    warnings: warnings.map(({ code }) => code),
  };
}

/** All differences between two documents beyond rounding. */
function* differences(page, own, path = "") {
  const allowed = LOOSER.find(([places]) => places.test(path))?.[1] ?? SAME;
  if (allowed === Infinity) return;
  if (typeof own === "object" && own !== null && typeof page === "object" && page !== null) {
    const inside = (key) => (Array.isArray(own) ? `${path}[${key}]` : `${path}.${key}`);
    for (const key of new Set([...Object.keys(own), ...Object.keys(page)])) yield* differences(page[key], own[key], inside(key));
  } else if (typeof own === "number" && typeof page === "number") {
    if (!(Math.abs(page - own) <= allowed * Math.max(Math.abs(own), 1))) yield `${path}: ${page} and ${own}`;
  } else if (page !== own) {
    yield `${path}: ${page} and ${own}`;
  }
}

/** Every coefficient and unknown constant, with its standard error. */
function numbers({ equations, unknowns = [] }) {
  const terms = equations.flatMap(({ target, terms }) => terms.map((t) => ({ name: `${target}: ${t.term}`, value: t.coefficient, error: t.standard_error })));
  return [...terms, ...unknowns.map((u) => ({ name: u.name, value: u.value, error: u.standard_error }))];
}

function assertSame(page, own) {
  assert.deepEqual(claims(page), claims(own));
  const theirs = numbers(page);
  numbers(own).forEach(({ name, value, error }, place) => {
    const allowed = Math.max(SAME * Math.abs(value), SAME_ERRORS * (error ?? 0));
    assert.ok(Math.abs(theirs[place].value - value) <= allowed, `${name}: ${theirs[place].value} and ${value}`);
  });
  assert.deepEqual([...differences(page, own)], []);
}

const examples = JSON.parse(readFileSync(join(root, "web/dist/gallery/index.json"), "utf8"));
describe("gallery", { concurrency: 2 }, () => {
  for (const { model, data } of examples) {
    test(model, async () => {
      const page = await site.open();
      await example(page, model, data.length);
      const [said, own] = await Promise.all([run(page), expected(model, data)]);
      assert.match(said, /^found/);
      assertSame(JSON.parse(await page.textContent("#document")), own);
      assert.deepEqual(page.faults, []);
      await page.context().close();
    });
  }
});
