// SPDX-License-Identifier: Apache-2.0
// What runs on and on in the page is what the command computes: an instrument has the samples of
// `imukit physics` to the last bit, a unit at rest the track of `imukit navigate` to its last digit.
import assert from 'node:assert/strict';
import { createRequire } from 'node:module';
import { test } from 'node:test';
import { byCommand, byPage, moduleFunctions } from './command.mjs';

const { LiveInstrument } = createRequire(import.meta.url)('../page/live.js');
const input = [['rate', '3 1 -2 deg/s'], ['acceleration', '0.5 0.1 1 g'], ['temperature', '30 degC']];

function command(words, files) {
  const done = byCommand(words, files);
  assert.equal(done.code, 0, done.err);
  return (name) => done.files.get(name);
}

/** Rows of a .npy of doubles. */
function table(bytes) {
  const header = 10 + bytes[8] + 256 * bytes[9];
  return new Float64Array(new Uint8Array(bytes.subarray(header)).buffer);
}

function told(answer) {
  assert.equal(answer.problem, '');
  return answer;
}

/** Outputs and signals of a run of the command, in rows as the page has them. */
function rowsOfCommand(design, rate, count) {
  const file = command(['physics', 'design.yaml', ...input.flatMap(([what, text]) => ['--' + what, text]), '--output-rate', `${rate}Hz`,
    '--duration', `${count / rate}s`, '-o', 'out.npy', '--signals', 'inside.npy'], [['design.yaml', design]]);
  const [out, inside] = [table(file('out.npy')), table(file('inside.npy'))];
  const [left, right] = [out.length / count, inside.length / count];
  return Array.from({ length: count }, (_, k) => [...out.subarray(k * left, (k + 1) * left), ...inside.subarray(k * right + 1, (k + 1) * right)]);
}

function compare(name) {
  const live = new LiveInstrument(moduleFunctions());
  const { about } = told(live.do('open', [name]));
  const changed = about.fields.find((field) => field.unit && /[1-9]/.test(field.value));
  const [group, key] = changed.path.split('.');
  const design = `imukit: 1\ninstrument: ${name}\n${group}: ${key ? `{${key}: ${changed.value}}` : changed.value}\n`;
  told(live.do('change', [design]));
  for (const pace of [about.pace, 1]) {
    const { rate } = told(live.do('pace', [pace, 1])).about;
    for (const values of input) told(live.do('expose', values));
    told(live.do('restart', []));
    const { rows, width } = live.do('step', [1]), count = rows.length / width;
    assert.ok(count >= 50);
    rowsOfCommand(design, rate, count).forEach((row, k) => assert.deepEqual([...rows.subarray(k * width, (k + 1) * width)], row, `${name}, row ${k}`));
  }
}

const names = JSON.parse(byPage(['physics', '--json']).out).result.instruments.map(({ name }) => name);
test('all instruments that run have the samples of physics', () => {
  assert.ok(names.length >= 12);
  names.forEach(compare);
});

test('what is refused changes nothing', () => {
  const live = new LiveInstrument(moduleFunctions());
  told(live.do('open', ['ring_laser']));
  for (const text of ['', 'imukit: [', 'imukit: 1\ninstrument: tuning_fork\n', 'imukit: 1\ninstrument: ring_laser\ndither: {frequency: -1 Hz}\n'])
    assert.match(live.do('change', [text]).problem, /expected/);
  for (const [what, text] of [['rate', '1 2 deg/s'], ['rate', '1 g'], ['temperature', '-300 degC'], ['acceleration', '1e9 g']])
    assert.match(live.do('expose', [what, text]).problem, /expected/);
  for (const pace of [0, -1, NaN, Infinity]) assert.notEqual(live.do('pace', [pace, 1]).problem, '');
  assert.equal(live.do('look', []).about.fields.find(({ path }) => path === 'dither.frequency').value, '517 Hz');
});

for (const [unit, heading, duration] of [['tactical', 0, '1h'], ['control', -120, '10min']])
  test(`a ${unit} unit at rest has the track of navigate`, () => {
    const simulate = (name) => command(['simulate', unit, '--rate', '10Hz', '--duration', duration, '-o', name])(name);
    const written = command(['navigate', 'rest.csv', '--position', '45 deg, 10 deg, 0 m', '--attitude', `0 0 ${heading} deg`, '--interval', '6s', '-o', 'track.csv'],
      [['rest.csv', simulate('rest.csv')]])('track.csv').toString();
    const [head, ...lines] = written.trimEnd().split('\n');
    const columns = ['time [s]', 'north [m]', 'east [m]', 'yaw [deg]'].map((name) => head.split(',').indexOf(name));
    const { track } = new LiveInstrument(moduleFunctions()).do('reckon', [new Uint8Array(simulate('rest.npy')), heading, 60]);
    assert.ok(track.length >= 400);
    for (let row = 0; row < track.length / 4; row++)
      columns.forEach((column, c) => {
        const text = lines[row].split(',')[column], digits = (text.split('.')[1] || '').length;
        assert.ok(Math.abs(track[4 * row + c] - Number(text)) <= 0.51 * 10 ** -digits, `row ${row}: ${track[4 * row + c]} and ${text}`);
      });
  });
