// SPDX-License-Identifier: Apache-2.0
// What a reader can do with a page of --report: every number that it tells is the command's, no text
// of a file is taken for markup, and without scripts the page is whole.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { mkdirSync, mkdtempSync, readFileSync, rmSync, symlinkSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, test as unlimited } from 'node:test';
import { pathToFileURL } from 'node:url';
import { imukit } from './command.mjs';
import { Browser } from './devtools.mjs';

const scratch = mkdtempSync(join(tmpdir(), 'imukit-web-'));
const path = (name) => join(scratch, name);
const degreesPerHour = (value) => (value * 180 * 3600) / Math.PI;

/** The command, in the folder of the test. @return what it printed */
function command(...words) {
  const done = spawnSync(imukit, words, { cwd: scratch, encoding: 'utf8', env: { ...process.env, NO_COLOR: '1' } });
  assert.equal(done.status, 0, done.stderr);
  return done.stdout;
}

let browser, page, allan, other, printed;
const test = (name, act) => unlimited(name, { timeout: 20000 }, act);

before(async () => {
  // A gyro and an accelerometer: few panels are drawn quickly.
  writeFileSync(path('pair.yaml'), `imukit: 1
gyro: {direction: [1 0 0], noise: {angle_random_walk: 0.3 deg/sqrt(h), bias_instability: 4 deg/h}}
accel: {direction: [1 0 0], noise: {velocity_random_walk: 0.06 m/s/sqrt(h)}}
`);
  for (const [name, seed] of [['still.csv', '5'], ['other.csv', '6']]) command('simulate', 'pair.yaml', '--rate', '100Hz', '--duration', '1min', '--seed', seed, '-o', name);
  allan = JSON.parse(command('allan', 'still.csv', '--json')).result;
  other = command('allan', 'other.csv', '--json', '--report', 'other.html');
  writeFileSync(path('other.json'), other);
  other = JSON.parse(other).result;
  printed = command('identify', 'still.csv', '--report', 'still.html', '-o', 'still.yaml');
  browser = await Browser.open();
  await browser.send('Browser.grantPermissions', { permissions: ['clipboardReadWrite', 'clipboardSanitizedWrite'] });
  page = await browser.page(null);
  await page.send('Emulation.setFocusEmulationEnabled', { enabled: true });
}, { timeout: 30000 });
after(async () => {
  await browser.close();
  rmSync(scratch, { recursive: true });
}, { timeout: 30000 });

/** What the tests ask a page for. `at(k)`: the place of a measured point of the first panel in the
 *  window [px]; `drawn(style)`: numbers of the first curve of a style. */
const tools = `
  const panel = document.querySelector('.panel'), plot = panel.querySelector('.plot');
  const one = (selector) => document.querySelector(selector);
  const text = (selector) => [...document.querySelectorAll(selector)].map((found) => found.textContent);
  const drawn = (style) => (plot.querySelector('svg path.' + style)?.getAttribute('d') || '').match(/-?[\\d.]+/g)?.map(Number) || [];
  const at = (k) => { const d = plot.querySelector('path.points').getAttribute('d').match(/M[^h]*/g)[k].slice(1).split(' ').map(Number);
    plot.scrollIntoView({ block: 'center' }); const box = plot.querySelector('svg').getBoundingClientRect(); return { x: box.left + d[0], y: box.top + d[1] }; };
  const told = () => [...panel.querySelectorAll('.readout:not([hidden]) > *')].map((line) => line.textContent);
  const keys = () => [...panel.querySelectorAll('.key button')];
  const key = (name) => keys().find((made) => made.textContent === name);
  const look = () => plot.querySelector('svg').outerHTML.replace(/<g class="pointed">.*?<\\/g>/, '');
  const table = (k) => document.querySelectorAll('.table table')[k];
  const press = (name) => [...document.querySelectorAll('button')].find((made) => made.textContent === name).click();`;

/** Act on a report, in a page that all cases load anew: it costs less than one for each. Afterwards the
 *  console is empty and nobody was asked for anything. */
