// SPDX-License-Identifier: Apache-2.0
// What stands where on the screen of one instrument: drawing and controls, curves and quantities.

'use strict';

function layOutInstrument(view, answer) {
  const { about } = answer;
  view.drawing = element('div', {});
  view.charts = [makeChart('Output', about.outputs, 0, 0, about.rate), makeChart('Signal', about.signals, about.outputs.length, about.first_signal, about.rate)];
  view.quantities = element('div', {});
  view.terminal = element('pre', { tabindex: 0 });
  view.root.append(
    element('h1', {}, about.title[0].toUpperCase() + about.title.slice(1)),
    element('p', {}, about.description || ''),
    element('div', { class: 'instrument' },
      element('section', { 'aria-label': 'Drawing and controls' }, view.drawing, makeRunControls(view), makeInputs(view), makeDesign(view)),
      element('section', { 'aria-label': 'Curves and quantities' }, view.charts.map(({ root }) => root), element('h2', {}, 'Quantities'), view.quantities)),
    element('h2', {}, 'The same at a terminal'), view.terminal,
    element('p', {}, 'The first thousand samples from power-on; those that run here are the same doubles. ',
      element('button', { type: 'button', onclick: () => takeLog(view) }, 'Take this log')),
    element('p', { class: 'weak' }, `Default design: ${about.source}`));
  showSchematic(view, answer);
  showQuantities(view);
  view.showTerminal();
}

function showSchematic(view, { schematic, about }) {
  const drawn = schematic ? importSchematic(schematic, about) : { host: element('p', { class: 'weak' }, 'No drawing of this instrument.'), parts: [] };
  view.parts = drawn.parts;
  view.drawing.replaceChildren(drawn.host);
}

/** A chart with a choice of what it shows. */
function makeChart(label, signals, first, chosen, rate) {
  const id = 'chart' + label;
  const nice = (name) => name.replace(/_/g, ' ');
  const now = element('output', { class: 'number' });
  const place = element('div', {});
  const made = { rate, now, column: () => first + Number(select.value), input: () => first === 0 && Number(select.value) === 0 };
  const select = element('select', { id, onchange: renew },
    signals.map(({ name, help }, i) => element('option', { value: i, title: help, selected: i === chosen }, nice(name))));
  function renew() {
    const signal = signals[Number(select.value)];
    if (made.chart) made.chart.end();
    made.chart = new StripChart({ label: `${nice(signal.name)} against time on the screen`, unit: signal.unit, names: made.input() ? ['output', 'input'] : ['signal'] });
    place.replaceChildren(made.chart.root);
    made.unit = signal.unit === '1' ? '' : ' ' + signal.unit;
    made.sample();
  }
  // What one sample is, which at a slow pace is much less than what a reading needs.
  made.sample = (rate = made.rate) => {
    made.rate = rate;
    const short = rate > 2e5 ? ' So short a time shows single counts and pulses: nearer to real time they are means.' : '';
    made.help.textContent = signals[Number(select.value)].help + (made.input() ? `; dashed: the true input. A sample lasts ${timeText(1 / rate)}.${short}` : '');
  };
  made.help = element('p', { class: 'weak' });
  made.root = element('figure', {}, element('figcaption', {}, element('label', { for: id }, label + ' '), select, ' ', now), place, made.help);
  renew();
  return made;
}

/** Pause, step, time scale, noise. */
function makeRunControls(view) {
  const { about } = view;
  const paces = paceList(about.pace);
  const said = element('output', { for: 'pace' }), problem = element('p', { class: 'problem', role: 'alert' });
  const noise = element('input', { type: 'checkbox', checked: true, onchange: () => take() });
  const range = element('input', { type: 'range', id: 'pace', min: 0, max: paces.length - 1, value: paces.indexOf(about.pace), oninput: () => take() });
  view.playButton = element('button', { type: 'button', class: 'main', onclick: () => view.play(!view.playing) }, 'Play');
  view.clock = element('output', { class: 'number' });
  view.slow = element('p', { class: 'weak' });
  function show() {
    const pace = paces[Number(range.value)];
    const text = `1 s shows ${timeText(pace)}` + (pace < 1 ? `, ${Math.round(1 / pace).toLocaleString('en')} times slower` : pace > 1 ? `, ${threeDigits(pace)} times faster` : ': real time');
    said.textContent = text;
    range.setAttribute('aria-valuetext', text);
    return pace;
  }
  async function take() {
    problem.textContent = (await view.pace(show(), noise.checked)) || '';
  }
  show();
  return element('div', { class: 'controls' },
    element('div', { class: 'buttons' }, view.playButton,
      element('button', { type: 'button', onclick: () => (view.play(false), view.advance(1 / 30)) }, 'Step'),
      element('button', { type: 'button', onclick: async () => { await askLive('restart'); view.renew({ about: view.about, schematic: (await askLive('look')).schematic }); } }, 'Start again'),
      element('span', {}, 'Time of the run ', view.clock)),
    element('div', { class: 'slider wide' }, element('label', { for: 'pace' }, 'Time scale'), range, said, problem),
    element('label', {}, noise, ' Noise'), view.slow);
}

/** Time scales from twenty times slower than at first to real time, or beyond. */
function paceList(first) {
  const list = [first];
  for (let power = Math.floor(Math.log10(first / 20)); power <= 3; power++)
    for (const digit of [1, 2, 5]) {
      const pace = Number(`${digit}e${power}`);
      if (pace >= first / 20 && pace <= Math.max(1, 5 * first) && Math.abs(pace / first - 1) > 0.02) list.push(pace);
    }
  return list.sort((a, b) => a - b);
}

