// SPDX-License-Identifier: Apache-2.0
// The page in a browser, from a file of the disk: every screen, every format, and what can go wrong.
//
//     node --test web/test/page.test.mjs      IMUKIT_WEB_LARGE=1: also a log of 480 MB
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { existsSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { basename, join } from 'node:path';
import { after, before, test } from 'node:test';
import { pathToFileURL } from 'node:url';
import { build, byCommand, logOf, root } from './command.mjs';
import { Browser } from './devtools.mjs';

const address = pathToFileURL(join(build, 'web/index.html')).href;
const axePath = join(build, 'web-npm/node_modules/axe-core/axe.min.js'); // tools/test_web.sh fetches it
const axe = existsSync(axePath) ? readFileSync(axePath, 'utf8') : null;
const scratch = mkdtempSync(join(tmpdir(), 'imukit-web-'));
const written = (name, content) => {
  writeFileSync(join(scratch, name), content);
  return join(scratch, name);
};
let browser;

before(async () => {
  browser = await Browser.open();
});
after(async () => {
  await browser.close();
  rmSync(scratch, { recursive: true });
});

/** Act on a new page; afterwards the console is empty and nobody else was asked for anything. */
async function withPage(part, options, act) {
  const page = await browser.page(address + part, options);
  await page.until('document.documentElement.dataset.ready');
  await act(page);
  assert.deepEqual(page.faults(), []);
  assert.deepEqual(page.strangers(), []);
  await page.close();
}

const nothingWaits = `![...document.querySelectorAll('[aria-busy="true"]')].length`;

test('each screen fits a telephone and a wide window, light and dark, without violations of WCAG 2.1 AA', async (t) => {
  let names;
  await withPage('', {}, async (page) => {
    names = await page.value(`[...document.querySelectorAll('nav a')].map((link) => link.hash)`);
  });
  assert.ok(names.length >= 3);
  if (!axe) t.diagnostic('axe-core is not there: make test-web fetches it');
  for (const name of names)
    for (const options of [{ width: 360, height: 800, dark: true, still: true }, { width: 1600, height: 1000, still: true }])
      await withPage(name, options, async (page) => {
        await page.until(`document.querySelector('main h1')`);
        await page.until(nothingWaits, 60);
        assert.equal(await page.overflow(), 0, `${name} at ${options.width} px`);
        if (axe) assert.deepEqual(await page.violations(axe), [], `${name} at ${options.width} px`);
      });
});

test('the page forbids scripts and connections that are not its own', async () => {
  await withPage('', {}, async (page) => {
    const policy = await page.value(`document.querySelector('meta[http-equiv="Content-Security-Policy"]').content`);
    for (const rule of [`default-src 'none'`, `connect-src 'none'`, 'sha256-']) assert.ok(policy.includes(rule), rule);
    assert.ok(!policy.includes(`script-src 'unsafe-inline'`));
    const injected = await page.value(`new Promise((resolve) => { const script = document.createElement('script');
      script.textContent = 'window.injected = true'; document.body.append(script); setTimeout(() => resolve(Boolean(window.injected)), 50); })`);
    assert.equal(injected, false);
    page.messages.length = 0; // the browser has told that it refused
  });
});

const still = (name) => logOf(name, 'AHRS', '--rate', '100Hz', '--duration', '2min', '--seed', '5');
const corpus = (path) => join(root, 'fuzz/corpus', path);
for (const path of [still('still.csv'), still('still.npz'), still('still.bag'), still('still.mcap'),
  still('still.csv.gz'), corpus('ulog/combined.ulg'), corpus('dataflash/imu.bin')])
  test(`a log is read: ${basename(path)}`, async () => {
    const all = [path, path + '.columns'].filter(existsSync); // .npy has its columns beside it
    const words = ['info', basename(path), '--json'];
    const { inputs } = JSON.parse(byCommand(words, all.map((one) => [basename(one), readFileSync(one)])).out);
    await withPage('#log', {}, async (page) => {
      await page.choose('#log-files-input', ...all);
      await page.until(`document.querySelector('#log-info .summary')`);
      assert.ok((await page.value(`document.querySelector('#log-info .summary').textContent`)).includes(inputs.format));
      await page.until(nothingWaits, 60);
    });
  });

test('a log is identified; its report, model and numbers can be taken away', async () => {
  await withPage('#log', {}, async (page) => {
    await page.choose('#log-files-input', still('still.csv'));
    await page.until(`document.querySelector('#log-identify svg')`, 60);
    assert.ok((await page.value(`document.querySelector('#log-identify').innerText`)).includes('imukit identify still.csv'));
    await page.until(nothingWaits);
    if (axe) assert.deepEqual(await page.violations(axe), []);
    const pages = (pdf) => pdf.toString('latin1').match(/\/Type\s*\/Page\b/g).length;
    assert.ok(pages(await page.print()) >= 1);
    await page.size(360, 800);
    assert.equal(await page.overflow(), 0);
  });
});

for (const [name, content] of [['words.csv', 'this is no log\n'], ['empty.csv', ''], ['noise.npy', Buffer.from([0x93, 0x4e, 0x55, 0x4d, 1, 2, 3])]])
  test(`what is no log is told in the words of the command: ${name}`, async () => {
    const path = written(name, content);
    const { error } = JSON.parse(byCommand(['info', name, '--json'], [[name, readFileSync(path)]]).out);
    await withPage('#log', {}, async (page) => {
      await page.choose('#log-files-input', path);
      await page.until(`document.querySelector('#log-info [data-part="error"]:not([hidden])')`);
      assert.ok((await page.value(`document.querySelector('#log-info [data-part="error"]').innerText`)).includes(error.message));
      await page.choose('#log-files-input', still('still.csv'));
      await page.until(`document.querySelector('#log-identify svg')`, 60);
    });
  });

test('what runs can be cancelled, and begun anew', async () => {
  const path = logOf('long.npy', 'AHRS', '--rate', '100Hz', '--duration', '3h', '--seed', '6');
  await withPage('#log', {}, async (page) => {
    await page.choose('#log-files-input', path);
    await page.until(`document.querySelector('[data-option="rate"]') || document.querySelector('#log-identify [data-part="cancel"]:not([hidden])')`);
    await page.value(`(() => { const rate = document.querySelector('input[data-option="rate"], [data-option="rate"] input');
      if (rate) { rate.value = '100Hz'; rate.dispatchEvent(new Event('change', { bubbles: true })); } })()`);
    await page.until(`document.querySelector('#log-identify [data-part="cancel"]:not([hidden])')`, 60);
    await page.click('#log-identify [data-part="cancel"]');
    await page.until(nothingWaits);
    assert.ok(!(await page.value(`Boolean(document.querySelector('#log-identify svg'))`)));
    await page.choose('#log-files-input', still('still.csv'));
    await page.until(`document.querySelector('#log-identify svg')`, 60);
  });
});

test('the page is there again after a reload', async () => {
  await withPage('#log', {}, async (page) => {
    await page.choose('#log-files-input', still('still.csv'));
    await page.send('Page.reload');
    await page.until(`document.documentElement.dataset.ready && document.querySelector('main h1')`);
    await page.choose('#log-files-input', still('still.csv'));
    await page.until(`document.querySelector('#log-identify svg')`, 60);
  });
});

test('everything is reached with the keyboard, and where it is stands out', async () => {
  await withPage('', { still: true }, async (page) => {
    const count = await page.value(`document.querySelectorAll('nav a').length`);
    const seen = new Set();
    for (let i = 0; i < count + 6; i++) {
      await page.press('Tab');
      const { name, shown } = await page.value(`(() => { const it = document.activeElement, style = getComputedStyle(it);
        return { name: it.hash || it.id || it.tagName, shown: style.outlineStyle !== 'none' && parseFloat(style.outlineWidth) > 0
          || getComputedStyle(it.parentElement).outlineStyle !== 'none' || it.matches('input.unseen') }; })()`);
      assert.ok(shown || name === 'BODY', `${name} has the focus and looks as before`);
      seen.add(name);
    }
    for (const link of await page.value(`[...document.querySelectorAll('nav a')].map(({ hash }) => hash)`)) assert.ok(seen.has(link), link);
    await page.value(`document.querySelectorAll('nav a')[1].focus()`);
    await page.press('Enter');
    const title = await page.value(`document.querySelectorAll('nav a')[1].textContent`);
    await page.until(`document.querySelector('nav a[aria-current="page"]').textContent === ${JSON.stringify(title)}`);
  });
});

test('a report of the command is whole: small, asks for nothing, accessible', async () => {
  const path = join(scratch, 'report.html');
  const done = spawnSync(join(build, 'imukit'), ['identify', still('still.csv'), '--report', path], { encoding: 'utf8' });
  assert.equal(done.status, 0, done.stderr);
  assert.ok(readFileSync(path).length < 1e6);
  for (const options of [{ width: 360, dark: true }, { width: 1600 }]) {
    const page = await browser.page(pathToFileURL(path).href, options);
    await page.until(`document.querySelector('svg')`);
    assert.equal(await page.overflow(), 0, `${options.width} px`);
    if (axe) assert.deepEqual(await page.violations(axe), [], `${options.width} px`);
    assert.deepEqual([page.faults(), page.strangers()], [[], []]);
    await page.close();
  }
});

test('a log of 480 MB is analysed', { skip: !process.env.IMUKIT_WEB_LARGE }, async (t) => {
  const path = logOf('large.npy', 'AHRS', '--rate', '100Hz', '--duration', '100000s', '--seed', '8');
  await withPage('#log', {}, async (page) => {
    const begin = Date.now();
    await page.choose('#log-files-input', path);
    await page.until(`document.querySelector('input[data-option="rate"], [data-option="rate"] input')`, 60);
    await page.value(`(() => { const rate = document.querySelector('input[data-option="rate"], [data-option="rate"] input');
      rate.value = '100Hz'; rate.dispatchEvent(new Event('change', { bubbles: true })); })()`);
    await page.until(`document.querySelector('#log-identify svg')`, 300);
    t.diagnostic(`identified after ${((Date.now() - begin) / 1000).toFixed(1)} s, with reading`);
  });
});

test('the first plot is there soon after the page is opened', async (t) => {
  await withPage('#instruments', {}, async (page) => {
    t.diagnostic(`first plot after ${await page.value(`new Promise((resolve) => { const look = () => document.querySelector('main svg, main canvas')
      ? resolve(performance.now().toFixed(0)) : requestAnimationFrame(look); look(); })`)} ms at most, measured from the navigation`);
  });
});
