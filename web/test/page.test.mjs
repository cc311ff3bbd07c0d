// SPDX-License-Identifier: Apache-2.0
// The page in a browser, from a file of the disk: every screen, every format, and what can go wrong.
//
//     node --test web/test/page.test.mjs      IMUKIT_WEB_LARGE=1: also a log of 480 MB
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { copyFileSync, existsSync, mkdirSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { basename, join } from 'node:path';
import { after, before, test as unlimited } from 'node:test';
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

/** Each case has a limit of its own [ms], far above what it takes. */
const test = (name, act, options) => unlimited(name, { timeout: 60000, ...options }, act);

before(async () => {
  browser = await Browser.open();
}, { timeout: 30000 });
after(async () => {
  await browser.close();
  rmSync(scratch, { recursive: true });
}, { timeout: 30000 });

/** Act on a new page; afterwards the console is empty and nobody else was asked for anything. */
async function withPage(part, options, act) {
  const page = await browser.page(address + part, options);
  try {
    await page.until('document.documentElement.dataset.ready');
    await act(page);
    assert.deepEqual(page.faults(), []);
    assert.deepEqual(page.strangers(), []);
  } finally {
    await page.close();
  }
}

const identified = `document.querySelector('#log-identify svg')`;
const remove = (page, path) => page.click(`#log-files [aria-label="Remove ${basename(path)}"]`);

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
        const ground = await page.value(`getComputedStyle(document.documentElement).backgroundColor.match(/\\d+/g).map(Number)`);
        assert.ok(options.dark ? Math.max(...ground) < 80 : Math.min(...ground) > 175, `${name}: the ground is ${ground}`);
        if (axe) assert.deepEqual(await page.violations(axe), [], `${name} at ${options.width} px`);
        for (const between of options.width > 1000 ? [1000, 800, 500] : []) {
          await page.size(between, options.height);
          assert.equal(await page.overflow(), 0, `${name} at ${between} px`);
          const cramped = `[...document.querySelectorAll('.slider')].filter((row) => row.scrollWidth > row.clientWidth).length`;
          assert.equal(await page.value(cramped), 0, `sliders of ${name} at ${between} px`);
        }
      });
}, { timeout: 180000 });

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
for (const path of [still('still.csv'), still('still.npy'), still('still.npz'), still('still.bag'), still('still.mcap'),
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
      if (path.startsWith(build)) await page.until(identified);
    });
  });

test('a .npy log without the names of its columns asks for them, and takes them later', async () => {
  const path = still('still.npy');
  await withPage('#log', {}, async (page) => {
    await page.choose('#log-files-input', path);
    await page.until(`document.querySelector('#log-info [data-part="error"]:not([hidden])')`);
    await page.until(`document.querySelector('#log-options[open] [data-option="columns"][aria-invalid="true"]')`);
    await page.choose('#log-files-input', path, path + '.columns'); // the same log again is not a second one
    await page.until(identified);
    assert.equal(await page.value(`document.querySelectorAll('#log-files li').length`), 2);
    assert.ok((await page.value(`document.querySelector('#log-identify').innerText`)).includes('imukit identify still.npy -o'));
  });
});

test('two logs of one name keep the names of their columns, and logs that are no runs are compared', async () => {
  const path = still('still.npy'), folders = ['one', 'two'].map((name) => join(scratch, name));
  const copies = folders.flatMap((folder) => ['', '.columns'].map((end) => {
    mkdirSync(folder, { recursive: true });
    copyFileSync(path + end, join(folder, 'a.b.npy' + end));
    return join(folder, 'a.b.npy' + end);
  }));
  await withPage('#log', {}, async (page) => {
    await page.choose('#log-files-input', ...copies);
    await page.until(`document.querySelectorAll('#log-info .summary').length === 2 && document.querySelector('#log-sort input[value="runs"]:checked')`);
    await page.choose('#log-files-input', logOf('other.csv', 'MPU6050', '--rate', '50Hz', '--duration', '1min', '--seed', '6'));
    await page.until(`document.querySelector('#log-sort input[value="compare"]:checked') && document.querySelector('#log-go').textContent === 'Compare'`);
    await page.click('#log-go');
    await page.until(identified);
    await page.until(nothingWaits);
    const shown = await page.value(`document.querySelector('#log-identify').innerText`);
    assert.ok(shown.includes("imukit allan a.b.npy 'a (2).b.npy' other.csv --report report.html"), shown.slice(-600));
    for (const name of ['a.b.npy', 'a (2).b.npy', 'other.csv']) assert.ok(shown.split(name).length > 2, name);
  });
});

test('a log of which nobody can tell whether it rested says so, and can be identified', async () => {
  const rows = Array.from({ length: 150 }, (_, k) => [k / 100, Math.sin(k * k), Math.cos(k * k), Math.sin(k ** 3)].join());
  await withPage('#log', {}, async (page) => {
    await page.choose('#log-files-input', written('short.csv', 'time [s],gyro_x [deg/s],gyro_y [deg/s],gyro_z [deg/s]\n' + rows.join('\n') + '\n'));
    await page.until(`/cannot be told/.test(document.querySelector('#log-info [data-part="rest"]')?.textContent) && !document.querySelector('#log-go').hidden`);
  });
});

