// SPDX-License-Identifier: Apache-2.0
// Figures of the tour: an instrument that runs, an experiment of the bench, or what commands make
// of the values of some controls.

'use strict';

/** Put the figure of a subject into an element. Gives a function that ends it, or nothing. */
function showTourFigure(root, figure) {
  if (figure.bench) {
    root.classList.add('bench');
    return figure.bench === 'target' ? showTarget(root) : undefined;
  }
  if (figure.live) {
    root.classList.add('instrument');
    return showLiveFigure(root, figure);
  }
  return showComputedFigure(root, figure);
}

/** Rows of sliders and choices; change(name, text) gives a problem or ''. */
function tourControls(controls, change) {
  return controls.map(({ name, value, ...control }) => {
    const made = { ...control, text: value, change: (text) => change(name, text) };
    return (control.choices ? makeChoice(made) : makeSlider(made)).row;
  });
}

/* ---- instruments that run ---- */

/** The view of screens/instruments.js with a drawing, one curve and the controls that matter here. */
class TourInstrument extends InstrumentView {
  constructor(root, figure, name) {
    super(root, name);
    this.figure = figure;
    root.replaceChildren(this.status);
    this.drawing = element('div', {});
    this.quantities = element('div', {});
    this.terminal = element('pre', { tabindex: 0 });
    this.clock = element('output', {});
    this.slow = element('p', { class: 'weak' });
    this.playButton = element('button', { type: 'button', onclick: () => this.play(!this.playing) }, 'Play');
  }

  async open() {
    try {
      const answer = await askLive('open', this.name);
      if (this.ended) return;
      if (answer.problem) throw new Error(answer.problem);
      this.about = answer.about;
      for (const { name, value } of this.figure.controls) {
        if (name in inputNames) await this.expose(name, value);
        else if (name !== 'instrument') this.design.set(name, value);
        if (this.ended) return;
      }
      const begun = await askLive('change', this.designFile());
      if (this.ended) return;
      if (begun.problem) throw new Error(begun.problem);
      this.layOut(begun);
      this.status.textContent = '';
      this.play(!matchMedia('(prefers-reduced-motion: reduce)').matches);
      if (!this.playing) this.advance(1 / 60);
    } catch (reason) {
      if (!this.ended) this.status.textContent = reason.message;
    }
  }

  layOut(answer) {
    const { outputs, signals, rate } = answer.about, named = ({ name }) => name === this.figure.curve;
    this.charts = [signals.some(named) ? makeChart('Signal', signals, outputs.length, signals.findIndex(named), rate)
      : makeChart('Output', outputs, 0, Math.max(0, outputs.findIndex(named)), rate)];
    this.root.prepend(this.drawing, element('p', { class: 'buttons' }, this.playButton, 'Time of the run ', this.clock), ...this.charts.map(({ root }) => root), this.slow);
    showSchematic(this, answer);
    showQuantities(this);
    this.showTerminal();
  }

  /** The value of a control: the motion, or a part of the design. Where time is slowed a thousand
   *  times or more, the instrument is shown as it settles with another motion. */
  async control(name, text) {
    if (!(name in inputNames)) return this.change(name, text);
    const problem = await this.expose(name, text);
    if (!problem && this.about.pace < 1e-3) this.renew(await askLive('change', this.designFile()));
    return problem;
  }
}

function showLiveFigure(root, figure) {
  let view, name = figure.live;
  const place = element('div', {}), terminal = element('details', {}, element('summary', {}, 'The same at a terminal'));
  const more = element('p', {});
  function open() {
    if (view) view.end();
    view = new TourInstrument(place, figure, name);
    more.replaceChildren(element('a', { href: '#instruments/' + name }, 'All parts and curves of this instrument'));
    terminal.replaceChildren(terminal.firstChild, view.terminal);
    view.open();
  }
  function change(control, text) {
    const at = figure.controls.findIndex((one) => one.name === control);
    figure = { ...figure, controls: figure.controls.map((one, i) => (i === at ? { ...one, value: text } : one)) };
    if (control !== 'instrument') return view.control(control, text);
    name = figure.names[text];
    open();
    return '';
  }
  root.append(place, element('div', { class: 'controls' }, tourControls(figure.controls, change)), terminal, more);
  open();
  return () => view.end();
}