async function withReport(name, { width = 1280, height = 900, dark = false, scripts = true }, act) {
  const address = pathToFileURL(path(name)).href;
  Object.assign(page, { messages: [], requests: [] });
  await page.size(width, height);
  await page.send('Emulation.setEmulatedMedia', { features: [{ name: 'prefers-color-scheme', value: dark ? 'dark' : 'light' }] });
  await page.send('Emulation.setScriptExecutionDisabled', { value: !scripts });
  await page.go(address);
  if (scripts) await page.value(`void (window.t = (() => { ${tools} return { panel, plot, one, text, drawn, at, told, keys, key, look, table, press }; })())`);
  await act(page);
  assert.deepEqual(page.faults(), []);
  assert.deepEqual(page.requests.filter((asked) => asked !== address && !asked.startsWith('data:')), []);
}

/** Numbers of a line such as "interval: 178 to 184 deg/h", with their powers of ten. */
function numbersOf(line) {
  const digits = { '⁰': 0, '¹': 1, '²': 2, '³': 3, '⁴': 4, '⁵': 5, '⁶': 6, '⁷': 7, '⁸': 8, '⁹': 9, '⁻': '-' };
  return [...line.replace(/^[^:]*:/, '').matchAll(/(−?[\d.]+)(?:·10([⁻⁰¹²³⁴-⁹]+))?/g)]
    .map(([, value, power]) => Number(value.replace('−', '-')) * 10 ** Number(power ? [...power].map((c) => digits[c]).join('') : 0));
}

/** The readout is that of a point of `allan --json`, to the five digits that it shows. */
function assertTold(told, name, point) {
  const close = (line, ...values) => {
    const found = numbersOf(line);
    assert.equal(found.length, values.length, line);
    values.forEach((value, i) => assert.ok(Math.abs(found[i] - value) <= 6e-5 * value, `${line}: is ${value}`));
  };
  assert.equal(told[0], name);
  assert.match(told[1], /^averaging time: .* s$/);
  assert.match(told[2], /^Allan deviation: .* deg\/h$/);
  assert.match(told[3], /^interval: .* deg\/h$/);
  close(told[1], point.tau.value);
  close(told[2], degreesPerHour(point.deviation.value));
  close(told[3], degreesPerHour(point.lower.value), degreesPerHour(point.upper.value));
}

/** With keys to the first point of a curve. */
async function stepTo(page, name) {
  await page.value('t.plot.focus()');
  for (let k = 0; k < 9 && (await page.value('t.told()[0]')) !== name; k++) await page.press('ArrowUp');
  await page.press('Home');
}

test('the pointer and the arrow keys tell the numbers of --json, with their intervals', () => withReport('still.html', {}, async (page) => {
  const { points } = allan.channels[0];
  for (const k of [0, 4, points.length - 1]) {
    await page.mouse('mouseMoved', await page.value(`t.at(${k})`));
    assertTold(await page.value('t.told()'), 'log', points[k]);
  }
  await page.value(`t.plot.focus()`);
  await page.press('Home');
  assertTold(await page.value('t.told()'), 'log', points[0]);
  await page.press('ArrowRight');
  await page.press('ArrowRight');
  assertTold(await page.value('t.told()'), 'log', points[2]);
  assertTold((await page.value(`t.one('[aria-live]').textContent`)).split(', '), 'log', points[2]); // is heard
  await page.press('ArrowLeft');
  assertTold(await page.value('t.told()'), 'log', points[1]);
  await page.press('ArrowUp');
  assert.notEqual((await page.value('t.told()'))[0], 'log');
  await page.value('t.plot.blur()');
  assert.deepEqual(await page.value('t.told()'), []);
}));

