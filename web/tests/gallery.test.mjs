// Every model of the gallery gives in the page what it gives in the program: the same document, but for rounding.
import assert from "node:assert/strict";
import { execFile } from "node:child_process";
import { mkdtempSync, readFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after, before, describe, test } from "node:test";
import { promisify } from "node:util";
import { example, root, run, start } from "./page.mjs";

// SIDC names the program; without it, that of `cargo test` is used.
const program = process.env.SIDC ?? join(root, "target/debug/sidc");
const folder = mkdtempSync(join(tmpdir(), "sidc-"));

/** Difference that rounding makes: functions like `sin` differ in the last digit between a browser and the program. */
const SAME = 1e-9;

/** What a search over noisy data may make of it, in standard errors. */
const SAME_ERRORS = 1e-4;

/** Relative difference of errors of predictions: they are differences themselves. */
const SAME_PREDICTION = 1e-6;

let site;
before(async () => (site = await start()));
after(() => site.stop());

/** The document of the program. */
async function expected(model, data) {
  const written = join(folder, `${model}.json`);
  const tables = data.map((name) => join(root, "models/data", name));
  try {
    await promisify(execFile)(program, ["identify", join(root, "models", model), ...tables, "-q", "-o", written]);
  } catch (error) {
    // 3: an answer with doubts.
    if (error.code !== 3) throw error;
  }
  return JSON.parse(readFileSync(written, "utf8"));
}

/** What a document claims, word for word; behind it there are figures of how it was searched, which rounding may change. */
function claims({ equations, failed, verdict, warnings, signals, settings }) {
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
    signals: signals.map(({ signal, origin }) => [signal, origin]),
    settings,
  };
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
  own.verdict.prediction?.signals?.forEach(({ signal, spread, error }, place) => {
    const other = page.verdict.prediction.signals[place].error;
    const allowed = SAME_PREDICTION * Math.max(error.rms, 1e-3 * spread);
    assert.ok(Math.abs(other.rms - error.rms) <= allowed, `error of ${signal}: ${other.rms} and ${error.rms}`);
  });
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
