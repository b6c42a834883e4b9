// A worker with the compiler, as called by the page.

/** The compiler rejected its input; any other error is a bug in the page. */
export class Refusal extends Error {}

/** The worker crashed; the next call uses a new one. */
export class Broken extends Refusal {}

/** The work was cancelled. */
export class Cancelled extends Error {}

export class Compiler {
  #module;
  #progress;
  #worker;
  #pending = new Map();
  #count = 0;

  /** `module`: a promise of the compiled WebAssembly. `progress` is called with what is being done. */
  constructor(module, progress = () => {}) {
    this.#module = module;
    this.#progress = progress;
    this.#begin();
  }

  #begin() {
    this.#worker = new Worker("worker.js", { type: "module" });
    this.#worker.onmessage = ({ data }) => this.#hear(data);
    // A worker that cannot be loaded never answers.
    this.#worker.onerror = ({ message }) => this.#end(new Broken(message ?? "a part of the page was not loaded"));
    this.ready = this.#module.then((module) => this.#call("start", [module]));
    this.ready.catch(() => {});
  }

  #hear({ id, value, fault, broken, progress }) {
    if (progress !== undefined) return this.#progress(progress);
    const { resolve, reject } = this.#pending.get(id);
    this.#pending.delete(id);
    if (fault === undefined) return resolve(value);
    if (!broken) return reject(new Refusal(fault));
    this.cancel();
    const why = `error[out-of-memory]: the work broke off (${fault})\n  = help: a page has 4 GB at most; the program sidc takes what the machine has`;
    reject(new Broken(why));
  }

  #call(call, args) {
    const id = ++this.#count;
    return new Promise((resolve, reject) => {
      this.#pending.set(id, { resolve, reject });
      this.#worker.postMessage({ id, call, args });
    });
  }

  async call(call, ...args) {
    await this.ready;
    return this.#call(call, args);
  }

  /** Ends all work at once with this reason; the next call uses a new worker. */
  cancel(why = "cancelled") {
    this.#worker.terminate();
    this.#end(new Cancelled(why));
    this.#begin();
  }

  /** Rejects all pending calls. */
  #end(fault) {
    for (const { reject } of this.#pending.values()) reject(fault);
    this.#pending.clear();
  }
}