test('a log is identified; its report, model and numbers can be taken away', async () => {
  await withPage('#log', {}, async (page) => {
    await page.choose('#log-files-input', still('still.csv'));
    await page.until(identified);
    assert.ok((await page.value(`document.querySelector('#log-identify').innerText`)).includes('imukit identify still.csv'));
    await page.until(nothingWaits);
    if (axe) assert.deepEqual(await page.violations(axe), []);
    const pages = (pdf) => pdf.toString('latin1').match(/\/Type\s*\/Page\b/g).length;
    assert.ok(pages(await page.print()) >= 2);
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
      await page.until(nothingWaits);
      assert.ok((await page.value(`document.querySelector('#log-info [data-part="error"]').innerText`)).includes(error.message), 'it stays to be seen');
      await remove(page, path);
      await page.until(identified);
    });
  });

test('one log that cannot be read does not hide the others', async () => {
  await withPage('#log', {}, async (page) => {
    await page.choose('#log-files-input', written('words.csv', 'this is no log\n'), still('still.csv'));
    await page.until(`document.querySelector('#log-info .summary')`);
    await page.until(nothingWaits);
    const text = await page.value(`document.querySelector('#log-info').innerText`);
    for (const part of ['words.csv', 'Usable for identify']) assert.ok(text.includes(part), text);
  });
});

test('a log is sent to the command where only the page cannot read it', async () => {
  for (const [name, content, next] of [['log.h5', Buffer.from('\x89HDF\r\n\x1a\n' + '\0'.repeat(600), 'latin1'), 'imukit convert log.h5 log.npz'],
    ['picture.csv', Buffer.from('\x89PNG\r\n\x1a\n\0\0', 'latin1'), '']])
    await withPage('#log', {}, async (page) => {
      await page.choose('#log-files-input', written(name, content));
      await page.until(`document.querySelector('#log-info [data-part="error"]:not([hidden])')`);
      assert.equal(await page.value(`[...document.querySelectorAll('#log-info [data-part="error"] pre')].map((one) => one.textContent).join()`), next);
    });
});

test('what runs can be cancelled, and begun anew', async () => {
  const path = logOf('long.npy', 'AHRS', '--rate', '100Hz', '--duration', '3h', '--seed', '6');
  await withPage('#log', {}, async (page) => {
    await page.choose('#log-files-input', path, path + '.columns');
    await page.until(`document.querySelector('#log-identify [data-part="cancel"]:not([hidden])')`);
    await page.click('#log-identify [data-part="cancel"]');
    await page.until(nothingWaits);
    assert.equal(await page.value(`document.querySelector('#log-identify [data-part="status"]').textContent`), 'Cancelled.');
    assert.ok(!(await page.value(`Boolean(${identified})`)));
    await remove(page, path);
    await remove(page, path + '.columns');
    await page.choose('#log-files-input', still('still.csv'));
    await page.until(identified);
  });
});

test('drift with updates tells how far it is, and can be cancelled', async () => {
  await withPage('#device/tactical', {}, async (page) => {
    await page.until(`document.querySelector('#device-drift svg')`);
    await page.value(`(() => { const { screen } = screens.device; screen.set('duration', '24 h'); screen.set('aid', 'height 1 m at 1 Hz'); })()`);
    await page.until(`document.querySelector('#device-drift [data-part="status"]').textContent === 'analysing'
      && /^ *\\d+ %.* left$/.test(document.querySelector('#device-drift [data-part="far"]').textContent)`);
    await page.click('#device-drift [data-part="cancel"]');
    await page.until(nothingWaits);
  });
});

test('a worker that throws fails what waits for it, and the next has a new one', async () => {
  await withPage('', {}, async (page) => {
    const thrown = (act) => page.value(`(${act})(new Engine()).then(() => 'nothing', (reason) => reason.message)`);
    assert.match(await thrown(`(engine) => engine.run(['info', 'log.csv'], { files: [['log.csv', {}]] })`), /fault of imukit/);
    await page.value(`void (window.tried = new Engine())`);
    // No request: it throws outside an answer.
    assert.match(await page.value(`new Promise((resolve) => {
      tried.waiting.set(0, { resolve, reject: (reason) => resolve(reason.message) });
      tried.start().then((worker) => worker.postMessage(null)); })`), /null/);
    assert.equal(await page.value(`tried.run(['--version']).then(({ code }) => code)`), 0);
    page.messages.length = 0; // the browser has told of it
  });
});

test('the page is there again after a reload', async () => {
  await withPage('#log', {}, async (page) => {
    await page.choose('#log-files-input', still('still.csv'));
    await page.reload(); // while the log is read
    await page.until(`document.documentElement.dataset.ready && document.querySelector('main h1')`);
    assert.equal(await page.value(`document.querySelectorAll('#log-files li').length`), 0);
    await page.choose('#log-files-input', still('still.csv'));
    await page.until(identified);
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

test('a log of 480 MB is analysed', async (t) => {
  const path = logOf('large.npy', 'AHRS', '--rate', '100Hz', '--duration', '100000s', '--seed', '8');
  await withPage('#log', {}, async (page) => {
    const begin = Date.now();
    await page.choose('#log-files-input', path, path + '.columns');
    await page.until(identified, 300);
    t.diagnostic(`identified after ${((Date.now() - begin) / 1000).toFixed(1)} s, with reading`);
  });
}, { skip: !process.env.IMUKIT_WEB_LARGE, timeout: 400000 });

test('the first plot is there soon after the page is opened', async (t) => {
  await withPage('#instruments', {}, async (page) => {
    t.diagnostic(`first plot after ${await page.value(`new Promise((resolve) => { const look = () => document.querySelector('main img, main svg, main canvas')
      ? resolve(performance.now().toFixed(0)) : requestAnimationFrame(look); look(); })`)} ms at most, measured from the navigation`);
  });
});
