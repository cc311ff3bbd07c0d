// SPDX-License-Identifier: Apache-2.0
// Five grades navigate side by side for an hour: a unit at rest of each, simulated by the verb and
// navigated as by the verb. Where they believe to be is drawn on one map.

'use strict';

const gradeNames = ['strategic', 'navigation', 'tactical', 'AHRS', 'control'];

function distanceText(metres) {
  return metres < 1000 ? `${threeDigits(metres)} m` : `${Number((metres / 1000).toPrecision(3)).toLocaleString('en').replace(',', '\u202f')} km`;
}

/** Radius on the map [px] for a distance [m]. With `all`, a ring is a power of ten; else the map
 *  grows with one grade. */
function mapScale(all, farthest) {
  if (all) return { radius: (metres) => (metres <= 0.1 ? 0 : Math.min(170, 21 * (Math.log10(metres) + 1))), rings: [1, 10, 100, 1e3, 1e4, 1e5, 1e6, 1e7] };
  const reach = Math.max(farthest, 1), power = 10 ** Math.floor(Math.log10(reach)), step = [1, 2, 5, 10].find((digit) => digit * power >= reach / 2) * power;
  return { radius: (metres) => (150 * metres) / reach, rings: [step / 2, step, 2 * step] };
}

function showGrades(root) {
  const now = { tracks: [], run: 0, follow: 'all', ended: false };
  const map = svg('svg', { viewBox: '-200 -180 400 360', role: 'img', 'aria-label': 'Map of where each unit believes to be; north is up', class: 'map' });
  const rings = svg('g', {}), lines = svg('g', {});
  map.append(rings, lines);
  const cells = gradeNames.map(() => element('td', { class: 'number' }, '–'));
  const status = element('p', { role: 'status' }), button = element('button', { type: 'button', class: 'main', disabled: true }, 'Play');
  const clock = element('output', { class: 'number' });
  const replay = new Replay({ seconds: 10, draw, button, name: 'Play an hour in ten seconds' });
  const follow = element('select', { id: 'follow', onchange: () => ((now.follow = follow.value), draw(replay.passed)) },
    element('option', { value: 'all' }, 'all: each ring is ten times farther'), gradeNames.map((name) => element('option', { value: name }, `grows with ${name}`)));
  const simulate = (name) => ['simulate', name, '--rate', '10Hz', '--duration', '1h', '--run', String(now.run), '-o', 'rest.npy'];
  const navigate = ['navigate', 'rest.csv', '--position', '45 deg, 10 deg, 0 m', '--attitude', '0 0 0 deg', '--interval', '6s', '-o', 'track.csv'];

  const compute = lastOnly(async () => {
    replay.pause();
    button.disabled = true;
    const tracks = [];
    try {
      for (const name of gradeNames) {
        if (now.ended) return;
        status.textContent = `Navigating: ${name}…`;
        const log = (await bench(simulate(name))).file('rest.npy');
        tracks.push(await reckon(log, 0, 60));
      }
      now.tracks = tracks;
      status.textContent = '';
      button.disabled = false;
      replay.passed = 0;
      draw(0);
    } catch (reason) {
      status.textContent = reason.message;
    }
  });

  function draw(passed) {
    if (!now.tracks.length) return;
    const count = now.tracks[0].time.length, end = Math.round(passed * (count - 1));
    const far = now.tracks.map((track) => Math.hypot(track.north[end], track.east[end]));
    const followed = now.tracks[gradeNames.indexOf(now.follow)];
    let farthest = 0;
    if (followed) for (let k = 0; k <= end; k++) farthest = Math.max(farthest, Math.hypot(followed.north[k], followed.east[k]));
    const { radius, rings: distances } = mapScale(!followed, farthest);
    rings.replaceChildren(...distances.flatMap((metres) => {
      const text = svg('text', { x: 3, y: -radius(metres) - 3 });
      text.textContent = distanceText(metres);
      return [svg('circle', { class: 'ring', r: radius(metres) }), text];
    }));
    lines.replaceChildren(...now.tracks.flatMap((track, g) => drawTrack(track, g, end, radius)));
    cells.forEach((cell, g) => (cell.textContent = distanceText(far[g])));
    clock.textContent = `${((60 * end) / (count - 1)).toFixed(0)} min`;
  }

  function drawTrack(track, g, end, radius) {
    const north = track.north, east = track.east;
    let path = 'M0 0', x = 0, y = 0;
    for (let k = 0; k <= end; k++) {
      const metres = Math.hypot(north[k], east[k]), r = metres > 0 ? Math.min(radius(metres), 2000) / metres : 0;
      x = r * east[k];
      y = -r * north[k];
      path += `L${x.toFixed(1)} ${y.toFixed(1)}`;
    }
    const label = svg('text', { x: x + (x < 0 ? -7 : 7), y: y + 4, class: `grade g${g}`, 'text-anchor': x < 0 ? 'end' : 'start' });
    label.textContent = gradeNames[g];
    return [svg('path', { class: `track g${g}`, d: path }), svg('circle', { class: `g${g}`, r: 4, cx: x, cy: y }), label];
  }

  root.append(element('h2', {}, 'Five grades, one hour'),
    element('p', {}, 'Five units stand at the same place and know where they are, how they lie and that they are at rest. Then each navigates by its own gyros and accelerometers alone. What they believe to have travelled is their error.'),
    element('div', { class: 'pair' }, map, element('div', {},
      element('div', { class: 'buttons' }, button, element('button', { type: 'button', onclick: () => (now.run++, compute()) }, 'Other units'), clock),
      element('div', { class: 'slider wide' }, element('label', { for: 'follow' }, 'Scale of the map'), follow), status,
      element('table', {}, element('thead', {}, element('tr', {}, element('th', { scope: 'col' }, 'grade'), element('th', { scope: 'col' }, 'from the truth'))),
        element('tbody', {}, gradeNames.map((name, g) => element('tr', {}, element('th', { scope: 'row', class: `g${g}` }, name), cells[g])))))),
    terminalText(...gradeNames.slice(0, 1).map((name) => 'imukit ' + simulate(name).join(' ').replace('.npy', '.csv')), 'imukit ' + navigate.map((word) => (word.includes(' ') ? `"${word}"` : word)).join(' '), '# and so for navigation, tactical, AHRS and control; how far off on the average: imukit drift strategic navigation tactical AHRS control --duration 1h'));
  compute();
  return () => {
    now.ended = true;
    replay.pause();
  };
}