const inputNames = { rate: 'Angular rate about x', acceleration: 'Specific force along x', temperature: 'Temperature' };

/** Motion and temperature: sliders of the schematic, or usual ranges. */
function makeInputs(view) {
  const { about } = view, stated = (path) => about.sliders.find((slider) => slider.path === path);
  const inputs = [
    { path: 'rate', unit: 'deg/s', minimum: -50, maximum: 50, value: about.angular_rate[0] * (180 / Math.PI) },
    { path: 'acceleration', unit: 'g', minimum: -10, maximum: 10, value: about.specific_force[0] / 9.80665 },
    { path: 'temperature', unit: 'degC', minimum: -40, maximum: 85, value: 20 },
  ];
  const box = element('fieldset', {}, element('legend', {}, 'Motion and temperature'));
  for (const input of inputs) {
    const slider = { ...input, ...stated(input.path) };
    const text = `${threeDigits(input.value)} ${input.unit}`;
    if (input.value !== 0 && input.path !== 'temperature') view.input.set(input.path, text);
    box.append(makeSlider({ ...slider, label: inputNames[input.path], text, unit: slider.unit || input.unit, help: 'Three numbers are x, y and z', change: (given) => view.expose(input.path, given) }).row);
  }
  box.append(element('p', { class: 'weak' }, 'Three numbers in a field are the axes x, y and z: 0 0 1 g.'));
  return box;
}

/** Main parameters as sliders, and all of them in a list. */
function makeDesign(view) {
  const { about } = view, made = new Map();
  const fieldOf = (path) => about.fields.find((field) => field.path === path);
  function put(path, text) {
    (made.get(path) || []).forEach(({ set }) => set(text));
  }
  function control(field, slider) {
    const change = async (text) => {
      const problem = await view.change(field.path, text);
      if (!problem) put(field.path, text);
      return problem;
    };
    const label = field.path.replace(/[._]/g, ' ');
    const common = { label, text: tidyNumbers(field.value), help: field.help, change };
    const control = field.choices ? makeChoice({ ...common, choices: field.choices })
      : slider ? makeSlider({ ...common, ...slider, unit: slider.unit || field.unit })
        : makeField(common);
    made.set(field.path, [...(made.get(field.path) || []), control]);
    return control.row;
  }
  const main = about.sliders.filter(({ path }) => !(path in inputNames) && fieldOf(path));
  const reset = element('button', { type: 'button', onclick: async () => {
    view.design.clear();
    view.renew(await askLive('change', view.designFile()));
    about.fields.forEach(({ path, value }) => put(path, tidyNumbers(value)));
  } }, 'Default design');
  return element('fieldset', {}, element('legend', {}, 'Design'),
    main.map((slider) => control(fieldOf(slider.path), slider)), reset,
    element('details', {}, element('summary', {}, `All ${about.fields.length} parameters`),
      element('div', { class: 'all' }, about.fields.map((field) => control(field)))));
}

/** A parameter to write, with what it is. */
function makeField({ label, text, help, change }) {
  const id = 'field' + ++sliderCount, problem = element('p', { class: 'problem', id: id + 'p', role: 'alert' });
  const field = element('input', { type: 'text', id, value: text, spellcheck: 'false', autocomplete: 'off', 'aria-describedby': id + 'h ' + id + 'p',
    onchange: async () => {
      problem.textContent = (await change(field.value)) || '';
      field.setAttribute('aria-invalid', problem.textContent ? 'true' : 'false');
    } });
  return { field, set: (given) => ((field.value = given), (problem.textContent = ''), field.setAttribute('aria-invalid', 'false')),
    row: element('div', { class: 'slider' }, element('label', { for: id }, label), field, element('span', { class: 'weak', id: id + 'h' }, help), problem) };
}

/** Live quantities, then all that follows from the parts. */
function showQuantities(view) {
  const { about } = view;
  const row = ({ name, equation, unit }, cell) =>
    element('tr', {}, element('th', { scope: 'row' }, name, equation ? element('code', {}, equation) : null), element('td', {}, cell, '\u00a0', unit && unit !== '1' ? unit : ''));
  view.values = about.quantities.map(() => element('output', { class: 'number' }));
  const open = view.quantities.querySelector('details');
  const derived = element('table', {}, element('tbody', {}, about.derived.map((one) =>
    row(one, one.value === null ? element('span', { class: 'absent' }, `– (${one.absent || 'none'})`) : shownNumber(one.value)))));
  view.quantities.replaceChildren(
    ...(about.quantities.length
      ? [element('table', {}, element('tbody', {}, about.quantities.map((one, i) => row(one, view.values[i])))),
        element('details', { open: !!(open && open.open) }, element('summary', {}, 'All that follows from the parts'), derived)]
      : [derived]));
}

/** The log of the command line, by the verb. */
async function takeLog(view) {
  const words = ['physics', view.design.size ? 'mine.yaml' : view.name, ...[...view.input].flatMap(([what, text]) => ['--' + what, text]),
    ...(view.noise ? [] : ['--no-noise']), '--output-rate', `${view.about.rate}Hz`, '--duration', `${Number((1000 / view.about.rate).toPrecision(6))}s`, '-o', 'out.csv', '--signals', 'inside.csv'];
  try {
    const done = await engine.run(words, { files: [['mine.yaml', new TextEncoder().encode(view.designFile())]] });
    view.status.textContent = done.code === 0 ? '' : done.err;
    for (const [name, bytes] of done.files) download(name, bytes);
  } catch (reason) {
    view.status.textContent = reason.message;
  }
}
