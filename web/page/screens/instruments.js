// SPDX-License-Identifier: Apache-2.0
// Instruments from first principles that run: all twelve as drawings, and one of them alive.

'use strict';

screens.instruments = {
  title: 'Instruments',
  show(root, name) {
    return name ? showInstrument(root, name) : showGallery(root);
  },
};

/** The worker in which instruments run; one for all, one instrument at a time. */
const liveEngine = new Engine();
const askLive = (what, ...values) => liveEngine.ask({ live: what, values });

/** Names and titles of all instruments, from the command. */
const instrumentList = (() => {
  let list;
  return () => (list ||= engine.run(['physics', '--json']).then(({ out }) => JSON.parse(out).result.instruments));
})();

function showGallery(root) {
  const status = element('p', { role: 'status' }, 'Drawing…');
  const cards = element('ul', { class: 'gallery' });
  let ended = false;
  root.append(element('h1', {}, 'Instruments'),
    element('p', {}, 'Twelve gyros and accelerometers, simulated from the physics of their parts. Choose one to see it run: turn it, push it, change a part.'),
    status, cards);
  (async () => {
    for (const { name, title } of await instrumentList()) {
      if (ended) return;
      const { problem, schematic } = await askLive('open', name);
      const drawing = schematic && element('img', { alt: '', src: 'data:image/svg+xml,' + encodeURIComponent(schematic), width: 270, height: 200 });
      cards.append(element('li', {}, element('a', { href: '#instruments/' + name }, drawing, element('span', {}, title + (problem ? `: ${problem}` : '')))));
    }
    status.textContent = '';
  })().catch((reason) => ended || (status.textContent = reason.message));
  return () => (ended = true);
}

function showInstrument(root, name) {
  const view = new InstrumentView(root, name);
  view.open();
  return () => view.end();
}

/** One instrument on the screen: it asks the worker for what happened since the last frame, and
 *  shows it in the next. */
class InstrumentView {
  constructor(root, name) {
    Object.assign(this, { root, name, ended: false, playing: false, waiting: null, screen: 0, charts: [], parts: [] });
    this.design = new Map(); // what was changed: path to text
    this.input = new Map(); // rate, acceleration, temperature to text
    this.noise = true;
    this.status = element('p', { role: 'status' }, 'Starting…');
    root.append(element('p', {}, element('a', { href: '#instruments' }, 'All instruments')), this.status);
    this.visible = () => document.hidden || this.wake();
    document.addEventListener('visibilitychange', this.visible);
  }

  end() {
    this.ended = true;
    this.playing = false;
    document.removeEventListener('visibilitychange', this.visible);
    this.charts.forEach(({ chart }) => chart.end());
  }

  async open() {
    try {
      const answer = await askLive('open', this.name);
      if (this.ended) return;
      if (answer.problem) throw new Error(answer.problem);
      this.about = answer.about;
      this.first = answer.about;
      document.title = `${answer.about.title} · imukit`;
      layOutInstrument(this, answer);
      for (const [what, text] of this.input) await askLive('expose', what, text); // as the terminal's line says
      if (this.ended) return;
      this.status.textContent = '';
      this.play(!matchMedia('(prefers-reduced-motion: reduce)').matches);
      if (!this.playing) this.advance(1 / 60);
    } catch (reason) {
      if (!this.ended) this.status.textContent = reason.message;
    }
  }

  play(playing) {
    this.playing = playing;
    this.playButton.textContent = playing ? 'Pause' : 'Play';
    this.wake();
  }

  wake() {
    if (!this.playing || this.ended || this.running) return;
    this.running = true;
    this.last = performance.now();
    requestAnimationFrame((now) => this.frame(now));
  }

  frame(now) {
    if (this.waiting) {
      this.draw(this.waiting, now);
      this.waiting = null;
    }
    if (!this.playing || this.ended || document.hidden) {
      this.running = false;
      return;
    }
    requestAnimationFrame((next) => this.frame(next));
    if (this.asked) return;
    const passed = Math.min((now - this.last) / 1000, 0.05);
    this.behind = 0.95 * (this.behind || 0) + 0.05 * ((now - this.last) / 1000 - passed);
    this.last = now;
    if (passed > 0) this.ask(passed);
  }

  ask(seconds) {
    this.asked = true;
    return askLive('step', seconds).then((answer) => {
      this.asked = false;
      if (this.ended) return;
      this.screen += seconds;
      this.waiting = { ...answer, screen: this.screen, seconds };
    }, (reason) => {
      this.asked = false;
      if (!this.ended) this.fail(reason);
    });
  }

