// SPDX-License-Identifier: Apache-2.0
// Accuracy against precision: each shot is a sample of a gyro at rest, x to the right and y up.

'use strict';

const targetKinds = {
  'accurate and precise': ['0 deg/h', '0 deg/h', '0.5 deg/h'],
  'precise, not accurate': ['4 deg/h', '3 deg/h', '0.5 deg/h'],
  'accurate, not precise': ['0 deg/h', '0 deg/h', '3 deg/h'],
  'neither': ['-4 deg/h', '2 deg/h', '3 deg/h'],
};

function targetModel(right, up, noise) {
  const word = (text) => (text.trim().endsWith('deg/h') ? text.trim().slice(0, -5).trim() : null);
  if (word(right) === null || word(up) === null) throw new Error('the bias needs the unit deg/h here');
  return `imukit: 1\nname: shots\ngyro:\n  bias: {fixed: ${word(right)} ${word(up)} 0 deg/h}\n  noise: {density: two-sided, angle_random_walk: ${noise.trim()}/sqrt(Hz)}\n`;
}

function showTarget(root) {
  const now = { right: '4 deg/h', up: '3 deg/h', noise: '0.5 deg/h', shots: 30, run: 0 };
  const scale = 16; // px per deg/h
  const drawing = svg('svg', { viewBox: '-180 -180 360 360', role: 'img', 'aria-label': 'Target', class: 'target' });
  const said = element('p', { role: 'status' }), problem = element('p', { class: 'problem', role: 'alert' });
  const place = element('div', {});

  const shoot = lastOnly(async () => {
    try {
      const model = targetModel(now.right, now.up, now.noise);
      const words = ['simulate', 'shots.yaml', '--rate', '1Hz', '--duration', `${now.shots}s`, '--no-earth', '--gyro-unit', 'deg/h', '--run', String(now.run), '-o', 'shots.csv'];
      const shots = (await bench(words, { 'shots.yaml': model })).file('shots.csv');
      const told = JSON.parse((await bench(['info', 'shots.csv', '--json'], { 'shots.csv': shots })).out).result.record.columns;
      problem.textContent = '';
      draw(csvColumns(shots), told);
      place.replaceChildren(terminalText('# shots.yaml', model, 'imukit ' + words.join(' '), 'imukit info shots.csv'));
    } catch (reason) {
      problem.textContent = reason.message;
    }
  });

  function draw(columns, told) {
    const perHour = (180 / Math.PI) * 3600; // info is in SI
    const [x, y] = ['gyro_x', 'gyro_y'].map((name) => told.find((column) => column.name === name))
      .map(({ mean, scatter }) => ({ mean: mean.value * perHour, scatter: scatter.value * perHour }));
    const shots = Array.from(columns['gyro_x [deg/h]'], (right, i) => svg('circle', { class: 'shot', r: 3.5, cx: scale * right, cy: -scale * columns['gyro_y [deg/h]'][i] }));
    const mark = (dx, dy) => svg('line', { class: 'mean', x1: scale * x.mean - dx, x2: scale * x.mean + dx, y1: -scale * y.mean - dy, y2: -scale * y.mean + dy });
    drawing.replaceChildren(
      ...[10, 8, 6, 4, 2].map((ring) => svg('circle', { class: 'ring', r: scale * ring })),
      ...[2, 6, 10].map((ring) => { const text = svg('text', { x: 3, y: -scale * ring + 12 }); text.textContent = ring; return text; }),
      ...shots, svg('ellipse', { class: 'scatter', cx: scale * x.mean, cy: -scale * y.mean, rx: scale * x.scatter, ry: scale * y.scatter }), mark(9, 0), mark(0, 9));
    said.textContent = `Accuracy: the mean is ${x.mean.toFixed(2)} deg/h to the right and ${y.mean.toFixed(2)} deg/h up of the truth. Precision: 1σ is ${x.scatter.toFixed(2)} deg/h across and ${y.scatter.toFixed(2)} deg/h along.`.replace(/-/g, '−');
  }

  const set = (key) => (text) => ((now[key] = text), shoot(), '');
  const controls = {
    right: makeSlider({ label: 'Bias to the right', text: now.right, unit: 'deg/h', minimum: -10, maximum: 10, change: set('right') }),
    up: makeSlider({ label: 'Bias up', text: now.up, unit: 'deg/h', minimum: -10, maximum: 10, change: set('up') }),
    noise: makeSlider({ label: 'Noise, 1σ of a shot', text: now.noise, unit: 'deg/h', minimum: 0, maximum: 6, change: set('noise') }),
    shots: makeSlider({ label: 'Shots', text: '30', minimum: 3, maximum: 200, change: (text) => {
      const count = Math.round(Number(text));
      if (!(count >= 3 && count <= 1000)) return 'expected 3 to 1000 shots';
      now.shots = count;
      shoot();
      return '';
    } }),
  };
  function choose([right, up, noise]) {
    Object.assign(now, { right, up, noise });
    for (const key of ['right', 'up', 'noise']) controls[key].set(now[key]);
    shoot();
  }
  root.append(element('h2', {}, 'Accuracy and precision'),
    element('p', {}, 'Accuracy is how near the mean is to the truth: a bias spoils it. Precision is how near the readings are to one another: noise spoils it. Averaging helps against noise only.'),
    element('div', { class: 'pair' }, drawing, element('div', {},
      element('div', { class: 'buttons' }, Object.entries(targetKinds).map(([name, values]) => element('button', { type: 'button', onclick: () => choose(values) }, name))),
      Object.values(controls).map(({ row }) => row),
      element('button', { type: 'button', onclick: () => (now.run++, shoot()) }, 'Shoot again'), said, problem,
      element('p', { class: 'weak' }, 'Rings: 2 deg/h apart. Dots: shots. Cross: their mean. Ellipse: 1σ.'))), place);
  shoot();
}
