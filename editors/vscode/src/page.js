// A report for a webview: its colours follow the editor's theme, dark or light, not that of the desktop.

/** The report's own rule for dark colours. */
const BY_DESKTOP = /@media \(prefers-color-scheme: dark\) \{(\s*):root \{/;
const DARK = ":root:has(> body.vscode-dark, > body.vscode-high-contrast:not(.vscode-high-contrast-light))";

/** Overrides the editor's style for pages, so that the report has its own text and background colours. */
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
