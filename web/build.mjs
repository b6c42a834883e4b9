// Builds the playground into web/dist, static files for any server.
//
// The compiler as WebAssembly (crates/web), the page and its worker in one file each, the gallery unchanged from models/.
import { execFileSync } from "node:child_process";
import { cpSync, mkdirSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";
import { gzipSync } from "node:zlib";
import { build } from "esbuild";
import { gallery } from "./gallery.mjs";

const web = dirname(fileURLToPath(import.meta.url));
const root = dirname(web);
const dist = join(web, "dist");
const target = process.env.CARGO_TARGET_DIR ?? join(root, "target");

const run = (program, ...args) => execFileSync(program, args, { cwd: root, stdio: "inherit" });

run("rustup", "--quiet", "target", "add", "wasm32-unknown-unknown");
run("cargo", "build", "--quiet", "--profile", "embedded", "--package", "sidc-web", "--target", "wasm32-unknown-unknown");
rmSync(dist, { recursive: true, force: true });
mkdirSync(dist, { recursive: true });
const bindings = join(target, "web");
const compiled = join(target, "wasm32-unknown-unknown/embedded/sidc_web.wasm");
run("cargo", "run", "--quiet", "--package", "sidc-web-bindings", "--", compiled, bindings);
// Compressed here, so that no server needs to be configured for it.
writeFileSync(join(dist, "sidc.wasm.gz"), gzipSync(readFileSync(join(bindings, "sidc_bg.wasm")), { level: 9 }));

await build({
  entryPoints: [join(web, "src/main.js"), join(web, "src/worker.js")],
  outdir: dist,
  bundle: true,
  minify: true,
  format: "esm",
  target: "es2022",
  alias: { "sidc-bindings": join(bindings, "sidc.js") },
});
for (const name of ["index.html", "frame.html", "style.css"]) cpSync(join(web, "src", name), join(dist, name));

const examples = gallery(join(root, "models"));
mkdirSync(join(dist, "gallery"));
for (const { model, data } of examples) {
  cpSync(join(root, "models", model), join(dist, "gallery", model));
  for (const name of data) cpSync(join(root, "models/data", name), join(dist, "gallery", name));
}
writeFileSync(join(dist, "gallery/index.json"), JSON.stringify(examples));