test('a drag and keys zoom, and all comes back as it was', () => withReport('still.html', {}, async (page) => {
  const whole = await page.value('t.look()');
  const [from, to] = [await page.value('t.at(2)'), await page.value('t.at(6)')];
  await page.drag(from, to);
  await page.until(`t.panel.querySelector('.tools.zoomed')`);
  const { first, last, left, right } = await page.value(`(() => { const d = t.drawn('points'), frame = t.plot.querySelector('svg svg');
    return { first: d[2 * 3], last: d[6 * 3], left: frame.x.baseVal.value, right: frame.x.baseVal.value + frame.width.baseVal.value }; })()`);
  assert.ok(Math.abs(first - left) < 2 && Math.abs(last - right) < 2, `${first} ${last} are at the edges ${left} ${right}`);
  await page.value('t.plot.focus()');
  await page.press('Escape');
  await page.until(`t.look() === ${JSON.stringify(whole)}`, 2);
  const spread = `(() => { const d = t.drawn('points'); return d[d.length - 3] - d[0]; })()`, before = await page.value(spread);
  await page.press('+');
  await page.until(`t.look() !== ${JSON.stringify(whole)}`, 2);
  const factor = (await page.value(spread)) / before;
  assert.ok(Math.abs(factor - 1.5) < 0.1, `zoomed by ${factor}`); // letters beside the axis may change its length
  await page.press('-');
  await page.until(`t.look() === ${JSON.stringify(whole)}`, 2);
  await page.press('+');
  await page.value(`t.panel.querySelector('[title="Show all"]').click()`);
  await page.until(`t.look() === ${JSON.stringify(whole)}`, 2);
}));

test('a key turns a term off and on', () => withReport('still.html', {}, async (page) => {
  const whole = await page.value('t.look()');
  for (const [name, style] of [['angle random walk', 'dashes.c1'], ['log', 'points']]) {
    assert.equal(await page.value(`t.key(${JSON.stringify(name)}).getAttribute('aria-pressed')`), 'true');
    await page.value(`t.key(${JSON.stringify(name)}).click()`);
    await page.until(`t.drawn(${JSON.stringify(style)}).length === 0`, 2);
    assert.equal(await page.value(`t.key(${JSON.stringify(name)}).getAttribute('aria-pressed')`), 'false');
    await page.value(`t.key(${JSON.stringify(name)}).click()`);
    await page.until(`t.look() === ${JSON.stringify(whole)}`, 2);
  }
}));

test('a sensor of the catalogue and files are laid over; another file is refused in words', () => withReport('still.html', {}, async (page) => {
  const names = await page.value('t.keys().length');
  await page.value(`t.one('.over select').value = 'HG1700'; t.press('Add')`);
  await page.until(`t.key('HG1700')`, 2);
  await page.until(`t.drawn('over-line').length > 20`, 2);
  const { tau, noise } = await page.value(`(() => { const { tau, sensors } = JSON.parse(t.one('script.catalogue').textContent);
    return { tau, noise: sensors.find(({ name }) => name === 'HG1700')['rad/s'] }; })()`);
  await stepTo(page, 'HG1700');
  const [, atTau, deviation] = (await page.value('t.told()')).map((line) => numbersOf(line)[0]);
  assert.ok(Math.abs(deviation / degreesPerHour(noise[tau.findIndex((one) => Math.abs(one / atTau - 1) < 1e-3)]) - 1) < 1e-4, `${deviation} at ${atTau} s`);
  await page.value(`t.press('Take away')`);
  assert.equal(await page.value('t.keys().length'), names);
  for (const file of ['other.json', 'other.html']) {
    await page.choose('.over input', path(file));
    await page.until(`t.key('other')`, 2);
    await page.until(`t.plot.querySelectorAll('path.points').length > 1`, 2);
    await stepTo(page, 'other');
    assertTold(await page.value('t.told()'), 'other', other.channels[0].points[0]);
    await page.value(`t.press('Take away')`);
    await page.until(`!t.key('other')`, 2);
  }
  writeFileSync(path('no.json'), '{"command": "allan", "result": {"channels": [{"statistic": "oadev"}]}}');
  for (const file of ['still.csv', 'no.json', 'still.yaml']) {
    await page.choose('.over input', path(file));
    await page.until(`t.one('.over .problem').textContent.startsWith('${file} holds no Allan deviations')`, 2);
    assert.equal(await page.value('t.keys().length'), names);
  }
}));

test('what is laid over has a key of its own, whatever it is called', () => withReport('still.html', {}, async (page) => {
  writeFileSync(path('log.json'), readFileSync(path('other.json')));
  await page.choose('.over input', path('log.json'));
  await page.until(`t.key('log, laid over')`, 2);
  await page.value(`t.key('log').click()`);
  await page.until(`t.plot.querySelectorAll('path.points').length === 1`, 2);
}));