  /** One step while it stands. */
  async advance(seconds) {
    await this.ask(seconds);
    if (this.waiting && !this.ended) this.draw(this.waiting, performance.now());
    this.waiting = null;
  }

  fail(reason) {
    this.playing = false;
    this.status.textContent = `The instrument has stopped: ${reason.message}. Choose it again to start it.`;
  }

  draw({ rows, width, moment, screen, seconds }, now) {
    const count = rows.length / width;
    for (const { chart, column, input } of this.charts) {
      for (let k = 0; k < count; k++)
        chart.add(screen - seconds * (1 - (k + 1) / count), rows[k * width + 1 + column()], ...(input() ? [moment[1]] : []));
      chart.draw();
    }
    this.parts.forEach((part, i) => placePart(part, moment[2 + i]));
    if (count) this.row = rows.subarray((count - 1) * width);
    if (now - (this.told || -1e9) < 250 && this.playing) return;
    this.told = now;
    this.tell(moment);
  }

  /** Numbers as text, four times a second. */
  tell(moment) {
    this.clock.textContent = timeText(moment[0], this.about.pace);
    if (this.row) for (const { column, now, unit } of this.charts) now.textContent = shownNumber(this.row[1 + column()]) + unit;
    this.values.forEach((cell, i) => {
      const text = shownNumber(moment[2 + this.parts.length + i]);
      if (cell.textContent !== text) cell.textContent = text;
    });
    this.slow.textContent = this.behind > 0.004 ? 'This machine cannot keep this pace: it runs slower than stated.' : '';
  }

  /** A parameter of the design. Gives a problem or ''. */
  async change(path, text) {
    const before = this.design.get(path);
    this.design.set(path, text);
    const answer = await askLive('change', this.designFile());
    if (this.ended) return '';
    if (answer.problem) {
      if (before === undefined) this.design.delete(path);
      else this.design.set(path, before);
      return answer.problem;
    }
    this.renew(answer);
    return '';
  }

  async expose(what, text) {
    const { problem } = await askLive('expose', what, text);
    if (!problem) this.input.set(what, text);
    this.showTerminal();
    return problem;
  }

  async pace(value, noise) {
    const answer = await askLive('pace', value, noise ? 1 : 0);
    if (this.ended || answer.problem) return answer.problem;
    this.noise = noise;
    this.renew(answer);
    return '';
  }

  /** After a change that began a new run. */
  renew(answer) {
    this.about = answer.about;
    showSchematic(this, answer);
    showQuantities(this);
    this.charts.forEach(({ chart, sample }) => (chart.add(this.screen, NaN, NaN), sample(answer.about.rate)));
    this.showTerminal();
    if (!this.playing) this.advance(1 / 60);
  }

  designFile() {
    return `imukit: 1\ninstrument: ${this.name}\n` + nested([...this.design].map(([path, text]) => [path.split('.'), text]), '');
  }

  showTerminal() {
    const options = [...this.input].map(([what, text]) => ` --${what} "${text}"`).join('');
    const changed = this.design.size > 0;
    const command = `imukit physics ${changed ? 'mine.yaml' : this.name}${options}${this.noise ? '' : ' --no-noise'} --output-rate ${this.about.rate}Hz --duration ${Number((1000 / this.about.rate).toPrecision(6))}s -o out.csv --signals inside.csv`;
    this.terminal.textContent = (changed ? `# mine.yaml\n${this.designFile()}\n` : '') + command;
  }
}

/** Keys with their values as YAML, one level a dot. */
function nested(list, indent) {
  const groups = new Map();
  for (const [[key, ...rest], text] of list) groups.set(key, [...(groups.get(key) || []), [rest, text]]);
  return [...groups].map(([key, members]) =>
    members[0][0].length === 0 ? `${indent}${key}: ${members[0][1]}\n` : `${indent}${key}:\n${nested(members, indent + '  ')}`).join('');
}

/** "12.3 µs"; with a pace [s/s] as many decimals as are seen to move. */
function timeText(seconds, pace) {
  const [size, unit] = [[1, 's'], [1e-3, 'ms'], [1e-6, 'µs'], [1e-9, 'ns']].find(([size]) => seconds >= size) || [1, 's'];
  const number = pace ? (seconds / size).toFixed(Math.min(9, Math.max(0, Math.ceil(1 - Math.log10(pace / size))))) : String(Number((seconds / size).toPrecision(4)));
  return `${number} ${unit}`;
}
