// SPDX-License-Identifier: Apache-2.0
// In the worker: an instrument that runs on and on, by the functions of core/live.c. One worker
// runs one instrument; what is asked is { live: WHAT, values: [...] }:
//
//   open    [name]                        { problem } or { about }, the JSON of live_describe()
//   change  [design file]                 the same; what ran goes on when there is a problem
//   expose  [what, text]                  { problem }: "rate", "10 deg/s"
//   pace    [seconds per second, noise]   { problem, about }
//   restart []                            { problem }, from power-on
//   look    []                            { about }
//   step    [seconds on the screen]       { rows, width, moment }
//   reckon  [bytes of a .npy of simulate, heading, rows between reports]
//                                         { track }: see core/reckon.c
//
// `rows` is one Float64Array of `width` numbers a row: time, outputs, signals, in the
// units of a log.

'use strict';

/** The functions of live.c with texts and arrays of JavaScript. */
class LiveInstrument {
  constructor(exports) {
    this.exports = exports;
    this.decoder = new TextDecoder();
    this.width = 0;
    exports._initialize();
  }

  /** Call a function that takes texts and gives one. */
  text(name, ...texts) {
    const places = texts.map((text) => {
      const bytes = new TextEncoder().encode(text + '\0');
      const at = this.exports.malloc(bytes.length);
      new Uint8Array(this.exports.memory.buffer, at, bytes.length).set(bytes);
      return at;
    });
    const given = this.given(this.exports[name](...places));
    places.forEach((at) => this.exports.free(at));
    return given;
  }

  given(at) {
    const bytes = new Uint8Array(this.exports.memory.buffer, at);
    return this.decoder.decode(bytes.slice(0, bytes.indexOf(0)));
  }

  about() {
    const about = JSON.parse(this.text('live_describe'));
    this.width = 1 + about.outputs.length + about.signals.length;
    this.moment = 2 + about.parts.length + about.quantities.length;
    return { about, schematic: this.text('live_schematic') };
  }

  numbers(at, count) {
    return new Float64Array(this.exports.memory.buffer, at, count).slice();
  }

  /** Navigate a log of a unit at rest: time, three rates, three forces a row. */
  reckon(bytes, heading, every) {
    const header = 10 + bytes[8] + 256 * bytes[9];
    const log = new Float64Array(bytes.slice(header).buffer), rows = log.length / 7;
    const place = this.exports.reckon_room(rows), room = new Float64Array(this.exports.memory.buffer, place, 6 * rows);
    for (let k = 0; k < rows; k++) room.set(log.subarray(7 * k + 1, 7 * k + 7), 6 * k);
    const at = this.exports.reckon(rows, (log[7 * (rows - 1)] - log[0]) / (rows - 1), heading, every);
    return { track: this.numbers(at, 4 * (Math.floor(rows / every) + 1)) };
  }

  do(what, values) {
    if (what === 'reckon') return this.reckon(...values);
    if (what === 'step') {
      const count = this.exports.live_step(...values);
      return {
        rows: this.numbers(this.exports.live_rows(), count * this.width),
        width: this.width,
        moment: this.numbers(this.exports.live_moment(), this.moment),
      };
    }
    if (what === 'look') return this.about();
    const problem = what === 'pace' ? this.given(this.exports.live_pace(...values)) : this.text('live_' + what, ...values);
    if (problem || what === 'expose' || what === 'restart') return { problem };
    return { problem, ...this.about() };
  }
}

async function doLive({ id, live: what, values }) {
  if (!live.instance) {
    const system = new PageSystem({ words: [], files: [] });
    const { exports } = await WebAssembly.instantiate(await compiled, system.imports);
    system.memory = exports.memory;
    live.instance = new LiveInstrument(exports);
  }
  const instance = live.instance;
  live.instance = null; // should it fail, the next has a new one
  const answer = instance.do(what, values);
  live.instance = instance;
  postMessage({ id, ...answer }, answer.rows ? [answer.rows.buffer, answer.moment.buffer] : []);
}

if (typeof module !== 'undefined') module.exports = { LiveInstrument };