test('what has no logarithm is left out of what is laid over, and an open interval stays open', () => withReport('still.html', {}, async (page) => {
  const changed = structuredClone(other), [{ points }] = changed.channels;
  points[3].deviation.value = 0;
  points[4].upper.value = null;
  writeFileSync(path('odd.json'), JSON.stringify({ command: 'allan', result: changed }));
  await page.choose('.over input', path('odd.json'));
  await page.until(`t.plot.querySelectorAll('path.points').length > 1`, 2);
  assert.ok(!/NaN|Infinity/.test(await page.value('t.look()')));
  await stepTo(page, 'odd');
  for (let k = 0; k < 3; k++) await page.press('ArrowRight');
  assert.match((await page.value('t.told()'))[3], / to open deg\/h$/);
}));

test('a cell and a table are copied as they are read', () => withReport('still.html', {}, async (page) => {
  const clipboard = () => page.value('navigator.clipboard.readText()');
  const term = /^angle random walk +x +([\d.]+ ± [\d.]+) +([\d.]+ to [\d.]+) +(\S+)$/m.exec(printed);
  await page.value(`[...document.querySelectorAll('td')].find((cell) => cell.textContent === ${JSON.stringify(term[1])}).click()`);
  await page.until(`t.one('.told').textContent === ${JSON.stringify('Copied: ' + term[1])}`, 2);
  assert.equal(await clipboard(), term[1]);
  await page.value(`t.table(0).closest('.table').focus()`);
  await page.press('ArrowRight');
  await page.press('ArrowRight');
  await page.press('c', 2);
  await page.until(`t.one('.told').textContent === 'Copied: the table' || t.one('.here')`, 2);
  const here = await page.value(`t.one('.here').textContent`);
  await page.until(`t.one('.told').textContent === ${JSON.stringify('Copied: ' + here)}`, 2);
  assert.equal(await clipboard(), here);
  await page.value(`t.table(0).closest('.table').querySelector('.copy').click()`);
  await page.until(`t.one('.told').textContent === 'Copied: the table'`, 2);
  const rows = (await clipboard()).split('\n').map((row) => row.split('\t'));
  assert.deepEqual(rows.find((row) => row[0] === 'angle random walk'), ['angle random walk', 'x', ...term.slice(1)]);
  assert.ok(rows.every((row) => row.length === 5), JSON.stringify(rows));
}));

test('the page is light or dark by the system, and by its button', async () => {
  const ground = `Math.max(...getComputedStyle(t.one('main')).backgroundColor.match(/\\d+/g).map(Number))`;
  for (const dark of [false, true])
    await withReport('still.html', { dark }, async (page) => {
      for (const now of [dark, !dark, dark]) {
        assert.equal((await page.value(ground)) < 80, now);
        assert.equal(await page.value(`t.one('.theme').textContent`), now ? 'Light page' : 'Dark page');
        await page.value(`t.one('.theme').click()`);
      }
    });
});

test('a telephone has no horizontal scroll, whatever is told or laid over', () => withReport('still.html', { width: 360, height: 700 }, async (page) => {
  assert.equal(await page.overflow(), 0);
  await page.choose('.over input', path('other.json'));
  await page.until(`t.key('other')`, 2);
  await page.value('t.plot.focus()');
  await page.press('End');
  assert.equal((await page.value('t.told()')).length, 4);
  const box = await page.value(`(({ left, right }) => ({ left, right }))(t.one('.readout:not([hidden])').getBoundingClientRect())`);
  assert.ok(box.left >= 0 && box.right <= 360, JSON.stringify(box));
  assert.equal(await page.overflow(), 0);
}));

test('without scripts the page is whole', () => withReport('still.html', { scripts: false }, async (page) => {
  assert.equal(await page.value(`document.querySelectorAll('.panel:not(:has(> svg))').length`), 0);
  assert.equal(await page.value(`document.querySelectorAll('button, select, .live').length`), 0);
  const [figure, table] = await page.value(`['figure', 'table'].map((name) => document.querySelector(name).getBoundingClientRect().bottom)`);
  assert.ok(figure > 300 && figure < table, `the figure ends at ${figure}, the table at ${table}`);
  const numbersIn = (text) => text.match(/\d[\d.]*/g), shown = new Set(numbersIn(await page.value('document.body.innerText')));
  const numbers = numbersIn(printed.split('\nToo short')[0]);
  assert.ok(numbers.length > 30, `${numbers.length} numbers`);
  assert.deepEqual(numbers.filter((number) => !shown.has(number)), []);
  const dots = await page.value(`[...document.querySelectorAll('.panel')].filter((panel) => JSON.parse(panel.querySelector('script').textContent).allan)
    .map((panel) => [...panel.querySelectorAll('[clip-path] path')].pop().getAttribute('d').match(/h0/g).length)`);
  assert.deepEqual(dots, allan.channels.map(({ points }) => points.length));
}));

