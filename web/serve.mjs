// Serves web/dist on this machine: `npm run serve`, or `npm run serve -- 8080`.
import { createServer } from "node:http";
import { readFile } from "node:fs/promises";
import { dirname, extname, join, normalize } from "node:path";
import { fileURLToPath } from "node:url";

const KINDS = {
  ".html": "text/html; charset=utf-8",
  ".css": "text/css; charset=utf-8",
  ".js": "text/javascript; charset=utf-8",
  ".json": "application/json",
  ".gz": "application/gzip",
};

/** The path of the requested file; undefined if the URL is invalid. */
function asked(url) {
  try {
    const { pathname } = new URL(url, "http://localhost");
    const path = normalize(decodeURIComponent(pathname.endsWith("/") ? `${pathname}index.html` : pathname));
    return path.includes("\0") ? undefined : path;
  } catch {
    return undefined;
  }
}

/** A server for the folder; `port` 0 takes any free port. */
export function serve(folder, port) {
  const server = createServer(async (request, response) => {
    const path = asked(request.url);
    if (path === undefined) return response.writeHead(400).end("bad address");
    try {
      const body = await readFile(join(folder, path));
      response.writeHead(200, { "content-type": KINDS[extname(path)] ?? "text/plain; charset=utf-8" }).end(body);
    } catch {
      response.writeHead(404).end("not found");
    }
  });
  return new Promise((ready) => server.listen(port, "127.0.0.1", () => ready(server)));
}

if (process.argv[1] === fileURLToPath(import.meta.url)) {
  const dist = join(dirname(fileURLToPath(import.meta.url)), "dist");
  const server = await serve(dist, Number(process.argv[2] ?? 8000));
  console.log(`http://localhost:${server.address().port}/`);
}
