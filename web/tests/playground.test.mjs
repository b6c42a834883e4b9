// Tests the page as users use it: files, mistakes, links, cancelling, keyboard; and its network requests.
import assert from "node:assert/strict";
import { createHash } from "node:crypto";
import { readFileSync } from "node:fs";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { answer, choose, example, link, root, run, saved, start, status, write } from "./page.mjs";

let site;
before(async () => (site = await start()));
after(() => site.stop());

/** A test on a new page, which must end without faults and without requests other than for the page's own files. */
function scene(name, act, options = {}) {
  test(name, async () => {
    const page = await site.open(options);
    await act(page);
    assert.deepEqual(page.faults, []);
    assert.deepEqual(page.requests.filter((url) => !url.startsWith(`${site.origin}/`) && !url.startsWith("blob:")), []);
    await page.context().close();
  });
}

const DECAY = ["t,x", ...Array.from({ length: 80 }, (_, k) => `${k / 10},${2 * Math.exp(-0.05 * k)}`)].join("\n");

scene("nothing is asked of the network once the page is ready, whatever is run", async (page) => {
  const before = page.requests.length;
  await choose(page, [{ name: "decay.csv", text: DECAY }]);
  await write(page, "state x\ndx ~ poly(x; 3)\n");
  assert.match(await run(page), /^found, in/);
  assert.match(await page.textContent("#answer"), /^dx = -0\.5\*x\n/);
  // The frame of the report is a file of the page itself.
  await page.click("#tab-report");
  await status(page, /written/);
  await page.click("#tab-code");
  await page.waitForFunction(() => document.getElementById("code").textContent.includes("def "));
  const later = page.requests.slice(before).filter((url) => !url.startsWith("blob:"));
  assert.deepEqual(new Set(later), new Set([`${site.origin}/frame.html`]));
});

scene("a report names the files by their content", async (page) => {
  await choose(page, [{ name: "decay.csv", text: DECAY }]);
  await write(page, "state x\ndx ~ poly(x; 3)\n");
  await run(page);
  const { files } = JSON.parse(await page.textContent("#document")).settings;
  const hash = (text) => createHash("sha256").update(text).digest("hex");
  assert.deepEqual(files, [
    { name: "model.sid", sha256: hash("state x\ndx ~ poly(x; 3)\n") },
    { name: "decay.csv", sha256: hash(DECAY) },
  ]);
  await page.click("#tab-report");
  await status(page, /written/);
  const row = page.frameLocator("#report").locator("tr", { hasText: hash(DECAY) });
  assert.match(await row.innerText(), /decay\.csv[^]*data, the same here/);
});

scene("mistakes are shown while they are typed, with fixes that mend them", async (page) => {
  await write(page, "state theta : order 2\nddtheta ~ poly(theta, dthta; 2)\n");
  await page.hover(".cm-lintRange-error");
  const message = page.locator(".cm-diagnostic-error");
  assert.match(await message.innerText(), /no signal named `dthta`/);
  await message.locator(".cm-diagnosticAction", { hasText: "dtheta" }).click();
  await page.waitForFunction(() => document.querySelectorAll(".cm-lintRange-error").length === 0);
  assert.match(await page.innerText(".cm-content"), /poly\(theta, dtheta; 2\)/);
});

scene("mistakes are read and mended by touch", async (page) => {
  const button = page.getByRole("button", { name: /mistake/ });
  const items = page.getByRole("list", { name: "Mistakes" }).getByRole("listitem");
  const counts = (words) => page.waitForFunction((words) => document.getElementById("count").textContent === words, words);
  await counts("no mistakes");
  await write(page, "state theta : order 2\nddtheta ~ poly(theta, dthta, thta; 2)\n");
  await counts("2 mistakes");
  assert.equal(await items.count(), 0);
  await page.tap(".cm-lintRange-error");
  assert.match(await items.nth(0).innerText(), /^error, line 2: no signal named `dthta`/);
  assert.equal(await items.getByRole("button").count(), 2);
  assert.equal(await page.evaluate(() => document.documentElement.scrollWidth - innerWidth), 0);
  await items.nth(1).getByRole("button", { name: "by `theta`" }).tap();
  await counts("1 mistake");
  assert.match(await page.innerText(".cm-content"), /poly\(theta, dthta, theta; 2\)/);
  // The same by keyboard: the button has the focus.
  assert.equal(await button.evaluate((e) => e === document.activeElement), true);
  await page.keyboard.press("Tab");
  await page.keyboard.press("Enter");
  await counts("no mistakes");
  await button.tap();
  assert.equal(await button.getAttribute("aria-expanded"), "false");
}, { viewport: { width: 320, height: 640 }, hasTouch: true, isMobile: true });

