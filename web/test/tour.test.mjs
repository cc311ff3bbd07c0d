// SPDX-License-Identifier: Apache-2.0
// The tour: every exercise's command works in the module, and its number is there, in the unit asked
// for, and what a closed form says; every figure is made with the controls at first and at their ends.
//
//     IMUKIT_WASM=imukit.wasm node --test web/test/tour.test.mjs
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import { test } from 'node:test';

const require = createRequire(import.meta.url);
const { PageSystem } = require('../page/wasi.js');
const { tourSubjects } = require('../page/tour/subjects.js');
const { parseEquation } = require('../page/tour/equation.js');
const { filled, judged, placeOfValue, quantityAt, quantityText, runCommands, unitSizes, wordsOf } = require('../page/tour/answer.js');

const wasm = new WebAssembly.Module(readFileSync(process.env.IMUKIT_WASM || new URL('../../build/web-objects/imukit.wasm', import.meta.url)));

/** As Engine.run(), here. */
async function run(words, { files }) {
  const system = new PageSystem({ words: ['imukit', ...words], files: new Map(files) });
  const { exports } = await WebAssembly.instantiate(wasm, system.imports);
  const code = system.run(exports);
  const given = new Set(files.map(([name]) => name));
  const made = [...system.files.keys()].filter((name) => !given.has(name)).map((name) => [name, system.file(name)]);
  return { code, out: system.text(1), err: system.text(2), files: made };
}

const { PI, sqrt, sin } = Math, degree = PI / 180, g = 9.80665, light = 299792458;
/** The answers [SI] by closed forms of the numbers in the questions. */
const closedForms = [
  15.041067 * degree / 3600 * sin(45 * degree),
  4.2e-5 * 22550 / 60 * 2 * PI,
  0.0992 * 7.292115e-5,
  1550e-9 * light / (2 * 1000 * 0.32),
  sqrt(720 ** 2 - 360 ** 2) * degree / 3600,
  2 * 5e-6 * 2 * PI * 14000,
  14000 / (2 * 1000),
  9.806 * sin(30 * degree),
  0.001 / 0.08,
  9.806 * degree / 3600 * 60 ** 3 / 6,
  500e-6 * 2 * PI,
  (0.012 + 0.008) / 2,
  0.3 * degree * sqrt(4 / 60),
  0.03 * 30e-9 / 0.001,
  -((300 * degree) ** 2) * 0.02,
  (0.2 + 0.005 * 100) * degree,
  sqrt(0.006 ** 2 + 0.003 ** 2) * degree / 3600,
];

test('there are 17 subjects with texts of 100 to 160 words', () => {
  assert.equal(tourSubjects.length, 17);
  for (const { title, text } of tourSubjects) {
    const words = text.join(' ').split(/\s+/).length;
    assert.ok(words >= 100 && words <= 160, `${title}: ${words} words`);
  }
});

test('each equation is read to its end', () => {
  const letters = ([, content]) => (typeof content === 'string' ? content : content.map(letters).join(''));
  const plain = (text) => text.replace(/matrix|[\s()_^/√,;]/g, '').replace(/-/g, '−').normalize('NFD').replace(/\u20d7/g, '→').replace(/\u0303/g, '~');
  for (const { equations } of tourSubjects)
    for (const text of equations) assert.equal(plain(letters(['mrow', parseEquation(text)])), plain(text), text);
  assert.deepEqual(parseEquation('(a b)/c_2'), [['mfrac', [['mrow', [['mi', 'a'], ['mi', 'b']]], ['msub', [['mi', 'c'], ['mn', '2', { mathvariant: 'normal' }]]]]]]);
});

tourSubjects.forEach(({ title, exercise }, i) => test(`exercise ${i + 1}, ${title}`, async () => {
  const { out } = await runCommands(run, exercise.run, exercise.files);
  const quantity = { ...quantityAt(JSON.parse(out), exercise.path), asked: exercise.unit };
  assert.ok(Number.isFinite(quantity.value) && quantity.value !== 0);
  assert.ok(exercise.unit in unitSizes[quantity.unit], `${quantity.unit} is not ${exercise.unit}`);
  assert.ok(exercise.question.includes(`in ${exercise.unit}`), 'the question names the unit');
  const expected = closedForms[i];
  assert.ok(Math.abs(quantity.value - expected) < exercise.tolerance * Math.abs(expected), `${quantity.value}, by hand ${expected}`);
  // What the page shows as the answer is one, and the place that it marks holds the number.
  assert.ok(judged(quantityText(quantity), quantity, exercise.tolerance).right);
  assert.equal(parseFloat(out.slice(placeOfValue(out, exercise.path, quantity.value))), quantity.value);
}));

