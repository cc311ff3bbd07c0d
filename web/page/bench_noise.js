// SPDX-License-Identifier: Apache-2.0
// The four kinds of noise of the lecture, each alone: seen against time, as Allan deviation, and
// heard. 8000 samples a second are what a loudspeaker needs.

'use strict';

const noiseKinds = [
  { name: 'White noise', model: 'gyro:\n  noise: {angle_random_walk: 0.3 deg/sqrt(h)}',
    text: 'Each sample is new. A hiss; averaging over n samples makes it √n smaller (slope −1/2).' },
  { name: 'Quantization', model: 'gyro:\n  resolution: 1 deg/s',
    motion: 'imukit_motion: 1\nearth: no\nsteps:\n  - swing x 1 deg at 1 Hz for 4 s\n',
    text: 'A gyro that swings reads only whole steps of its converter. The swing is too slow to be heard; what clicks are the steps.' },
  { name: 'Flicker noise', model: 'gyro:\n  noise: {bias_instability: 5 deg/h}',
    text: 'Bias instability, 1/f: the slower, the stronger. A rumble; averaging does not help (slope 0).' },
  { name: 'Coloured noise', model: 'gyro:\n  noise:\n    gauss_markov: [{sigma: 10 deg/h, correlation_time: 50 ms}]',
    text: 'A Gauss–Markov process remembers for its correlation time, here 50 ms. Seen for less than that, it is a random walk (slope +1/2); for longer, white noise (slope −1/2).' },
];

/** One sound at a time, modest, and only after a button was pressed. */
const loudspeaker = {
  play(samples, rate, button) {
    const same = this.button === button;
    this.stop();
    if (same) return;
    this.context ||= new AudioContext();
    this.context.resume();
    const buffer = this.context.createBuffer(1, samples.length, rate), gain = this.context.createGain();
    const limits = samples.reduce(([low, high], value) => [Math.min(low, value), Math.max(high, value)], [Infinity, -Infinity]);
    const middle = (limits[0] + limits[1]) / 2, reach = (limits[1] - limits[0]) / 2 || 1;
    buffer.copyToChannel(Float32Array.from(samples, (value) => (value - middle) / reach), 0);
    const source = this.context.createBufferSource(), end = samples.length / rate, now = this.context.currentTime;
    source.buffer = buffer;
    gain.gain.setValueAtTime(0, now);
    for (const [value, at] of [[0.25, 0.1], [0.25, end - 0.1], [0, end]]) gain.gain.linearRampToValueAtTime(value, now + at);
    source.connect(gain).connect(this.context.destination);
    source.onended = () => this.source === source && this.stop();
    source.start();
    Object.assign(this, { source, button });
    button.textContent = 'Stop';
  },
  stop() {
    if (this.button) this.button.textContent = 'Listen';
    if (this.source) this.source.stop();
    this.source = this.button = null;
  },
};

function showNoises(root) {
  const list = element('div', { class: 'noises' });
  root.append(element('h2', {}, 'Four kinds of noise'),
    element('p', {}, 'Each card is a simulated gyro with one error and no other: four seconds of it, its Allan deviation, and its sound. All are made equally loud.'), list);
  let ended = false;
  (async () => {
    for (const kind of noiseKinds) if (!ended) await showNoise(list, kind);
  })();
  return () => {
    ended = true;
    loudspeaker.stop();
  };
}

