// SPDX-License-Identifier: Apache-2.0
// A bias that is turned on and off while a unit at rest navigates: the heading runs away and stays.
// Each stretch between two switches is simulated by the verb and navigated as by the verb, from the
// heading that the last one had.

'use strict';

function showHeading(root) {
  const pace = 30, stretch = 600; // simulated seconds for each on the screen; of a stretch
  const now = { on: true, size: '60 deg/h', from: 0, at: 0, run: 0, heading: 0, yaw: null, screen: 0, playing: false, hold: false };
  const needle = svg('g', {}, svg('path', { class: 'needle', d: 'M0 -78L7 10L0 0L-7 10Z' }));
  const letters = [['N', 0, -88], ['E', 92, 5], ['S', 0, 99], ['W', -92, 5]].map(([letter, x, y]) => { const text = svg('text', { x, y, 'text-anchor': 'middle' }); text.textContent = letter; return text; });
  const compass = svg('svg', { viewBox: '-110 -110 220 220', role: 'img', 'aria-label': 'Compass: the heading that the unit believes; the truth is north', class: 'compass' },
    svg('circle', { class: 'ring', r: 80 }), letters, needle);
  const chart = new StripChart({ label: 'Heading against time', unit: 'deg', names: ['heading', 'truth'], seconds: 20 });
  const problem = element('p', { class: 'problem', role: 'alert' });
  const said = element('output', { class: 'number' }, '0.00'), clock = element('output', { class: 'number' }, '0.0');
  const play = element('button', { type: 'button', class: 'main', onclick: () => (now.playing ? pause() : start()) }, 'Play');
  const toggle = element('button', { type: 'button', 'aria-pressed': 'true', onclick: () => change(() => (now.on = !now.on)) }, 'Bias');
  const place = element('div', {});

  function model() {
    return `imukit: 1\nname: heading\ngyro:\n${now.on ? `  bias: {fixed: 0 0 ${now.size}}\n` : ''}  noise: {angle_random_walk: 0.3 deg/sqrt(h)}\naccel: {}\n`;
  }
  /** What follows from the present heading on. */
  const compute = lastOnly(async () => {
    now.hold = true; // the clock stands until it is known how the heading goes on
    const simulate = ['simulate', 'heading.yaml', '--rate', '10Hz', '--duration', `${stretch}s`, '--run', String(now.run), '-o', 'rest.npy'];
    const navigate = ['navigate', 'rest.csv', '--position', '45 deg, 10 deg, 0 m', '--attitude', `0 0 ${now.heading.toFixed(6)} deg`, '--interval', '1s', '-o', 'track.csv'];
    try {
      const log = (await bench(simulate, { 'heading.yaml': model() })).file('rest.npy');
      Object.assign(now, { yaw: (await reckon(log, now.heading, 10)).heading, from: now.at });
      now.run++;
      problem.textContent = '';
      place.replaceChildren(terminalText('# heading.yaml', model(), 'imukit ' + simulate.join(' ').replace('.npy', '.csv'), 'imukit ' + navigate.map((word) => (word.includes(' ') ? `"${word}"` : word)).join(' ')));
    } catch (reason) {
      problem.textContent = reason.message;
    }
    now.hold = false;
  });
  function change(act) {
    act();
    toggle.setAttribute('aria-pressed', String(now.on));
    toggle.textContent = now.on ? 'Bias is on: turn it off' : 'Bias is off: turn it on';
    return compute();
  }
  function start() {
    now.playing = true;
    play.textContent = 'Pause';
    now.last = null;
    requestAnimationFrame(frame);
  }
  function pause() {
    now.playing = false;
    play.textContent = 'Play';
  }
  function frame(time) {
    if (!now.playing) return;
    requestAnimationFrame(frame);
    const passed = now.last === null ? 0 : Math.min(time - now.last, 100) / 1000;
    now.last = time;
    if (!now.yaw || now.hold) return;
    now.at += pace * passed;
    now.screen += passed;
    const row = Math.min(Math.floor(now.at - now.from), now.yaw.length - 1);
    if (row === now.yaw.length - 1) {
      now.yaw = null;
      compute();
      return;
    }
    now.heading = now.yaw[row];
    chart.add(now.screen, now.heading, 0);
    chart.draw();
    needle.setAttribute('transform', `rotate(${now.heading})`);
    if (time - (now.told || 0) < 200) return;
    now.told = time;
    said.textContent = now.heading.toFixed(2).replace('-', '−');
    clock.textContent = (now.at / 60).toFixed(1);
  }
  const size = makeSlider({ label: 'Bias of the vertical gyro', text: now.size, unit: 'deg/h', minimum: -300, maximum: 300, change: (text) => (change(() => (now.size = text)), '') });
  root.append(element('h2', {}, 'A bias turned on and off'),
    element('p', {}, 'A unit stands still and points north. Its vertical gyro has a bias, and the heading it computes runs away with the time. Without the bias, white noise alone makes the heading wander.'),
    element('div', { class: 'pair' }, compass, element('div', {},
      element('div', { class: 'buttons' }, play, toggle), size.row,
      element('p', {}, 'Heading ', said, ' deg after ', clock, ' min (half a minute each second)'), chart.root, problem)), place);
  change(() => {});
  return () => {
    pause();
    chart.end();
  };
}
