// SPDX-License-Identifier: Apache-2.0
// Makes the page of its parts, one file without any other:
//
//     node web/build.mjs IMUKIT.wasm build/web
import { execFileSync } from 'node:child_process';
import { createHash } from 'node:crypto';
import { mkdirSync, readFileSync, readdirSync, renameSync, statSync, writeFileSync } from 'node:fs';
import { fileURLToPath } from 'node:url';

const [wasm, folder] = process.argv.slice(2);
const here = (path) => fileURLToPath(new URL(path, import.meta.url));
const text = (path) => readFileSync(here(path), 'utf8');
// Comments and blank lines are for those who read the source.
const lean = (script) => script.replace(/^\s*\/\/.*$/gm, '').replace(/^\s*\/\*\*[^]*?\*\/$/gm, '').replace(/^\s*\n/gm, '');

/** A file as unpack.js wants it: in .lzma format, with its size in the header. */
function packed(path) {
  const stream = execFileSync('xz', ['--format=lzma', '--lzma1=preset=9e,lc=4,pb=0', '--stdout', path], { maxBuffer: 1 << 28 });
  stream.writeBigUInt64LE(BigInt(statSync(path).size), 5);
  return stream;
}

const screens = readdirSync(here('page/screens')).filter((name) => name.endsWith('.js')).sort();
const order = ['log', 'device', 'calibrate', 'grades', 'instruments', 'bench', 'tour'];
screens.sort((a, b) => order.indexOf(a.slice(0, -3)) - order.indexOf(b.slice(0, -3)));
// Scripts that others use when they begin come first; those of the worker are apart.
const first = ['elements.js', 'engine.js'], apart = ['wasi.js', 'live.js', 'unpack.js', 'worker.js', 'app.js'];
const inFolder = (folder) => readdirSync(here('page/' + folder)).filter((name) => name.endsWith('.js')).sort().map((name) => folder + name);
const shared = inFolder('').filter((name) => !first.includes(name) && !apart.includes(name));
const script = [readFileSync(wasm.replace(/[^/]*$/, 'page_script.js'), 'utf8'), ...first.map((name) => text('page/' + name)),
  ...shared.map((name) => text('page/' + name)), 'const screens = {};',
  ...screens.map((name) => text('page/screens/' + name)), ...inFolder('tour/').map((name) => text('page/' + name)), text('page/app.js'), 'begin();'].map(lean).join('\n');
const worker = [text('page/wasi.js'), text('page/live.js'), text('page/unpack.js'), text('page/worker.js')].map(lean).join('\n');
const hash = createHash('sha256').update(script).digest('base64');
const policy = [`default-src 'none'`, `script-src 'sha256-${hash}' 'wasm-unsafe-eval'`, `worker-src blob:`,
  `style-src 'unsafe-inline'`, `img-src data: blob:`, `connect-src 'none'`, `base-uri 'none'`, `form-action 'none'`].join('; ');
const escape = (content) => content.replace(/&/g, '&amp;').replace(/</g, '&lt;');
const parts = { policy, style: text('../src/report/page/page_style.css') + text('page/style.css'), licences: escape(text('page/licences.txt')), worker, script,
  module: packed(wasm).toString('base64') };
const page = text('page/index.html').replace(/\{\{(\w+)\}\}/g, (all, name) => parts[name]);
if (/<\/script/i.test(script + worker)) throw new Error('a script holds the end of a script');
mkdirSync(folder, { recursive: true });
writeFileSync(folder + '/index.html.part', page);
renameSync(folder + '/index.html.part', folder + '/index.html');
