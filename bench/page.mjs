// SPDX-License-Identifier: Apache-2.0
// How fast the page is (make bench-web), in rows as those of bench.h:
//
// - frames of the instruments that run: processor time of the main thread for script, style, layout
//   and paint, from Chromium's trace [ms]; the 95th percentile and the longest;
// - from opening index.html on the disk to the first drawing, in a new Chromium [ms];
// - allan and identify on six columns of 10⁷ samples in one worker [s], the file already in memory,
//   beside the command on one thread with the file in the cache of the system; reading it apart.
//
// Chromium's processes and the system take turns on all cores, so nothing is pinned; each figure but
// those of frames is the least of several runs.
import { spawnSync } from 'node:child_process';
import { join } from 'node:path';
import { pathToFileURL } from 'node:url';
import { build, imukit, logOf } from '../web/test/command.mjs';
import { Browser } from '../web/test/devtools.mjs';

const address = pathToFileURL(join(build, 'web/index.html')).href;
const secondsOfFrames = 6, runs = 3;
const pause = (seconds) => new Promise((resolve) => setTimeout(resolve, 1000 * seconds));
const row = (name, ours, yardstick, unit) => console.log([name, ours.toPrecision(4), yardstick?.toPrecision(4) ?? '',
  yardstick ? (yardstick / ours).toPrecision(3) : '', unit, 'wasm', 1].join(','));

// ---- frames -----------------------------------------------------------------------------------

const parts = new Set(['FireAnimationFrame', 'FunctionCall', 'EvaluateScript', 'EventDispatch', 'TimerFire', 'RunMicrotasks',
  'HandlePostMessage', 'UpdateLayoutTree', 'Layout', 'PrePaint', 'Paint', 'Layerize', 'Commit', 'MinorGC', 'MajorGC']);

/** What Chromium tells of its work while `seconds` pass. */
async function traced(page, seconds) {
  const events = [];
  page.on('Tracing.dataCollected', ({ value }) => events.push(...value));
  await page.send('Tracing.start', { transferMode: 'ReportEvents', traceConfig: { includedCategories: ['devtools.timeline', 'disabled-by-default-devtools.timeline', 'v8'] } });
  await pause(seconds);
  const whole = new Promise((resolve) => page.on('Tracing.tracingComplete', resolve));
  await page.send('Tracing.end');
  await whole;
  return events;
}

/** Processor time for each frame [ms], up to its commit, of what is no part of another part. */
function frameTimes(events) {
  const drawing = events.find(({ name }) => name === 'FireAnimationFrame');
  const work = events.filter((event) => event.pid === drawing.pid && event.tid === drawing.tid && event.ph === 'X' && parts.has(event.name));
  const times = [];
  let end = 0, time = 0;
  for (const { name, ts, dur, tdur } of work.sort((one, other) => one.ts - other.ts)) {
    if (ts + dur <= end) continue;
    time += tdur / 1000;
    end = ts + dur;
    if (name !== 'Commit') continue;
    times.push(time);
    time = 0;
  }
  return times.slice(1).sort((one, other) => one - other); // the first one may have begun before
}

async function benchFrames() {
  const browser = await Browser.open();
  const page = await browser.page(address + '#instruments', { width: 1280, height: 900 });
  await page.until(`document.querySelectorAll('.gallery img').length >= 12`, 120);
  const names = await page.value(`[...document.querySelectorAll('.gallery a')].map(({ hash }) => hash)`);
  for (const name of names) {
    await page.value(`location.hash = ${JSON.stringify(name)}`);
    await page.until(`document.querySelector('.schematic') && document.querySelector('.buttons output').textContent`, 60);
    await pause(1);
    const times = frameTimes(await traced(page, secondsOfFrames));
    const called = `frame of ${name.split('/')[1]}`;
    row(`${called} (95 % of ${times.length})`, times[Math.floor(0.95 * times.length)], null, 'ms');
    row(`${called} (longest)`, times[times.length - 1], null, 'ms');
  }
  await browser.close();
}

// ---- opening ----------------------------------------------------------------------------------

async function benchOpening() {
  const times = [];
  for (let k = 0; k < runs; k++) {
    const browser = await Browser.open(), page = await browser.page();
    await page.send('Page.addScriptToEvaluateOnNewDocument', { source: `(function look() {
      if (document.querySelector('main img, main svg, main canvas')) window.drawnAt = performance.now();
      else requestAnimationFrame(look); })()` });
    await page.go(address + '#instruments');
    times.push(await page.until('window.drawnAt', 120));
    await browser.close();
  }
  row('from opening to the first drawing', Math.min(...times), null, 'ms');
}

// ---- long logs --------------------------------------------------------------------------------

/** The least time of each of these, which take turns. */
async function leastOf(...acts) {
  const times = acts.map(() => Infinity);
  for (let k = 0; k < runs; k++) for (const [i, act] of acts.entries()) times[i] = Math.min(times[i], await act());
  return times;
}

/** Seconds of the command on one thread. */
function commandTime(words, folder) {
  const begin = performance.now(), done = spawnSync(imukit, [...words, '--threads', '1'], { cwd: folder, maxBuffer: 1 << 28 });
  if (done.status !== 0) throw new Error(String(done.stderr));
  return (performance.now() - begin) / 1000;
}

/** Seconds to read a file as the worker of the page reads it: an expression. */
const readAll = `new Promise((resolve) => {
  const script = document.getElementById('worker').textContent + ';onmessage = ' + (({ data }) => {
    const begin = performance.now(), bytes = new BlobBytes(data), into = new Uint8Array(1 << 20);
    for (let at = 0; at < data.size; at += into.length) bytes.read(at, into);
    postMessage((performance.now() - begin) / 1000);
  });
  const worker = new Worker(URL.createObjectURL(new Blob([script])));
  worker.onmessage = ({ data }) => (worker.terminate(), resolve(data));
  worker.postMessage(onDisk);
})`;

async function benchLongLog() {
  const path = logOf('ten-million.npy', 'AHRS', '--rate', '100Hz', '--duration', '100000s', '--seed', '8');
  const browser = await Browser.open(), page = await browser.page(address);
  await page.until('document.documentElement.dataset.ready');
  await page.value(`document.body.append(element('input', { type: 'file', multiple: true, id: 'measured' }))`);
  await page.choose('#measured', path, path + '.columns');
  await page.value(`(async () => { const files = [...document.querySelector('#measured').files];
    window.onDisk = files.find(({ name }) => name.endsWith('.npy'));
    window.inMemory = [];
    for (const file of files) inMemory.push([file.name, new Uint8Array(await file.arrayBuffer())]); })()`);
  const pageTime = (verb) => page.value(`engine.run(['${verb}', 'ten-million.npy', '--json'], { files: inMemory })
    .then(({ code, err, milliseconds }) => { if (code) throw new Error(err); return milliseconds / 1000; })`);
  const commandOf = (verb) => commandTime([verb, 'ten-million.npy', '--json'], join(build, 'web-tests'));
  for (const verb of ['allan', 'identify'])
    row(`${verb} of 6 x 1e7 in a worker`, ...(await leastOf(() => pageTime(verb), () => commandOf(verb))), 's');
  row('reading them from the disk in a worker', ...(await leastOf(() => page.value(readAll))), null, 's');
  await browser.close();
}

console.log('name,ours,yardstick,ratio,unit,isa,threads');
await benchFrames();
await benchOpening();
await benchLongLog();