async function showNoise(list, { name, model, motion, text }) {
  const status = element('p', { role: 'status' }, 'Simulating…');
  const card = element('section', { class: 'noise', 'aria-label': name }, element('h3', {}, name), status);
  list.append(card);
  try {
    const words = ['simulate', 'noise.yaml', '--rate', '8kHz', ...(motion ? ['--motion', 'swing.yaml'] : ['--duration', '4s', '--no-earth', '--gyro-unit', 'deg/h']), '-o', 'noise.csv'];
    const seconds = ['allan', 'noise.csv', '--map', 'time=time,gyro_x=gyro_x', '--json'];
    const files = { 'noise.yaml': 'imukit: 1\n' + model + '\n', ...(motion && { 'swing.yaml': motion }) };
    const log = (await bench(words, files)).file('noise.csv');
    const points = JSON.parse((await bench(seconds, { 'noise.csv': log })).out).result.channels[0].points;
    const unit = motion ? 'deg/s' : 'deg/h', columns = csvColumns(log);
    const samples = columns[`gyro_x [${unit}]`];
    const button = element('button', { type: 'button', 'aria-label': undefined, onclick: () => loudspeaker.play(samples, 8000, button) }, 'Listen');
    status.replaceWith(drawTrace(samples, unit, name), button, drawAllan(points, name), element('p', {}, text),
      terminalText(...Object.entries(files).flatMap(([file, content]) => ['# ' + file, content]), 'imukit ' + words.join(' '), 'imukit ' + seconds.slice(0, 4).join(' ')));
  } catch (reason) {
    status.textContent = reason.message;
  }
}

/** Samples against time: of each column of pixels the least and the largest. */
function drawTrace(samples, unit, name) {
  const width = 280, height = 90, left = 44;
  let low = Infinity, high = -Infinity;
  for (const value of samples) (low = Math.min(low, value)), (high = Math.max(high, value));
  const y = (value) => 6 + (height - 12) * (high > low ? (high - value) / (high - low) : 0.5);
  let path = '', step = samples.length / (width - left);
  for (let column = 0; column < width - left; column++) {
    let least = Infinity, most = -Infinity;
    for (let i = Math.floor(column * step); i < Math.min((column + 1) * step, samples.length); i++) (least = Math.min(least, samples[i])), (most = Math.max(most, samples[i]));
    path += `${column ? 'L' : 'M'}${left + column} ${y(most).toFixed(1)}L${left + column} ${y(least).toFixed(1)}`;
  }
  const label = (value, at) => { const text = svg('text', { x: left - 4, y: at, 'text-anchor': 'end' }); text.textContent = threeDigits(value).replace('-', '−'); return text; };
  return element('figure', {}, svg('svg', { viewBox: `0 0 ${width} ${height}`, role: 'img', 'aria-label': `${name}: 4 s of samples from ${shownNumber(low)} to ${shownNumber(high)} ${unit}` },
    label(high, 12), label(low, height - 3), svg('path', { class: 'one', d: path })), element('figcaption', { class: 'weak' }, `rate [${unit}] in 4 s`));
}

/** Allan deviation, a decade as wide as high. */
function drawAllan(points, name) {
  const shown = points.filter(({ deviation }) => deviation.value > 0);
  const logs = shown.map(({ tau, deviation }) => [Math.log10(tau.value), Math.log10(deviation.value)]);
  const left = 44, decade = 54, width = 280, height = 200;
  const middle = (Math.max(...logs.map(([, d]) => d)) + Math.min(...logs.map(([, d]) => d))) / 2;
  const x = (tau) => left + decade * (tau + 4), y = (d) => (height - 20) / 2 - decade * (d - middle);
  const text = (content, at) => { const made = svg('text', at); made.textContent = content; return made; };
  const grid = [-4, -3, -2, -1, 0].map((tau) => [svg('line', { class: 'grid', x1: x(tau), x2: x(tau), y1: 4, y2: height - 20 }),
    text(['0.1 ms', '1 ms', '10 ms', '0.1 s', '1 s'][tau + 4], { x: x(tau), y: height - 5, 'text-anchor': 'middle' })]);
  return element('figure', {}, svg('svg', { viewBox: `0 0 ${width} ${height}`, role: 'img', 'aria-label': `${name}: Allan deviation against averaging time` },
    grid, svg('path', { class: 'two', d: 'M' + logs.map(([tau, d]) => `${x(tau).toFixed(1)} ${y(d).toFixed(1)}`).join('L') }),
    logs.map(([tau, d]) => svg('circle', { class: 'point', r: 2.5, cx: x(tau), cy: y(d) }))),
  element('figcaption', { class: 'weak' }, 'Allan deviation, decades, against averaging time'));
}