const inputs = ['rate', 'acceleration', 'instrument'];
/** Values of the controls at first, and with one after the other at its ends. */
function settings(controls) {
  const first = Object.fromEntries(controls.map(({ name, value }) => [name, value]));
  const ends = (control) => (control.choices ? control.choices.split('|') : [control.minimum, control.maximum].map((end) => `${end} ${control.unit}`));
  return [first, ...controls.flatMap((control) => ends(control).map((end) => ({ ...first, [control.name]: end })))];
}

tourSubjects.filter(({ figure }) => figure.run).forEach(({ title, figure }) => test(`figure of ${title}`, async () => {
  const made = new Map();
  for (const values of settings(figure.controls)) {
    const files = Object.fromEntries(Object.entries(figure.files || {}).map(([name, text]) => [name, filled(text, values)]));
    const lines = figure.run.map((line) => filled(line, values)), key = JSON.stringify([lines, files]);
    if (!made.has(key)) made.set(key, await runCommands(run, lines, files));
    const done = made.get(key);
    const text = (name) => new TextDecoder().decode(done.files.get(name));
    if (figure.animation) assert.match(text('figure.svg'), /<path/);
    else if (figure.readings) assert.match(done.out, /\n3,.*,-9\.806/);
    else assert.ok(text('report.html').includes(`aria-label="${filled(figure.show, values)}`));
  }
}));

tourSubjects.filter(({ figure }) => figure.live).forEach(({ title, figure }) => test(`instrument of ${title}`, async () => {
  for (const name of Object.values(figure.names || { only: figure.live }))
    for (const values of settings(figure.controls)) {
      const design = Object.entries(values).filter(([path]) => !inputs.includes(path)).map(([path, text]) => {
        const [group, key] = path.split('.');
        return key ? `${group}: {${key}: ${text}}\n` : `${group}: ${text}\n`;
      });
      const words = ['physics', 'mine.yaml', '--output-rate', '1kHz', '--duration', '2ms'];
      for (const option of inputs) if (option !== 'instrument' && values[option]) words.push('--' + option, values[option]);
      const { code, out, err } = await run(words, { files: [['mine.yaml', new TextEncoder().encode(`imukit: 1\ninstrument: ${name}\n${design.join('')}`)]] });
      assert.equal(code, 0, err);
      assert.doesNotMatch(out, /nan/i);
    }
}));

test('answers need a number and its unit', () => {
  const rate = { value: degree / 3600, unit: 'rad/s', asked: 'deg/h' };
  assert.ok(judged('1 deg/h', rate, 0.01).right);
  assert.ok(judged(' 1,005 °/h ', rate, 0.01).right);
  assert.ok(judged('4.848e-6 rad/s', rate, 0.01).right);
  assert.ok(judged('2.78×10^-4 deg/s', rate, 0.01).right);
  assert.match(judged('1', rate, 0.01).say, /unit is missing/);
  assert.match(judged('one', rate, 0.01).say, /number/);
  assert.match(judged('1 m', rate, 0.01).say, /unit must be/);
  assert.match(judged('−1 deg/h', rate, 0.01).say, /sign/);
  assert.match(judged('2 deg/h', rate, 0.01).say, /Too large/);
  assert.match(judged('0.98 deg/h', rate, 0.01).say, /Too small/);
  assert.ok(judged('0.548 m/s²', { value: 0.548, unit: 'm/s^2', asked: 'm/s^2' }, 0.01).right);
  assert.ok(judged('7.23 µN·m', { value: 7.23e-6, unit: 'N*m', asked: 'uN m' }, 0.01).right);
  assert.deepEqual(wordsOf('a "b c" --d'), ['a', 'b c', '--d']);
});
