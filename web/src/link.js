// A link with the model and its settings, packed into the fragment after `#`, which browsers do not send to servers.

async function through(stream, bytes) {
  const piped = new Blob([bytes]).stream().pipeThrough(stream);
  return new Uint8Array(await new Response(piped).arrayBuffer());
}

/** Largest size of a text unpacked from a link, bytes. */
const LONGEST = 1 << 20;

export async function pack(state) {
  const bytes = await through(new CompressionStream("deflate-raw"), new TextEncoder().encode(JSON.stringify(state)));
  let text = "";
  for (const byte of bytes) text += String.fromCharCode(byte);
  return `#m=${btoa(text).replaceAll("+", "-").replaceAll("/", "_").replaceAll("=", "")}`;
}

/** The state in a link; undefined if it has none or cannot be read. */
export async function unpack(hash) {
  const packed = /^#m=([\w-]+)$/.exec(hash)?.[1];
  if (!packed) return undefined;
  try {
    const text = atob(packed.replaceAll("-", "+").replaceAll("_", "/"));
    const bytes = Uint8Array.from(text, (c) => c.charCodeAt(0));
    const reader = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate-raw")).getReader();
    const chunks = [];
    let length = 0;
    for (let next = await reader.read(); !next.done; next = await reader.read()) {
      length += next.value.length;
      if (length > LONGEST) return undefined;
      chunks.push(next.value);
    }
    const { text: model, holdout, example } = JSON.parse(await new Blob(chunks).text());
    if (typeof model !== "string") return undefined;
    return { text: model, holdout: holdout > 0 && holdout < 1 ? Number(holdout) : 0, example: typeof example === "string" ? example : undefined };
  } catch {
    return undefined;
  }
}
