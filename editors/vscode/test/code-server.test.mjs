// Tests the packaged extension in Visual Studio Code as a user would. CODE_SERVER is the path of `code-server`; README.md says where to get it.
import assert from "node:assert/strict";
import { readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { after, before, describe, test } from "node:test";
import { root, start } from "./workbench.mjs";

const FAULTY = `state y : order 2, unit "m"
state theta : order 2, unti "rad"
input F : hold, unit "N"

let everything = powers(y, dy, dthta, sin theta; 2)

ddy ~ everything
ddtheta ~ poly(theta, dtheta; 2) + 3 sin(theta)
`;

describe("in Visual Studio Code", { skip: process.env.CODE_SERVER ? false : "CODE_SERVER names no code-server" }, () => {
  let code;
  before(async () => {
    code = await start(["pendulum", "double_pendulum"]);
    writeFileSync(join(code.work, "faulty.sid"), FAULTY);
  });
  after(() => code?.stop());

  test("a model has its colours, numbers of terms, outline and explanations", async () => {
    const { page } = code;
    await code.open("pendulum.sid");
    await code.sees(".editor-instance .view-line", /everything.*6,561.terms/);
    await page.locator(".pane-header", { hasText: "Outline" }).click();
    await code.sees(".outline-tree", "state of order 2, rad");
    const colour = (word) => page.locator(".view-line span span", { hasText: word }).first().evaluate((e) => getComputedStyle(e).color);
    const colours = () => Promise.all([/^powers$/, /^state$/, /^everything$/, /^"rad"$/].map(colour));
    await code.until(async () => new Set(await colours()).size === 4, "four colours");
    await code.go(23, 17);
    await page.keyboard.press("Control+K");
    await page.keyboard.press("Control+I");
    await code.sees(".monaco-hover", /6,561 candidate terms/);
    await page.keyboard.press("Escape");
  });

  test("mistakes are shown, and their fixes mend them", async () => {
    const { page } = code;
    await code.open("faulty.sid");
    await code.until(async () => (await page.locator(".squiggly-error").count()) === 3, "three errors");
    for (const [line, column, fix] of [[2, 26, "replace `unti`"], [5, 33, "replace `dthta`"], [8, 39, "insert `*`"]]) {
      await code.go(line, column);
      // VS Code offers no fixes while the diagnostics of the last change are pending.
      await code.until(async () => {
        await page.keyboard.press("Control+.");
        await page.locator(".action-widget .monaco-list-row", { hasText: fix }).waitFor({ timeout: 2000 });
        return true;
      }, fix);
      await page.keyboard.press("Enter");
      await code.until(() => page.locator(".action-widget").first().isHidden(), "the fix");
    }
    await code.until(async () => (await page.locator(".squiggly-error").count()) === 0, "a text without errors");
    assert.match(await code.text(), /theta : order 2, unit "rad"[^]*dtheta, sin theta[^]*3\*sin\(theta\)/);
  });

  test("names and columns are completed, a name is changed, a text is laid out", async () => {
    const { page } = code;
    await code.go(9, 1);
    await page.keyboard.type("data { ");
    await page.keyboard.press("Control+Space");
    await code.sees(".suggest-widget .monaco-list-row", /^theta/);
    await page.keyboard.press("Escape");
    for (let k = 0; k < 3; k += 1) await page.keyboard.press("Control+Z");
    await code.go(2, 8);
    await page.keyboard.press("F2");
    await page.locator(".rename-box input").fill("phi");
    await page.keyboard.press("Enter");
    await code.until(async () => /ddphi ~ poly\(phi, dphi; 2\)/.test(await code.text()), "the new name");
    await code.go(7, 5);
    await page.keyboard.type("   ");
    await code.command("Format Document");
    await code.until(async () => /^ddy\s+~ everything$/m.test(await code.text()), "the layout");
    await page.keyboard.press("Control+S");
    await code.until(async () => /ddphi/.test(readFileSync(join(code.work, "faulty.sid"), "utf8")), "the file");
  });

  test("a model is checked and identified", async () => {
    await code.open("pendulum.sid");
    await code.command("sidc: Check Against Data");
    await code.accept();
    await code.output(/measured: y, dy/);
    await code.command("sidc: Identify");
    await code.accept();
    const found = await code.output(/law: passes/);
    assert.match(found, /-2\*ddy\*cos\(theta\)|- 2\*ddy\*cos\(theta\)/);
  });

  test("the report is readable in light and in dark", async () => {
    await code.open("pendulum.sid");
    await code.go(23, 1);
    await code.command("sidc: Open Report");
    await code.accept();
    const report = await code.report();
    const contrast = () =>
      report.evaluate(() => {
        const light = (colour) => {
          const linear = colour.match(/[\d.]+/g).slice(0, 3).map((c) => (c / 255 <= 0.04045 ? c / 255 / 12.92 : ((c / 255 + 0.055) / 1.055) ** 2.4));
          return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2];
        };
        const style = getComputedStyle(document.body);
        const [ink, paper] = [light(style.color), light(style.backgroundColor)];
        return { dark: paper < ink, ratio: (Math.max(ink, paper) + 0.05) / (Math.min(ink, paper) + 0.05) };
      });
    const first = await contrast();
    if (process.env.SIDC_PICTURES) await picture();
    await code.command("Preferences: Toggle between Light/Dark Themes");
    await code.until(async () => (await contrast()).dark !== first.dark, "the other colours");
    const second = await contrast();
    await code.command("View: Close Editor");
    assert.ok(first.ratio > 7 && second.ratio > 7, JSON.stringify([first, second]));
  });

  /** For inspection: `SIDC_PICTURES=1` redraws the picture in docs/. */
  async function picture() {
    await code.page.mouse.move(1000, 5);
    await code.page.waitForTimeout(1000);
    await code.page.screenshot({ path: join(root, "docs/editor-vscode.png") });
  }

  test("a run tells its stages and is cancelled", async () => {
    const { page } = code;
    await code.open("double_pendulum.sid");
    await code.command("sidc: Identify");
    await code.accept();
    await code.sees(".notification-toast", /Identifying: \S/);
    await page.getByRole("button", { name: "Cancel" }).click();
    await code.output(/cancelled/);
  });

  test("a program that is missing is said once, and found when the setting names it", async () => {
    const { page } = code;
    code.use("/nowhere/sidc");
    const toast = page.locator(".notification-toast");
    await toast.filter({ hasText: "/nowhere/sidc was not found" }).waitFor();
    assert.equal(await toast.count(), 1);
    await code.command("Notifications: Clear All Notifications");
    await code.command("sidc: Identify");
    await code.accept();
    await toast.filter({ hasText: "/nowhere/sidc was not found" }).waitFor();
    code.use();
    await code.open("faulty.sid");
    await code.go(1, 1);
    await page.keyboard.type("stat ");
    await page.locator(".squiggly-error").first().waitFor();
  });

  test("a model without a file has to be saved first", async () => {
    await code.command("File: New Untitled Text File");
    await code.command("Change Language Mode");
    await code.page.keyboard.type("sid");
    await code.row(/^sid\b/).click();
    await code.command("sidc: Identify");
    await code.sees(".notification-toast", "Save the model first");
  });
});
