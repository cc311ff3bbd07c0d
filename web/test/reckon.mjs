// SPDX-License-Identifier: Apache-2.0
// A unit at rest that navigates in the page has the track of `imukit navigate`, to all digits that
// the command writes:
//
//     node web/test/reckon.mjs IMUKIT.wasm IMUKIT
import { execFileSync } from 'node:child_process';
import { mkdtempSync, readFileSync, rmSync } from 'node:fs';
import { createRequire } from 'node:module';
import { tmpdir } from 'node:os';
import { join } from 'node:path';

const { PageSystem } = createRequire(import.meta.url)('../page/wasi.js');
const { LiveInstrument } = createRequire(import.meta.url)('../page/live.js');
const [wasm, command] = process.argv.slice(2);
const compiled = await WebAssembly.compile(readFileSync(wasm));
const folder = mkdtempSync(join(tmpdir(), 'imukit-reckon-'));
const log = join(folder, 'rest.csv'), bare = join(folder, 'rest.npy'), written = join(folder, 'track.csv');
try {
  for (const [unit, heading, duration] of [['tactical', 0, '1h'], ['control', -120, '10min']]) {
    for (const name of [log, bare]) execFileSync(command, ['simulate', unit, '--rate', '10Hz', '--duration', duration, '-o', name], { stdio: 'ignore' });
    execFileSync(command, ['navigate', log, '--position', '45 deg, 10 deg, 0 m', '--attitude', `0 0 ${heading} deg`, '--interval', '6s', '-o', written], { stdio: 'ignore' });
    const [head, ...lines] = readFileSync(written, 'utf8').trimEnd().split('\n');
    const columns = ['time [s]', 'north [m]', 'east [m]', 'yaw [deg]'].map((name) => head.split(',').indexOf(name));
    const system = new PageSystem({ words: [], files: [] });
    const { exports } = await WebAssembly.instantiate(compiled, system.imports);
    system.memory = exports.memory;
    const { track } = new LiveInstrument(exports).do('reckon', [new Uint8Array(readFileSync(bare)), heading, 60]);
    let compared = 0;
    lines.slice(0, track.length / 4).forEach((line, row) => columns.forEach((column, c) => {
      const text = line.split(',')[column], digits = (text.split('.')[1] || '').length;
      const error = Math.abs(track[4 * row + c] - Number(text));
      if (!(error <= 0.51 * 10 ** -digits)) throw new Error(`${unit}, row ${row}: ${track[4 * row + c]} instead of ${text}`);
      compared++;
    }));
    if (compared < 400) throw new Error(`${unit}: only ${compared} numbers`);
    console.log(`${unit}: ${compared} numbers of a track are the same`);
  }
} finally {
  rmSync(folder, { recursive: true });
}