scene("libraries show their size, and statements fold", async (page) => {
  await write(page, "state x, y\nlet both = poly(\n  x, y; 2)\ndx, dy ~ both\n");
  await page.waitForFunction(() => document.querySelectorAll(".sid-hint").length === 2);
  assert.deepEqual(await page.locator(".sid-hint").allInnerTexts(), ["6 terms", "6 terms"]);
  await page.click(".cm-line >> text=let both");
  await page.keyboard.press("Control+Shift+BracketLeft");
  await page.waitForSelector(".cm-foldPlaceholder");
  assert.doesNotMatch(await page.innerText(".cm-content"), /x, y; 2/);
});

scene("what can be folded has its mark without a further change", async (page) => {
  await write(page, "state x, y\nlet both = poly(\n  x, y; 2)\ndx, dy ~ both\n");
  await page.waitForFunction(() => document.querySelectorAll(".cm-foldGutter [title='Fold line']").length === 1);
});

scene("an editor whose compiler broke has a fresh one, once", async (page) => {
  await choose(page, [{ name: "decay.csv", text: DECAY.replace("t,x", "t,Winkel") }]);
  const [first, runner] = page.workers();
  const breaks = (worker) =>
    worker.evaluate(() => {
      const post = self.postMessage;
      self.postMessage = ({ id }) => post.call(self, { id, fault: "unreachable", broken: true });
    });
  await breaks(first);
  await write(page, "state x\ndx ~ poly(y; 2)\n");
  await status(page, /started anew/);
  // Mistakes and columns of the data work as before.
  await page.waitForSelector(".cm-lintRange-error");
  await write(page, 'state x\ndata { x = "');
  await page.keyboard.press("Control+Space");
  await page.waitForSelector(".cm-tooltip-autocomplete >> text=Winkel");
  await page.keyboard.press("Escape");
  await breaks(page.workers().find((worker) => worker !== runner));
  await write(page, 'state x\ndata { x = "Winkel" }\ndx ~ poly(x; 3)\n');
  await status(page, /broke again/);
  assert.match(await page.textContent("#keys"), /until the page is loaded anew/);
  assert.equal(await page.locator(".cm-lintRange-error, .sid-hint").count(), 0);
  assert.match(await run(page), /^found/);
});

scene("columns of the data are completed", async (page) => {
  await choose(page, [{ name: "log.csv", text: "time_s,Winkel\n0,1\n1,2\n" }]);
  await write(page, 'state theta\ndata { theta = "');
  await page.keyboard.press("Control+Space");
  await page.waitForSelector(".cm-tooltip-autocomplete >> text=Winkel");
});

scene("a model is drafted from a table", async (page) => {
  await choose(page, [{ name: "decay.csv", text: DECAY }]);
  await page.click("#draft");
  await status(page, /first model/);
  assert.match(await page.innerText(".cm-content"), /state x/);
  assert.match(await run(page), /^found/);
});

scene("what is wrong with a model or a table is said as the program says it", async (page) => {
  await choose(page, [{ name: "bad.csv", text: "t,x\n0,1\n1,2,3\n2,zwei\n" }]);
  await write(page, "state x\ndx ~ poly(x; 2)\n");
  assert.match(await run(page), /^no answer/);
  assert.match(await page.textContent("#answer"), /^error\[ragged-row\][^]*bad\.csv:3/);
  await write(page, "state x\ndx ~ poly(y; 2)\n");
  await run(page);
  assert.match(await page.textContent("#answer"), /error\[unknown-signal\]/);
});

scene("a run without data says so, and what to do", async (page) => {
  await page.click("#tables button");
  await write(page, "state x\ndx ~ poly(x; 3)\n");
  assert.match(await run(page), /^no answer/);
  assert.match(await page.textContent("#answer"), /^error\[no-data\][^]*help: choose a table/);
  assert.equal(await page.textContent("#verdict"), "No answer");
  await choose(page, [{ name: "decay.csv", text: DECAY }]);
  assert.match(await run(page), /^found, in/);
});

