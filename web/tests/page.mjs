// A page of the playground in Chromium, with a record of all its network requests.
import { once } from "node:events";
import { existsSync } from "node:fs";
import { get } from "node:http";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";
import { deflateRawSync } from "node:zlib";
import { chromium } from "playwright-core";
import { serve } from "../serve.mjs";

export const root = join(dirname(fileURLToPath(import.meta.url)), "../..");

const BROWSERS = ["/usr/bin/chromium", "/usr/bin/chromium-browser", "/usr/bin/google-chrome"];

/** Longest waits in milliseconds, for a reaction of the page and for a run: only a safeguard against hanging tests. */
const REACTION = 60000;
const RUN = 600000;

/** A browser with the playground's server. */
export async function start() {
  const executablePath = process.env.CHROMIUM ?? BROWSERS.find(existsSync);
  const server = await serve(join(root, "web/dist"), 0);
  const browser = await chromium.launch({ executablePath, args: ["--no-sandbox"] });
  const origin = `http://127.0.0.1:${server.address().port}`;
  return {
    origin,
    /** Opens the page and waits until it is ready. */
    async open(options = {}, hash = "") {
      const context = await browser.newContext({ viewport: { width: 1280, height: 900 }, ...options });
      const page = await context.newPage();
      page.setDefaultTimeout(REACTION);
      page.requests = [];
      page.faults = [];
      context.on("request", (request) => page.requests.push(request.url()));
      page.on("pageerror", (error) => page.faults.push(String(error)));
      page.on("console", (message) => message.type() === "error" && page.faults.push(message.text()));
      await page.goto(`${origin}/${hash}`);
      await status(page, /^ready$/);
      return page;
    },
    async stop() {
      await browser.close();
      server.close();
    },
  };
}

export async function status(page, words) {
  await page.waitForFunction(
    ([source]) => new RegExp(source).test(document.getElementById("status").textContent),
    [words.source],
    { timeout: RUN },
  );
}

/** Runs the model on the page. Returns how the run ended. */
export async function run(page) {
  await page.click("#run");
  await status(page, /^(found|no answer|cancelled|a fault)/);
  return page.textContent("#status");
}

/** Chooses an example and waits for its text and data. */
export async function example(page, model, tables) {
  await page.selectOption("#examples", model);
  await page.waitForFunction(
    ([name, count]) =>
      document.getElementById("model-name").textContent === name && document.querySelectorAll("#tables li").length === count,
    [model, tables],
  );
}

/** Replaces the model's text, as if it were pasted. */
export async function write(page, text) {
  await page.click(".cm-content");
  await page.keyboard.press("Control+A");
  await page.keyboard.insertText(text);
}

/** Chooses files by name and content. */
export async function choose(page, files) {
  const given = files.map(({ name, text }) => ({ name, mimeType: "text/csv", buffer: Buffer.from(text) }));
  await page.setInputFiles("#files", given);
}

/** The fragment of a link. */
export function link(state) {
  return `#m=${deflateRawSync(JSON.stringify(state)).toString("base64url")}`;
}

/** The server's status for a raw path, which a browser would normalise first. */
export async function answer(site, path) {
  const [response] = await once(get(site.origin, { path, agent: false, signal: AbortSignal.timeout(REACTION) }), "response");
  return response.resume().statusCode;
}

/** The name of the file that a button saves, once it is enabled. */
export async function saved(page, button) {
  await page.waitForSelector(`${button}:enabled`);
  const [download] = await Promise.all([page.waitForEvent("download"), page.click(button)]);
  return download.suggestedFilename();
}
