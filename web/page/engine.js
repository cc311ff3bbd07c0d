// SPDX-License-Identifier: Apache-2.0
// The page's side of a worker: `engine.run()` does a verb of the command and gives what it printed
// and wrote. All that is computed is computed there, by the same C as in the command.

'use strict';

/** The module, unpacked and compiled once, for all workers; again if that failed. */
const compiledModule = (() => {
  let module;
  return () => (module ||= unpackModule().catch((reason) => {
    module = null;
    throw reason;
  }));
})();

class Engine {
  constructor() {
    this.waiting = new Map();
    this.next = 1;
  }

  /** The worker, begun once; whoever asks while it begins waits for the same one. */
  start() {
    return (this.begun ||= this.begin());
  }

  async begin() {
    const worker = (this.worker = new Worker(workerAddress()));
    worker.onmessage = ({ data }) => this.answer(data);
    whenStopped(worker, (reason) => worker === this.worker && this.fail(reason));
    worker.postMessage({ module: await compiledModule() });
    return worker;
  }

  /** Do a verb.
   *  words: ['identify', 'log.csv', '--json']; files: [[name, File, Blob or Uint8Array]];
   *  progress: is called with lines such as "identifying 43 %".
   *  Gives { code, out, err, files, milliseconds }; throws Cancelled, or Error when the worker fails. */
  async run(words, { files = [], progress, environment } = {}) {
    return this.ask({ words, files, environment }, progress);
  }

  async ask(message, progress) {
    const id = this.next++;
    const answer = new Promise((resolve, reject) => this.waiting.set(id, { resolve, reject, progress, isVerb: Boolean(message.words) }));
    this.start().then((worker) => this.waiting.has(id) && worker.postMessage({ id, ...message }))
      .catch((reason) => this.fail(reason));
    return answer;
  }

  answer({ id, progress, failed, kind, ...result }) {
    const asked = this.waiting.get(id);
    if (!asked) return;
    if (progress !== undefined) {
      if (asked.progress) asked.progress(progress);
      return;
    }
    this.waiting.delete(id);
    if (failed !== undefined && asked.isVerb) this.failVerb(asked, kind, failed);
    else if (failed !== undefined) asked.reject(new Error(failed));
    else asked.resolve(result);
  }

  /** A verb has not come to its end. Nothing of it is left in the worker, but a new one is safe. */
  failVerb(asked, kind, failed) {
    const known = { NotReadableError: 'the file cannot be read any more: it was changed or moved since it was chosen; choose it again',
      NotFoundError: 'the file is not there any more; choose it again',
      RangeError: `the memory of this page is not enough (${failed}); the command at a terminal has more` };
    asked.reject(new Error(known[kind] || `the computation has stopped inside, which is a fault of imukit: ${failed}`));
    if (this.waiting.size === 0) this.fail('stopped');
  }

  fail(reason) {
    const all = [...this.waiting.values()];
    this.waiting.clear();
    if (this.worker) this.worker.terminate();
    this.worker = this.begun = null;
    for (const asked of all) asked.reject(reason instanceof Error ? reason : new Error(reason));
  }

  /** Stop what runs; the next run() has a new worker. */
  cancel() {
    this.fail(new Cancelled());
  }
}

/** Call `act` with the Error of a worker that throws outside a request, cannot be begun, or sends
 *  what cannot be received. */
function whenStopped(worker, act) {
  worker.onerror = ({ message }) => act(new Error(message || 'the worker has stopped'));
  worker.onmessageerror = () => act(new Error('an answer of the worker cannot be received'));
}

class Cancelled extends Error {
  constructor() {
    super('cancelled');
  }
}

/** The module that build.mjs has packed into the page, compiled by a worker that does only this. */
function unpackModule() {
  const worker = new Worker(workerAddress());
  const answer = new Promise((resolve, reject) => {
    worker.onmessage = ({ data }) => (data.module ? resolve(data.module)
      : reject(new Error(data.kind === 'CompileError'
        ? 'this browser does not know the vectors (SIMD) of WebAssembly, which others have since 2023; a newer one runs this page'
        : data.failed)));
    whenStopped(worker, reject);
  });
  worker.postMessage({ packed: document.getElementById('module').textContent });
  return answer.finally(() => worker.terminate());
}

/** Address of the worker's script, which is a text of this page. */
const workerAddress = (() => {
  let address;
  return () => (address ||= URL.createObjectURL(
    new Blob([document.getElementById('worker').textContent], { type: 'text/javascript' })));
})();
