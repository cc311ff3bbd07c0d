// SPDX-License-Identifier: Apache-2.0
// What the experiments of the bench share: verbs in a row, tables of logs, drawings.

'use strict';

/** Do a verb with files and give what it made; throws its message.
 *  files: { name: text or bytes } */
async function bench(words, files = {}) {
  const given = Object.entries(files).map(([name, content]) => [name, typeof content === 'string' ? new TextEncoder().encode(content) : content]);
  const done = await engine.run(words, { files: given });
  if (done.code !== 0) throw new Error(done.err.trim() || `${words[0]} failed`);
  return { out: done.out, file: (name) => done.files.find(([made]) => made === name)[1] };
}

/** Columns of a CSV: { 'yaw [deg]': [...] }. */
function csvColumns(bytes) {
  const [head, ...lines] = new TextDecoder().decode(bytes).trimEnd().split('\n');
  const names = head.split(','), columns = names.map(() => new Float64Array(lines.length));
  lines.forEach((line, row) => line.split(',').forEach((word, c) => (columns[c][row] = Number(word))));
  return Object.fromEntries(names.map((name, c) => [name, columns[c]]));
}

/** Navigate a log of a unit at rest (core/reckon.c). `log`: bytes of a .npy of simulate; heading at
 *  the start [deg]; rows between reports. Gives columns. */
async function reckon(log, heading, every) {
  const { track } = await askLive('reckon', log, heading, every);
  const column = (c) => Float64Array.from({ length: track.length / 4 }, (_, row) => track[4 * row + c]);
  return { time: column(0), north: column(1), east: column(2), heading: column(3) };
}

/** What is asked while something runs is done when it ends; of several the last. */
function lastOnly(act) {
  let running = false, next = null;
  return async function ask(...values) {
    if (running) {
      next = values;
      return;
    }
    running = true;
    try {
      await act(...values);
    } finally {
      running = false;
      if (next) {
        const given = next;
        next = null;
        ask(...given);
      }
    }
  };
}

/** svg('circle', { r: 3 }, …) */
function svg(name, attributes = {}, ...content) {
  const made = document.createElementNS('http://www.w3.org/2000/svg', name);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  made.append(...content.flat(Infinity));
  return made;
}

/** Where the same is had at a terminal. */
function terminalText(...lines) {
  return element('details', {}, element('summary', {}, 'The same at a terminal'), element('pre', { tabindex: 0 }, lines.join('\n')));
}

/** Play what has a length: `draw(passed)` gets 0 to 1. Reduced motion: it shows the end. */
class Replay {
  constructor({ seconds, draw, button, name = 'Play' }) {
    Object.assign(this, { seconds, draw, button, name, passed: 0, playing: false });
    button.onclick = () => (this.playing ? this.pause() : this.start());
    this.pause();
  }

  start() {
    if (matchMedia('(prefers-reduced-motion: reduce)').matches) {
      this.passed = 1;
      this.draw(1);
      return;
    }
    if (this.passed >= 1) this.passed = 0;
    this.playing = true;
    this.button.textContent = 'Pause';
    this.last = null;
    requestAnimationFrame((now) => this.frame(now));
  }

  pause() {
    this.playing = false;
    this.button.textContent = this.name;
  }

  frame(now) {
    if (!this.playing) return;
    if (this.last !== null) this.passed = Math.min(1, this.passed + Math.min(now - this.last, 100) / 1000 / this.seconds);
    this.last = now;
    this.draw(this.passed);
    if (this.passed >= 1) this.pause();
    else requestAnimationFrame((next) => this.frame(next));
  }
}
