// Visual Studio Code, served by code-server in Chromium, with the packaged extension.
import { execFileSync, spawn } from "node:child_process";
import { cpSync, existsSync, mkdirSync, mkdtempSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";

const here = dirname(fileURLToPath(import.meta.url));
export const root = join(here, "../../..");
const built = join(root, "target/debug/sidc");
const program = process.env.SIDC ?? (existsSync(built) ? built : "sidc");

const BROWSERS = ["/usr/bin/chromium", "/usr/bin/chromium-browser", "/usr/bin/google-chrome"];
/** Longest wait in milliseconds: only a safeguard against hanging tests. */
const PATIENCE = 20000;

/** Starts the server and opens a folder with these gallery models and their tables. */
export async function start(models) {
  const { chromium } = await import("playwright-core");
  const folder = mkdtempSync(join(tmpdir(), "sidc-vscode-"));
  const work = join(folder, "work");
  mkdirSync(join(work, "data"), { recursive: true });
  for (const name of models) {
    cpSync(join(root, `models/${name}.sid`), join(work, `${name}.sid`));
    cpSync(join(root, `models/data/${name}.csv`), join(work, `data/${name}.csv`));
  }
  const setting = join(folder, "user/Machine/settings.json");
  mkdirSync(dirname(setting), { recursive: true });
  const use = (path) => writeFileSync(setting, JSON.stringify({ "sidc.path": path }));
  use(program);
  const own = ["--user-data-dir", join(folder, "user"), "--extensions-dir", join(folder, "extensions"), "--config", join(folder, "config.yaml")];
  execFileSync(process.env.CODE_SERVER, [...own, "--install-extension", join(here, "../sidc.vsix")]);
  const open = ["--auth", "none", "--bind-addr", "127.0.0.1:0", "--disable-workspace-trust", "--disable-telemetry", "--disable-update-check"];
  const server = spawn(process.env.CODE_SERVER, [...own, ...open, work]);
  const url = await new Promise((resolve, reject) => {
    server.stdout.on("data", (piece) => {
      const found = /listening on (http:\S+)/.exec(piece);
      if (found) resolve(found[1]);
    });
    server.on("exit", (code) => reject(new Error(`code-server ended with ${code}`)));
  });
  const browser = await chromium.launch({ executablePath: process.env.CHROMIUM ?? BROWSERS.find(existsSync), args: ["--no-sandbox"] });
  const page = await browser.newPage({ viewport: { width: 1180, height: 720 } });
  page.setDefaultTimeout(PATIENCE);
  await page.goto(url);
  await page.waitForSelector(".monaco-workbench .explorer-folders-view");
  return Object.assign(workbench(page), {
    work,
    use: (path = program) => use(path),
    async stop() {
      await browser.close();
      server.kill();
      rmSync(folder, { recursive: true, force: true });
    },
  });
}

/** Actions in a window, by keyboard if possible. */
function workbench(page) {
  const typed = async (words) => {
    await page.locator(".quick-input-widget input").first().waitFor();
    await page.keyboard.type(words);
  };
  const row = (words) => page.locator(".quick-input-list .monaco-list-row", { hasText: words }).first();
  const self = {
    page,
    row,
    /** Waits until the text of an element matches. */
    async sees(selector, words) {
      const found = page.locator(selector, { hasText: words }).first();
      await self.until(() => found.isVisible(), `${words} in ${selector}`);
    },
    async open(name) {
      // A new window first ignores keys, and then does not yet know the files.
      await self.until(async () => {
        await page.keyboard.press("Escape");
        await page.keyboard.press("Control+P");
        await page.keyboard.type(name, { delay: 20 });
        await row(new RegExp(`^${name}`)).click({ timeout: 2000 });
        return true;
      }, `${name} in the list of files`);
      await self.sees(".tab.active", name);
      await page.locator(".editor-group-container.active .view-line").first().click();
    },
    async command(title) {
      await page.keyboard.press("F1");
      await typed(title);
      await row(title).click();
    },
    async go(line, column) {
      await page.keyboard.press("Control+G");
      await typed(`${line}:${column}`);
      await page.keyboard.press("Enter");
      await self.sees(".statusbar-item", `Ln ${line}, Col ${column}`);
    },
    /** Text of the visible editor, with non-breaking spaces replaced. */
    async text() {
      const lines = await page.locator(".editor-group-container.active .view-line").evaluateAll((all) =>
        all
          .map((line) => [line.offsetTop, line.textContent])
          .sort(([a], [b]) => a - b)
          .map(([, words]) => words),
      );
      return lines.join("\n").replaceAll("\u00a0", " ");
    },
    /** Accepts the tables that the extension proposes. */
    async accept() {
      await self.sees(".quick-input-title", "Tables for");
      await row(/\.csv/).waitFor();
      await page.keyboard.press("Enter");
    },
    /** Waits until the output of the extension matches, and returns it. */
    async output(words) {
      const shown = () => page.locator(".output-view .view-lines").innerText().then((t) => t.replaceAll("\u00a0", " "));
      await self.until(async () => words.test(await shown()), `the output ${words}`);
      return shown();
    },
    async until(condition, what) {
      const end = Date.now() + PATIENCE;
      while (!(await condition().catch(() => false))) {
        if (Date.now() > end) {
          await page.screenshot({ path: join(tmpdir(), "sidc-vscode.png") });
          throw new Error(`waited in vain for ${what}: ${join(tmpdir(), "sidc-vscode.png")}`);
        }
        await page.waitForTimeout(100);
      }
    },
    /** The frame of the report. */
    async report() {
      let found;
      await self.until(async () => {
        for (const frame of page.frames()) if (/Verdict/.test(await frame.evaluate(() => document.body.innerText))) found = frame;
        return found;
      }, "a report");
      return found;
    },
  };
  return self;
}
