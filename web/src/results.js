// The results in four views, one of them visible.
import { speak } from "./spoken.js";

const element = (id) => document.getElementById(id);

const VIEWS = ["answer", "report", "code", "document"];

/** File extensions of the languages. */
const EXTENSIONS = { latex: "tex", rust: "rs", c: "c", "c-header": "h", "c-float": "c", "c-float-header": "h", python: "py", sympy: "py", matlab: "m", jax: "py", casadi: "py", julia: "jl", modelica: "mo", sbml: "xml", fmi: "fmu", text: "txt" };

function save(name, content, kind) {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(new Blob([content], { type: kind }));
  link.download = name;
  link.click();
  URL.revokeObjectURL(link.href);
}

export class Results {
  #runner;
  #say;
  #found;
  #report;
  /** A text, or the bytes of a binary file. */
  #code = "";
  /** The model that was run. */
  #model = "";

  constructor(runner, say) {
    this.#runner = runner;
    this.#say = say;
    VIEWS.forEach((view, place) => {
      const tab = element(`tab-${view}`);
      tab.addEventListener("click", () => this.#choose(view));
      tab.addEventListener("keydown", ({ key }) => {
        const step = { ArrowRight: 1, ArrowLeft: -1 }[key];
        if (step) this.#choose(VIEWS[(place + step + VIEWS.length) % VIEWS.length]);
      });
    });
    element("target").addEventListener("change", async () => {
      await this.#write();
      if (this.#found) speak(`${element("target").value} below`);
    });
    element("save-report").addEventListener("click", () => save(this.#file("html"), this.#report, "text/html"));
    element("save-code").addEventListener("click", () => {
      const extension = EXTENSIONS[element("target").value] ?? "txt";
      save(this.#file(extension), this.#code, typeof this.#code === "string" ? "text/plain" : "application/octet-stream");
    });
    element("save-document").addEventListener("click", () => save(this.#file("json"), this.#found.document, "application/json"));
  }

  setTargets(targets) {
    element("target").replaceChildren(...targets.map((target) => new Option(target, target)));
    element("target").value = "python";
  }

  #file(extension) {
    return `${this.#model.replace(/\.sid$/, "")}.${extension}`;
  }

  /** Shows what a run of the model found. */
  show(found, model) {
    this.#clear(model);
    this.#found = found;
    this.#verdict(found.passes ? "Passes" : "Doubted: see the reasons", found.passes ? "passes" : "doubted");
    element("answer").textContent = found.answer;
    element("document").textContent = found.document;
    element("save-document").disabled = false;
    this.#choose(VIEWS.find((view) => element(`tab-${view}`).ariaSelected === "true"), false);
  }

  /** Shows why there is nothing for the model. */
  refuse(message, model) {
    this.#clear(model);
    this.#verdict("No answer", "doubted");
    element("answer").textContent = message;
    this.#choose("answer", false);
  }

  /** Marks the shown results as those of another model or other data. */
  outdate() {
    if (this.#model) document.body.classList.add("outdated");
  }

  #clear(model) {
    this.#found = undefined;
    this.#report = undefined;
    this.#model = model;
    element("run-model").textContent = model;
    // It holds the report of an earlier run.
    element("report").hidden = true;
    element("code").textContent = "";
    element("document").textContent = "";
    for (const button of ["save-report", "save-code", "save-document"]) element(button).disabled = true;
    document.body.classList.remove("outdated");
  }

  #verdict(words, kind) {
    element("verdict").textContent = words;
    element("verdict").className = kind;
  }

  #choose(view, focus = true) {
    for (const other of VIEWS) {
      const tab = element(`tab-${other}`);
      tab.ariaSelected = String(other === view);
      tab.tabIndex = other === view ? 0 : -1;
      element(`panel-${other}`).hidden = other !== view;
    }
    if (focus) element(`tab-${view}`).focus();
    if (view === "report") this.#draw();
    if (view === "code") this.#write();
  }

  /** The report, written when it is first viewed. */
  async #draw() {
    if (!this.#found || this.#report !== undefined) return;
    const found = this.#found;
    this.#report = "";
    try {
      const page = await this.#runner.call("report");
      if (found !== this.#found) return;
      this.#report = page;
      const frame = element("report");
      frame.onload = () => {
        frame.onload = null;
        frame.contentWindow.postMessage(page, "*");
      };
      frame.hidden = false;
      frame.src = "frame.html";
      element("save-report").disabled = false;
      this.#say("the report is written");
    } catch (error) {
      this.#report = undefined;
      this.#say(error.message);
    }
  }

  async #write() {
    if (!this.#found) return;
    const found = this.#found;
    try {
      const code = await this.#runner.call("export", element("target").value);
      if (found !== this.#found) return;
      this.#code = code;
      element("code").textContent = typeof code === "string" ? code : `A binary file of ${code.length} bytes, which is not shown: save it.`;
      element("save-code").disabled = false;
    } catch (error) {
      if (found !== this.#found) return;
      element("code").textContent = error.message;
      element("save-code").disabled = true;
    }
  }
}
