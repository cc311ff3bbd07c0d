// SPDX-License-Identifier: Apache-2.0
// Instruments and bench in Chromium: they run, stand still for readers who want it so, go on after
// mistakes and quick changes, and fit a telephone.
//
//     node --test web/test/instruments.test.mjs
import assert from 'node:assert/strict';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { pathToFileURL } from 'node:url';
import { build } from './command.mjs';
import { Browser } from './devtools.mjs';

const address = pathToFileURL(join(build, 'web/index.html')).href;
let browser;
before(async () => {
  browser = await Browser.open();
});
after(() => browser.close());

const clock = `document.querySelector('.buttons output').textContent`;
const set = (selector, value, event) => `(() => { const field = document.querySelector(${JSON.stringify(selector)});
  field.value = ${JSON.stringify(value)}; field.dispatchEvent(new Event(${JSON.stringify(event)})); return true; })()`;
/** It moves: the time of the run changes, and so does the drawing. */
async function runs(page) {
  const drawn = `[...document.querySelector('.schematic').shadowRoot.querySelectorAll('.part')].map((part) => part.getAttribute('transform') + part.style.cssText).join()`;
  const before = await page.value(clock), place = await page.value(drawn);
  await page.until(`${clock} !== ${JSON.stringify(before)}`);
  await page.until(`${drawn} !== ${JSON.stringify(place)}`);
}

test('instruments run, refuse what is wrong and go on', async () => {
  const page = await browser.page(address + '#instruments', { width: 360 });
  await page.until(`document.querySelectorAll('.gallery img').length === 12`, 60);
  assert.ok((await page.overflow()) <= 0, 'the gallery is wider than a telephone');
  await page.value(`location.hash = '#instruments/ring_laser'`);
  await page.value(`location.hash = '#instruments/free_gyro'`);
  await page.value(`location.hash = '#instruments/tuning_fork'`);
  await page.until(`document.querySelector('h1')?.textContent === 'Tuning fork gyro'`);
  await page.until(`document.querySelector('.schematic')`);
  await runs(page);
  assert.ok((await page.overflow()) <= 0, 'an instrument is wider than a telephone');
  // Refused, with a reason; and it goes on with what was valid.
  await page.value(set('input[aria-label^="Angular rate"]', '1e30 deg/s', 'change'));
  await page.until(`/1e6 rad\\/s/.test([...document.querySelectorAll('.problem')].map((one) => one.textContent).join())`);
  await page.value(set('.all input', 'nonsense', 'change'));
  await page.until(`/does not start with a number/.test([...document.querySelectorAll('.problem')].map((one) => one.textContent).join())`);
  await runs(page);
  // A valid change, and its line for the terminal.
  await page.value(set('input[aria-label^="Angular rate"]', '20 deg/s', 'change'));
  await page.until(`document.querySelector('pre').textContent.includes('--rate "20 deg/s"')`);
  // By keys.
  await page.value(`document.querySelector('#pace').focus()`);
  const pace = await page.value(`document.querySelector('#pace').getAttribute('aria-valuetext')`);
  await page.press('ArrowRight');
  await page.until(`document.querySelector('#pace').getAttribute('aria-valuetext') !== ${JSON.stringify(pace)}`);
  assert.deepEqual(page.faults(), []);
  assert.deepEqual(page.strangers(), []);
  await page.close();
});

test('an instrument stands still for readers who want reduced motion', async () => {
  const page = await browser.page(address + '#instruments/rate_gyro', { still: true, dark: true });
  await page.until(`document.querySelector('.schematic') && ${clock} !== ''`, 60);
  const before = await page.value(clock);
  await new Promise((done) => setTimeout(done, 400));
  assert.equal(await page.value(clock), before, 'it runs although the reader wants reduced motion');
  await page.click('.buttons button');
  await runs(page);
  assert.deepEqual(page.faults(), []);
  await page.close();
});

test('the bench shoots, drifts, navigates and sounds', async () => {
  const page = await browser.page(address + '#bench', { width: 360 });
  await page.until(`document.querySelectorAll('.target .shot').length === 30`, 60);
  await page.until(`/Accuracy: the mean is [−0-9.]+ deg/.test(document.body.innerText)`);
  await page.until(`document.querySelectorAll('.noise button').length === 4`, 60);
  await page.until(`[...document.querySelectorAll('button')].some((one) => /hour/.test(one.textContent) && !one.disabled)`, 60);
  await page.value(`[...document.querySelectorAll('button')].filter((one) => /^Play/.test(one.textContent)).forEach((one) => one.click())`);
  await page.until(`document.querySelectorAll('.map .track').length === 5 && /[0-9] m/.test(document.querySelector('.bench table').innerText)`);
  await page.until(`Number(document.querySelector('.bench p .number').textContent) > 0`);
  await page.click('.noise button');
  await page.until(`document.querySelector('.noise button').textContent === 'Stop' && loudspeaker.context.currentTime > 0.2`);
  await page.click('.noise button');
  await page.until(`document.querySelector('.noise button').textContent === 'Listen'`);
  await page.value(set('input[aria-label^="Bias of"]', '5 apples', 'change'));
  await page.until(`/unit/.test([...document.querySelectorAll('.problem')].map((one) => one.textContent).join())`);
  assert.ok((await page.overflow()) <= 0, 'the bench is wider than a telephone');
  assert.deepEqual(page.faults(), []);
  await page.close();
});