/* ---- what commands make ---- */

function showComputedFigure(root, figure) {
  const values = Object.fromEntries(figure.controls.map(({ name, value }) => [name, value]));
  const status = element('p', { role: 'status', class: 'weak' }), place = element('div', { class: 'made' });
  const terminal = element('details', {}, element('summary', {}, 'The same at a terminal'));
  let ended = false;
  const compute = lastOnly(async () => {
    status.textContent = 'Computing…';
    const files = Object.fromEntries(Object.entries(figure.files || {}).map(([name, text]) => [name, filled(text, values)]));
    const lines = figure.run.map((line) => filled(line, values));
    try {
      const done = await runCommands((words, rest) => engine.run(words, rest), lines, files);
      if (ended) return;
      place.replaceChildren(shownResult(done, { ...figure, show: figure.show && filled(figure.show, values) }));
      imukitFigures.attach(place);
      status.textContent = '';
    } catch (reason) {
      if (!ended) status.textContent = reason.message;
    }
    terminal.replaceChildren(terminal.firstChild, element('pre', { tabindex: 0 }, terminalLines(lines, files)));
  });
  const inUnit = (name, text) => {
    const control = figure.controls.find((one) => one.name === name);
    const bare = Object.values(figure.files || {}).some((file) => file.includes(`{${name}.number}`));
    return bare && !text.trim().endsWith(' ' + control.unit) ? `Write it in ${control.unit}.` : '';
  };
  async function change(name, text) {
    const wrong = inUnit(name, text);
    if (wrong) return wrong;
    values[name] = text;
    await compute();
    return '';
  }
  root.append(place, status, element('div', { class: 'controls' }, tourControls(figure.controls, change)), terminal,
    ...(figure.more ? [element('p', {}, element('a', { href: '#bench' }, figure.more))] : []));
  compute();
  return () => (ended = true);
}

/** Files and commands as they are typed. */
function terminalLines(lines, files) {
  return [...Object.entries(files).map(([name, text]) => `# ${name}\n${text.trimEnd()}\n`), ...lines.map((line) => 'imukit ' + line)].join('\n');
}

/** An animation, a panel or a table of the report, or the readings of a printed log. */
function shownResult(done, figure) {
  const text = (name) => new TextDecoder().decode(done.files.get(name));
  if (figure.animation) {
    const host = element('div', { class: 'drawn' });
    const drawing = new DOMParser().parseFromString(text('figure.svg'), 'image/svg+xml').documentElement;
    host.attachShadow({ mode: 'open' }).append(element('style', {}, 'svg { display: block; width: 100%; height: auto; } @media screen and (prefers-color-scheme: dark) { svg { filter: invert(.9) hue-rotate(180deg); } }'), document.importNode(drawing, true));
    return host;
  }
  if (figure.readings) return readingsTable(done.out);
  const article = new DOMParser().parseFromString(text('report.html'), 'text/html');
  const named = [...article.querySelectorAll('.panel svg, .table')].find((part) => part.getAttribute('aria-label').startsWith(figure.show));
  if (!named) throw new Error(`the report has no ${figure.show}`);
  const part = document.importNode(named.closest('.panel, .table'), true);
  if (part.matches('.table')) return element('div', { class: 'imukit' }, part);
  return element('div', { class: 'imukit' }, element('figure', { class: 'panels columns-1' }, element('div', { class: 'panes' }, part)));
}

/** The last row of a printed log, one reading a line. */
function readingsTable(csv) {
  const rows = csv.trimEnd().split('\n').map((line) => line.split(','));
  const last = rows[rows.length - 1];
  return element('table', { class: 'readings' }, element('tbody', {}, rows[0].map((head, i) => {
    const [, name, unit] = /^(\w+) \[(.*)\]$/.exec(head);
    return name === 'time' ? null : element('tr', {}, element('th', { scope: 'row' }, name.replace('_', ' ')), element('td', {}, `${last[i].replace('-', '−')} ${unit}`));
  }).filter((row) => row)));
}
