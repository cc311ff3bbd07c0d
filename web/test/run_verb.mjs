// SPDX-License-Identifier: Apache-2.0
// Runs a verb of the module in Node, with files of the disk:
//
//     node web/test/run_verb.mjs IMUKIT.wasm WORD… [-- FILE…]
import { readFile, writeFile } from 'node:fs/promises';
import { createRequire } from 'node:module';
import { basename } from 'node:path';

const { PageSystem } = createRequire(import.meta.url)('../page/wasi.js');
const [wasm, ...rest] = process.argv.slice(2);
const end = rest.indexOf('--') < 0 ? rest.length : rest.indexOf('--');
const files = new Map();
for (const path of rest.slice(end + 1)) files.set(basename(path), new Uint8Array(await readFile(path)));
const before = new Set(files.keys());
const system = new PageSystem({ words: ['imukit', ...rest.slice(0, end)], files });
const { instance } = await WebAssembly.instantiate(await readFile(wasm), system.imports);
const start = performance.now();
process.exitCode = system.run(instance.exports);
const taken = performance.now() - start;
process.stdout.write(system.text(1));
process.stderr.write(system.text(2));
if (process.env.TIMES) process.stderr.write(`${taken.toFixed(0)} ms, ${(instance.exports.memory.buffer.byteLength / 1e6).toFixed(0)} MB\n`);
for (const name of system.files.keys()) if (!before.has(name)) await writeFile(name, system.file(name));