scene("names from files are text, wherever they are shown", async (page) => {
  const name = `<img src=x onerror=alert(1)>.csv`;
  await choose(page, [{ name, text: DECAY.replace("t,x", "t,<script>alert(1)</script>") }]);
  await write(page, 'state x\ndata { x = "<script>alert(1)</script>" }\ndx ~ poly(x; 2)\n');
  assert.match(await run(page), /^found/);
  await page.click("#tab-report");
  await status(page, /written/);
  // The editor itself adds an image next to widgets in a text.
  assert.equal(await page.locator("img:not(.cm-widgetBuffer), b").count(), 0);
  assert.equal(await page.locator("#tables li").count(), 1);
});

for (const [what, text] of Object.entries({
  "no table": "\u0000\u0001\u0002",
  "an empty file": "",
  "one line of a megabyte": "x".repeat(1e6),
  "ten thousand columns": Array.from({ length: 10001 }, (_, k) => `c${k}`).join(","),
  "quotes that never end": 't,x\n0,"1\n1,2\n',
})) {
  scene(`${what} is refused with a reason`, async (page) => {
    await choose(page, [{ name: "odd.csv", text }]);
    await write(page, "state x\ndx ~ poly(x; 2)\n");
    assert.match(await run(page), /^no answer/);
    assert.match(await page.textContent("#answer"), /^error\[/);
  });
}

scene("a table of 50 MB is dropped and read", async (page) => {
  await write(page, "state x\ndx ~ poly(x; 2)\n");
  await page.evaluate(() => {
    const rows = ["t,x"];
    for (let k = 0; k < 1_250_000; k += 1) {
      const t = k / 1e4;
      rows.push(`${t.toFixed(12)},${(2 * Math.exp(-0.05 * t)).toFixed(20)}`);
    }
    const transfer = new DataTransfer();
    transfer.items.add(new File([rows.join("\n")], "long.csv"));
    dispatchEvent(new DragEvent("drop", { dataTransfer: transfer, cancelable: true }));
  });
  await page.waitForFunction(() => /long\.csv, (4[5-9]|5\d)\.\d MB/.test(document.getElementById("tables").textContent));
  assert.match(await run(page), /^found/);
  assert.match(await page.textContent("#answer"), /^dx = -0\.05\*x/);
});

scene("a run is cancelled, and the next one works", async (page) => {
  await example(page, "double_pendulum.sid", 1);
  await page.click("#run");
  await status(page, /…$/);
  await page.click("#cancel");
  await status(page, /^cancelled$/);
  await example(page, "lorenz.sid", 1);
  assert.match(await run(page), /^found, in/);
});

scene("a run whose model is left for another is cancelled", async (page) => {
  assert.match(await run(page), /^found/);
  await example(page, "double_pendulum.sid", 1);
  await page.click("#run");
  await status(page, /…$/);
  await example(page, "lorenz.sid", 1);
  await status(page, /^cancelled: another model was opened$/);
  // The pendulum's results are still shown, with its name.
  assert.match(await page.textContent("#answer"), /^ddy/);
  assert.match(await page.innerText("#outdated"), /^Outdated: pendulum\.sid was run before/);
  await page.click("#tab-code");
  await page.waitForFunction(() => document.getElementById("code").textContent.includes("run the model again"));
  assert.match(await run(page), /^found, in/);
  assert.equal(await page.locator("#outdated").isVisible(), false);
  assert.equal(await saved(page, "#save-code"), "lorenz.py");
});

scene("what is found after a change is marked, under the name of what was run", async (page) => {
  await example(page, "double_pendulum.sid", 1);
  await page.click("#run");
  await status(page, /…$/);
  await page.click(".cm-content");
  await page.keyboard.type("# Mine\n");
  await status(page, /^found/);
  assert.match(await page.textContent("#status"), /; outdated, there was a change meanwhile$/);
  assert.match(await page.innerText("#outdated"), /^Outdated: double_pendulum\.sid was run before/);
  await page.click("#tab-code");
  assert.equal(await saved(page, "#save-code"), "double_pendulum.py");
  await page.click("#tab-report");
  assert.equal(await saved(page, "#save-report"), "double_pendulum.html");
  await page.click("#tab-document");
  assert.equal(await saved(page, "#save-document"), "double_pendulum.json");
});

scene("a link brings model and settings to another page", async (page) => {
  await write(page, "# mine\nstate x\ndx ~ poly(x; 2)\n");
  await page.selectOption("#holdout", "0.25");
  await page.click("#share");
  await status(page, /^the link is/);
  const other = await site.open({}, new URL(page.url()).hash);
  assert.match(await other.innerText(".cm-content"), /^# mine/);
  assert.equal(await other.inputValue("#holdout"), "0.25");
  await other.context().close();
});

scene("a link put into the address of the open page is followed", async (page) => {
  const put = (hash) => page.evaluate((hash) => void (location.hash = hash), hash);
  const shows = (line) => page.waitForFunction((line) => document.querySelector(".cm-line").textContent === line, line);
  const own = "# theirs\nstate x\ndx ~ poly(x; 2)\n";
  await write(page, "# unsaved\nstate x\n");
  await put(link({ text: own, holdout: 0.25, example: "" }));
  await shows("# theirs");
  assert.equal(await page.textContent("#model-name"), "model.sid");
  assert.equal(await page.inputValue("#holdout"), "0.25");
  // The pendulum's data do not belong to the link.
  assert.equal(await page.locator("#tables li").count(), 0);
  await page.focus(".cm-content");
  await page.keyboard.press("Control+Z");
  await shows("# unsaved");
  // The user's own tables are kept.
  await choose(page, [{ name: "decay.csv", text: DECAY }]);
  await put(link({ text: own, holdout: 0, example: "" }));
  await shows("# theirs");
  assert.equal(await page.locator("#tables li").count(), 1);
  await put(link({ text: "# changed lorenz\nstate x\n", holdout: 0, example: "lorenz.sid" }));
  await shows("# changed lorenz");
  assert.match(await page.innerText("#tables"), /^lorenz\.csv/);
  await put("#m=abc");
  await status(page, /cannot be read/);
  await shows("# changed lorenz");
});

test("a link may hold out any part", async () => {
  for (const [holdout, words] of [[0.33, "the last 33 %"], [0.07, "the last 7 %"], [2, "nothing"], ["x", "nothing"]]) {
    const page = await site.open({}, link({ text: "state x\n", holdout, example: "" }));
    assert.equal(await page.locator("#holdout option:checked").innerText(), words);
    await page.context().close();
  }
});

scene("an example that was changed is the user's own, until the change is undone", async (page) => {
  const names = async () => [await page.textContent("#model-name"), await page.inputValue("#examples")];
  assert.deepEqual(await names(), ["pendulum.sid", "pendulum.sid"]);
  await write(page, "state x\ndx ~ poly(x; 3)\n");
  assert.deepEqual(await names(), ["model.sid", ""]);
  await page.keyboard.press("Control+Z");
  assert.deepEqual(await names(), ["pendulum.sid", "pendulum.sid"]);
  await choose(page, [{ name: "decay.csv", text: DECAY }]);
  assert.deepEqual(await names(), ["pendulum.sid", ""]);
  await example(page, "lorenz.sid", 1);
  assert.deepEqual(await names(), ["lorenz.sid", "lorenz.sid"]);
});

test("an example that does not come leaves all as it was", async () => {
  const page = await site.open();
  await page.route("**/lorenz.csv", (route) => route.abort());
  await page.selectOption("#examples", "lorenz.sid");
  await status(page, /^this could not be loaded/);
  assert.deepEqual([await page.textContent("#model-name"), await page.inputValue("#examples")], ["pendulum.sid", "pendulum.sid"]);
  await page.context().close();
});

test("a broken link opens the page as it is without one", async () => {
  for (const hash of ["#m=abc", "#m=", `#m=${"A".repeat(9000)}`, "#x"]) {
    const page = await site.open({}, hash);
    assert.equal(await page.textContent("#model-name"), "pendulum.sid");
    await page.context().close();
  }
});

scene("everything is reached by the keyboard", async (page) => {
  await page.focus(".cm-content");
  await page.keyboard.press("Control+Enter");
  await status(page, /^found/);
  await page.keyboard.press("Tab");
  assert.notEqual(await page.evaluate(() => document.activeElement.className), "cm-content");
  await page.focus("#tab-answer");
  await page.keyboard.press("ArrowRight");
  assert.equal(await page.evaluate(() => document.activeElement.id), "tab-report");
  await status(page, /written/);
});

scene("a screen reader finds a name for everything that can be used", async (page) => {
  const nameless = await page.evaluate(() => {
    const named = (e) => e.ariaLabel || e.title || e.textContent.trim() || e.labels?.length;
    return [...document.querySelectorAll("button, select, input, iframe, [role=tab], [role=textbox]")]
      .filter((e) => !named(e))
      .map((e) => e.outerHTML);
  });
  assert.deepEqual(nameless, []);
  assert.equal(await page.locator("[role=status]").count(), 1);
});

scene("a screen reader tells mistakes, runs and results, and the focus stays", async (page) => {
  await page.evaluate(() => {
    window.told = [];
    const region = document.getElementById("spoken");
    new MutationObserver(() => region.textContent && told.push(region.textContent)).observe(region, { childList: true });
  });
  const hears = (words) => page.waitForFunction(([source]) => told.some((said) => new RegExp(source).test(said)), [words.source]);
  await write(page, "state x\n\n# A mistake:\ndx ~ poly(y; 2)\n");
  await hears(/^1 mistake; line 4: no signal named `y`$/);
  await page.keyboard.press("F8");
  await hears(/^error, line 4: no signal named `y`\n/);
  await page.keyboard.type("x");
  await hears(/^no mistakes$/);
  await example(page, "double_pendulum.sid", 1);
  await page.focus("#run");
  await page.keyboard.press("Enter");
  await hears(/^running …$/);
  assert.equal(await page.evaluate(() => document.activeElement.id), "run");
  await page.keyboard.press("Tab");
  await page.keyboard.press("Enter");
  await hears(/^cancelled$/);
  assert.equal(await page.evaluate(() => document.activeElement.id), "cancel");
  await example(page, "lorenz.sid", 1);
  await run(page);
  await hears(/^found, in .*Results$/);
  assert.deepEqual(await page.locator("h2").allInnerTexts(), ["lorenz.sid", "Data", "Results"]);
});

for (const width of [390, 1280]) {
  for (const colorScheme of ["light", "dark"]) {
    scene(`nothing overflows at ${width} px, ${colorScheme}`, async (page) => {
      await run(page);
      assert.equal(await page.evaluate(() => document.documentElement.scrollWidth - innerWidth), 0);
      const low = await page.evaluate(() => {
        // Contrast (WCAG 2) of every text with the first opaque background behind it.
        const channels = (colour) => colour.match(/[\d.]+/g).map(Number);
        const light = ([r, g, b]) => {
          const linear = [r, g, b].map((c) => (c / 255 <= 0.04045 ? c / 255 / 12.92 : ((c / 255 + 0.055) / 1.055) ** 2.4));
          return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2];
        };
        const ground = (e) => {
          for (let at = e; at; at = at.parentElement) {
            const colour = channels(getComputedStyle(at).backgroundColor);
            if (colour.length === 3) return colour;
          }
          return [255, 255, 255];
        };
        const texts = [...document.querySelectorAll("p, h1, h2, label, button, li, pre, option, .cm-line span, .cm-gutterElement")];
        const shown = texts.filter((e) => e.textContent.trim() && e.checkVisibility() && !e.disabled && !e.closest("[hidden]"));
        return shown
          .map((e) => {
            const [a, b] = [light(channels(getComputedStyle(e).color)), light(ground(e))];
            return [(Math.max(a, b) + 0.05) / (Math.min(a, b) + 0.05), e.outerHTML.slice(0, 80)];
          })
          .filter(([contrast]) => contrast < 4.5);
      });
      assert.deepEqual(low, []);
      // For inspection: `SIDC_PICTURES=1 npm test` redraws the pictures in docs/.
      const picture = { "1280 light": "playground-desk-light", "390 dark": "playground-phone-dark" }[`${width} ${colorScheme}`];
      if (picture && process.env.SIDC_PICTURES) await page.screenshot({ path: join(root, `docs/${picture}.png`) });
    }, { viewport: { width, height: width === 390 ? 844 : 900 }, colorScheme });
  }
}

test("a wrong address is refused, and the server lives on", async () => {
  for (const path of ["/%ZZ", "/%00", "/%", "//", "/%E0%A4%A"]) assert.equal(await answer(site, path), 400, path);
  const outside = ["/../package.json", "/..%2fpackage.json", "/%2e%2e/package.json", "/..%5cpackage.json", "//../package.json"];
  for (const path of ["/none", "/gallery", `/${"a".repeat(9000)}`, ...outside]) assert.equal(await answer(site, path), 404, path.slice(0, 40));
  assert.equal(await answer(site, "/"), 200);
});

test("the page is 5 MB at most", () => {
  const files = ["index.html", "main.js", "worker.js", "style.css", "frame.html", "sidc.wasm.gz"];
  const sizes = files.map((name) => readFileSync(join(root, "web/dist", name)).length);
  const all = sizes.reduce((a, b) => a + b);
  assert.ok(all <= 5e6, `${all} bytes`);
});
