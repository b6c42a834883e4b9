// A report as it is shown in a webview: in the colours of the editor, dark or light, instead of those of the desktop.

/** Where the report turns dark of itself. */
const BY_DESKTOP = /@media \(prefers-color-scheme: dark\) \{(\s*):root \{/;
const DARK = ":root:has(> body.vscode-dark, > body.vscode-high-contrast:not(.vscode-high-contrast-light))";

/** The editor's own style has a say in pages; the report's ink stands on the report's paper. */
const OWN = `
<style>
:root { color-scheme: light; }
${DARK} { color-scheme: dark; }
body { color: var(--ink); background: var(--paper); }
code { color: inherit; background: none; padding: 0; }
</style>
</head>`;

function fitted(html) {
  return html.replace(BY_DESKTOP, (_, space) => `@media all {${space}${DARK} {`).replace("</head>", () => OWN);
}

module.exports = { fitted };