test('names of files and channels are text, not markup', async () => {
  const image = '<img src=x onerror="window.hit=1">', folder = 'a<';
  mkdirSync(path(folder));
  const names = [`${image}.csv`, `${folder}/script><script>window.hit=1<b.csv`];
  for (const name of names) symlinkSync(path('still.csv'), path(name));
  command('allan', ...names, '--report', 'names.html');
  command('identify', names[1], '--report', 'name.html');
  const channels = [0, 1].map(() => structuredClone(other.channels[0]));
  channels.forEach((channel, k) => (channel.name = `</script>${image}${k}`));
  writeFileSync(path(`${image}.json`), JSON.stringify({ command: 'allan', result: { channels } }));
  for (const name of ['names.html', 'name.html'])
    await withReport(name, {}, async (page) => {
      await page.choose('.over input', path(`${image}.json`));
      await page.until(`t.keys().some((made) => made.textContent.includes('</script>'))`, 2);
      await page.choose('.over input', path(names[0]));
      await page.until(`t.one('.over .problem').textContent.startsWith('<img')`, 2);
      await page.value('t.plot.focus()');
      for (let k = 0; k < 4; k++) await page.press('ArrowUp');
      assert.deepEqual(await page.value(`[document.querySelectorAll('img, b > script').length, typeof hit, document.scripts.length
        - document.querySelectorAll('script[type="application/json"]').length]`), [0, 'undefined', 1]);
      assert.ok((await page.value('document.body.innerText')).includes(name === 'names.html' ? image : '<script>window.hit=1<b.csv'));
    });
});

test('an article that is put into a page later, while hidden, or twice, behaves', () => withReport('still.html', {}, async (page) => {
  await page.value(`(() => { window.raw = new DOMParser().parseFromString(${JSON.stringify(readFileSync(path('still.html'), 'utf8'))}, 'text/html').querySelector('article');
    document.querySelector('main').replaceChildren(); document.querySelector('.imukit-page').classList.remove('imukit-page');
    window.place = document.createElement('section'); place.hidden = true; document.body.append(place);
    place.append(document.adoptNode(raw.cloneNode(true))); imukitFigures.attach(place); imukitFigures.attach(place); imukitFigures.attach(document); })()`);
  assert.equal(await page.value(`place.querySelectorAll('.plot').length`), 0);
  await page.value('place.hidden = false');
  const count = (selector) => page.value(`place.querySelectorAll(${JSON.stringify(selector)}).length`), panels = await count('.panel');
  await page.until(`place.querySelectorAll('.plot > svg').length === ${panels}`, 2);
  for (const [selector, expected] of [['.panel > svg', 0], ['.tools', panels], ['.over', 1], ['.cells', await count('.table')], ['.theme', 0]])
    assert.equal(await count(selector), expected, selector);
  assert.equal(await count('.copy'), await count('.table'));
  // A second one is shown while the first is hidden: what is told is seen.
  await page.value(`place.hidden = true; window.second = document.createElement('section'); document.body.append(second);
    second.append(document.adoptNode(raw.cloneNode(true))); imukitFigures.attach(second); second.querySelector('.copy').click()`);
  await page.until(`[...document.querySelectorAll('.told')].some((one) => one.checkVisibility() && one.textContent === 'Copied: the table')`, 2);
  // One that is attached before it is in a page, and one that has gone from it.
  await page.value(`(() => { place.remove(); second.remove(); const apart = document.createElement('section'); apart.append(document.adoptNode(raw.cloneNode(true)));
    imukitFigures.attach(apart); apart.querySelector('.over button').click(); document.body.append(apart); window.place = apart; })()`);
  await page.until(`place.querySelectorAll('.plot > svg').length === ${panels}`, 2);
  assert.equal(await page.value(`document.querySelectorAll('[aria-live]').length`), 1);
}));
