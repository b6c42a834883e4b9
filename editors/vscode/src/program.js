// Runs the program `sidc` with cancellable progress.
const { execFile, spawn } = require("node:child_process");
const vscode = require("vscode");

function settings() {
  return vscode.workspace.getConfiguration("sidc");
}

function program() {
  return settings().get("path") || "sidc";
}

/** Why the program does not start, or `undefined`. */
function absent() {
  return new Promise((resolve) => {
    execFile(program(), ["--version"], (error) => resolve(error ? error.code ?? error.message : undefined));
  });
}

/** Reports that the program does not start, and offers to open the setting with its path. */
async function missing(why) {
  const found = why === "ENOENT" ? "was not found" : `does not start (${why})`;
  const words = `The program ${program()} ${found}. Install sidc, or name the program in the setting sidc.path.`;
  const setting = "Open Setting";
  if ((await vscode.window.showErrorMessage(words, setting)) === setting) {
    vscode.commands.executeCommand("workbench.action.openSettings", "sidc.path");
  }
}

/** A finished stage in the output of `sidc identify --verbose`: seconds, then words. */
const STAGE = /^ *[\d.]+ s {2}(.*)$/;

/** The user's options of `sidc identify`, with `--verbose` added unless the user set the verbosity. */
function options() {
  const own = settings().get("arguments");
  return own.some((o) => ["-q", "--quiet", "-v", "--verbose"].includes(o)) ? own : ["--verbose", ...own];
}

/** Runs the program. Returns `{code, text, cancelled}`; `code` is the exit status, or an error code if it did not start. */
function run(title, args, cwd) {
  const shown = { location: vscode.ProgressLocation.Notification, title, cancellable: true };
  return vscode.window.withProgress(shown, (progress, token) =>
    new Promise((resolve) => {
      const child = spawn(program(), args, { cwd, stdio: ["ignore", "pipe", "pipe"] });
      let [said, answer, line] = ["", "", ""];
      child.stdout.setEncoding("utf8").on("data", (piece) => (answer += piece));
      child.stderr.setEncoding("utf8").on("data", (piece) => {
        const lines = (line + piece).split("\n");
        line = lines.pop();
        for (const whole of lines) {
          const stage = STAGE.exec(whole);
          if (stage) progress.report({ message: stage[1] });
          else said += `${whole}\n`;
        }
      });
      const end = (code) => resolve({ code, text: said + line + answer, cancelled: token.isCancellationRequested });
      child.on("error", (error) => end(error.code ?? error.message));
      child.on("close", end);
      // On an interrupt, the program ends its work and prints what it has.
      token.onCancellationRequested(() => child.kill("SIGINT"));
    }),
  );
}

module.exports = { absent, missing, options, program, run };
