// Asks the compiler in its worker. Of texts that come while it is busy only the newest is compiled.

// A compilation that is older than this, in milliseconds, is given up when there is a newer text.
const PATIENCE = 3000;

export class Compiling {
  #module;
  #worker = null;
  #number = 0;
  #asked = new Map();
  #busy = null;
  #newest = null;

  constructor(module) {
    this.#module = module;
    this.#start();
  }

  #start() {
    this.#worker?.terminate();
    this.#worker = new Worker(new URL('./worker.js', import.meta.url), { type: 'module' });
    this.#worker.postMessage({ module: this.#module });
    this.#worker.onmessage = ({ data: { number, answer, failed, diagnostics } }) => {
      const asked = this.#asked.get(number);
      this.#asked.delete(number);
      if (answer) asked?.done(answer);
      else asked?.wrong(Object.assign(new Error(failed), { diagnostics }));
    };
    // Whoever waits for the worker before hears of its end.
    const old = [...this.#asked.values()];
    this.#asked.clear();
    old.forEach(({ wrong }) => wrong(new Error('a newer text came')));
  }

  // One request; it waits for those before it.
  ask(what, text, options) {
    const number = ++this.#number;
    return new Promise((done, wrong) => {
      this.#asked.set(number, { done, wrong });
      this.#worker.postMessage({ number, what, text, options });
    });
  }

  // The same for a text that replaces the one before; null where a newer one replaced it.
  async latest(what, text, options) {
    const mine = {};
    this.#newest = mine;
    const limit = this.#busy && setTimeout(() => this.#newest === mine && this.#start(), PATIENCE - Math.min(PATIENCE, performance.now() - this.#busy.since));
    while (this.#busy) await this.#busy.end;
    clearTimeout(limit);
    if (this.#newest !== mine) return null;
    const end = this.ask(what, text, options);
    const busy = { since: performance.now(), end: end.catch(() => {}) };
    this.#busy = busy;
    try {
      return await end;
    } catch (error) {
      if (this.#newest !== mine) return null;
      throw error;
    } finally {
      if (this.#busy === busy) this.#busy = null;
    }
  }
}
