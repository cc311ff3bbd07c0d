// SPDX-License-Identifier: Apache-2.0
// Draws the pictures of docs/browser.md: each screen in a wide window, a narrow one and on a
// telephone, beside one another.
//
//     node web/pictures.mjs build/web/index.html docs/images && pngquant --force --ext .png 48 docs/images/page-*.png
import { writeFile } from 'node:fs/promises';
import { resolve } from 'node:path';
import { pathToFileURL } from 'node:url';
import { Browser } from './test/devtools.mjs';

const [page, folder] = process.argv.slice(2);
const address = pathToFileURL(resolve(page)).href;
const sizes = [[1600, 1200], [800, 1200], [360, 1200]];
const height = 360; // of the picture [px]

// A screen, what brings it to something to see, and when that is there.
const screens = {
  log: ['log', `[...document.querySelectorAll('main button')].find((b) => /example/.test(b.textContent)).click()`, 12000],
  device: ['device', '', 4000],
  calibrate: ['calibrate', '', 3000],
  grades: ['grades', '', 5000],
  instruments: ['instruments/ring_laser', '', 3000],
  bench: ['bench', '', 4000],
  tour: ['tour/4', '', 5000],
};

const wait = (milliseconds) => new Promise((done) => setTimeout(done, milliseconds));
const browser = await Browser.open();
for (const [name, [hash, act, time]] of Object.entries(screens)) {
  const shots = [];
  for (const [width, tall] of sizes) {
    const shown = await browser.page(`${address}#${hash}`, { width, height: tall, dark: width === 800, still: false });
    await shown.until(`document.documentElement.dataset.ready === 'yes'`);
    if (act) await shown.value(`void (${act})`);
    await wait(time);
    shots.push(Buffer.from(await shown.picture()).toString('base64'));
    await shown.close();
  }
  const images = shots.map((shot, i) => `<img src="data:image/png;base64,${shot}" style="height:${height}px;width:${(sizes[i][0] / sizes[i][1]) * height}px;object-fit:cover;object-position:top">`);
  const whole = sizes.reduce((sum, [width, tall]) => sum + (width / tall) * height + 6, 0);
  const sheet = await browser.page(`data:text/html,<body style="margin:0;display:flex;gap:6px;background:%23888">`, { width: Math.round(whole), height });
  await sheet.value(`document.body.innerHTML = ${JSON.stringify(images.join(''))}; Promise.all([...document.images].map((image) => image.decode())).then(() => true)`);
  await writeFile(`${folder}/page-${name}.png`, Buffer.from(await sheet.picture()));
  await sheet.close();
}
await browser.close();
