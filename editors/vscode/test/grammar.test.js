// Compares the TextMate grammar with the compiler's tokens: every word in the gallery has the colour that `sidc lsp` gives it. SIDC is the path of the
// program; by default target/debug/sidc and PATH are tried.
const test = require("node:test");
const assert = require("node:assert/strict");
const fs = require("node:fs");
const path = require("node:path");
const { spawn } = require("node:child_process");
const oniguruma = require("vscode-oniguruma");
const textmate = require("vscode-textmate");

const root = path.join(__dirname, "../../..");
const built = path.join(root, "target/debug/sidc");
const program = process.env.SIDC ?? (fs.existsSync(built) ? built : "sidc");

/** Token types of the protocol by TextMate scope. */
const KINDS = [
  ["comment", "comment"],
  ["string", "string"],
  ["constant.numeric", "number"],
  ["keyword.operator", "operator"],
  ["keyword.control", "keyword"],
  ["keyword.other", "function"],
  ["support.function", "function"],
  ["entity.name.function.macro", "macro"],
  ["entity.name.function", "function"],
  ["support.type.property-name", "property"],
  ["variable", "name"],
];
/** Token types that a grammar without declarations cannot distinguish. */
const NAMES = { variable: "name", parameter: "name", namespace: "name" };

async function grammar() {
  const wasm = fs.readFileSync(require.resolve("vscode-oniguruma/release/onig.wasm"));
  await oniguruma.loadWASM(wasm.buffer.slice(wasm.byteOffset, wasm.byteOffset + wasm.byteLength));
  const registry = new textmate.Registry({
    onigLib: Promise.resolve({
      createOnigScanner: (patterns) => new oniguruma.OnigScanner(patterns),
      createOnigString: (text) => new oniguruma.OnigString(text),
    }),
    loadGrammar: async () => {
      const file = path.join(__dirname, "../sid.tmLanguage.json");
      return textmate.parseRawGrammar(fs.readFileSync(file, "utf8"), file);
    },
  });
  return registry.loadGrammar("source.sid");
}

/** `line:character` → token type, for every token of a text that has one. */
function coloured(grammar, text) {
  const kinds = new Map();
  let stack = textmate.INITIAL;
  text.split("\n").forEach((line, number) => {
    const { tokens, ruleStack } = grammar.tokenizeLine(line, stack);
    stack = ruleStack;
    for (const token of tokens) {
      const scope = token.scopes.at(-1);
      const kind = KINDS.find(([prefix]) => scope.startsWith(prefix));
      if (kind) kinds.set(`${number}:${token.startIndex}`, kind[1]);
    }
  });
  return kinds;
}

/** A server that answers one request at a time. */
function server() {
  const child = spawn(program, ["lsp"], { stdio: ["pipe", "pipe", "inherit"] });
  let buffer = Buffer.alloc(0);
  let asked = 0;
  const waiting = new Map();
  child.stdout.on("data", (piece) => {
    buffer = Buffer.concat([buffer, piece]);
    for (;;) {
      const end = buffer.indexOf("\r\n\r\n");
      if (end < 0) return;
      const length = Number(/Content-Length: (\d+)/i.exec(buffer.subarray(0, end))[1]);
      if (buffer.length < end + 4 + length) return;
      const message = JSON.parse(buffer.subarray(end + 4, end + 4 + length));
      buffer = buffer.subarray(end + 4 + length);
      waiting.get(message.id)?.(message.result);
    }
  });
  const send = (message) => {
    const body = Buffer.from(JSON.stringify({ jsonrpc: "2.0", ...message }));
    child.stdin.write(`Content-Length: ${body.length}\r\n\r\n`);
    child.stdin.write(body);
  };
  return {
    tell: (method, params) => send({ method, params }),
    ask: (method, params) =>
      new Promise((resolve) => {
        waiting.set(++asked, resolve);
        send({ id: asked, method, params });
      }),
  };
}

test("words have the colours that the compiler gives them", async () => {
  const own = await grammar();
  const lsp = server();
  const { capabilities } = await lsp.ask("initialize", { capabilities: {} });
  const types = capabilities.semanticTokensProvider.legend.tokenTypes;
  lsp.tell("initialized", {});
  const folder = path.join(root, "models");
  let words = 0;
  const wrong = [];
  for (const name of fs.readdirSync(folder).filter((f) => f.endsWith(".sid"))) {
    const text = fs.readFileSync(path.join(folder, name), "utf8");
    const uri = `file:///${name}`;
    lsp.tell("textDocument/didOpen", { textDocument: { uri, languageId: "sid", version: 1, text } });
    const { data } = await lsp.ask("textDocument/semanticTokens/full", { textDocument: { uri } });
    const kinds = coloured(own, text);
    const lines = text.split("\n");
    let [line, start] = [0, 0];
    for (let i = 0; i < data.length; i += 5) {
      start = data[i] ? data[i + 1] : start + data[i + 1];
      line += data[i];
      const wanted = NAMES[types[data[i + 3]]] ?? types[data[i + 3]];
      // The grammar does not highlight brackets and commas.
      if (wanted === "operator" && /[(){},;]/.test(lines[line][start])) continue;
      words += 1;
      const found = kinds.get(`${line}:${start}`);
      if (found !== wanted) wrong.push(`${name}:${line + 1}:${start} ${lines[line].slice(start, start + data[i + 2])}: ${found}, not ${wanted}`);
    }
  }
  await lsp.ask("shutdown");
  lsp.tell("exit");
  assert.ok(words > 1500, `only ${words} words`);
  assert.deepEqual(wrong, []);
});
