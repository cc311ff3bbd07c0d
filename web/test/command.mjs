// SPDX-License-Identifier: Apache-2.0
// The command and the module of the page, for tests: both do a verb with the same files and give
// { code, out, err, files }, where `files` is a Map of what was written. The command uses the best
// kernels of the machine: they give the bits of those of a page.
import { spawnSync } from 'node:child_process';
import { existsSync, mkdirSync, mkdtempSync, readFileSync, readdirSync, rmSync, writeFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import { tmpdir } from 'node:os';
import { join, resolve } from 'node:path';
import { fileURLToPath } from 'node:url';

const { PageSystem } = createRequire(import.meta.url)('../page/wasi.js');

export const root = fileURLToPath(new URL('../../', import.meta.url));
export const build = resolve(root, process.env.BUILD || 'build');
export const imukit = join(build, 'imukit');

let compiled;
/** The module, compiled once and only for those who want it. */
const moduleOfPage = () => (compiled ||= new WebAssembly.Module(readFileSync(process.env.IMUKIT_WASM || join(build, 'web-objects/imukit.wasm'))));

/** files: [[name, bytes], …] */
export function byPage(words, files = []) {
  const system = new PageSystem({ words: ['imukit', ...words], files: new Map(files) });
  const start = performance.now();
  const code = system.run(new WebAssembly.Instance(moduleOfPage(), system.imports).exports);
  const given = new Set(files.map(([name]) => name));
  const made = [...system.files.keys()].filter((name) => !given.has(name));
  return { code, out: system.text(1), err: system.text(2), milliseconds: performance.now() - start,
    files: new Map(made.map((name) => [name, Buffer.from(system.file(name))])) };
}

/** Functions of a module that does no verb. */
export function moduleFunctions() {
  const system = new PageSystem({ words: [], files: [] });
  const { exports } = new WebAssembly.Instance(moduleOfPage(), system.imports);
  system.memory = exports.memory;
  return exports;
}

export function byCommand(words, files = []) {
  const folder = mkdtempSync(join(tmpdir(), 'imukit-web-'));
  try {
    for (const [name, bytes] of files) writeFileSync(join(folder, name), bytes);
    const environment = { ...process.env, NO_COLOR: '1' };
    const start = performance.now();
    const done = spawnSync(imukit, words, { cwd: folder, encoding: 'utf8', maxBuffer: 1 << 28, env: environment });
    const milliseconds = performance.now() - start;
    const given = new Set(files.map(([name]) => name));
    const made = readdirSync(folder).filter((name) => !given.has(name));
    return { code: done.status, out: done.stdout, err: done.stderr, milliseconds,
      files: new Map(made.map((name) => [name, readFileSync(join(folder, name))])) };
  } finally {
    rmSync(folder, { recursive: true });
  }
}

/** A log made by the command, kept in the build folder. @return its path */
export function logOf(name, ...words) {
  const folder = join(build, 'web-tests');
  mkdirSync(folder, { recursive: true });
  const path = join(folder, name);
  if (!existsSync(path)) {
    const done = spawnSync(imukit, ['simulate', ...words, '-o', path], { encoding: 'utf8' });
    if (done.status !== 0) throw new Error(done.stderr);
  }
  return path;
}

/** Where two results differ: numbers by more than `tolerance` of the larger one, all else at all.
 *  @return sentences */
export function differences(one, other, tolerance, path = '') {
  if (typeof one === 'number' && typeof other === 'number') {
    const close = Math.abs(one - other) <= tolerance * Math.max(Math.abs(one), Math.abs(other));
    return close ? [] : [`${path}: ${one} and ${other}`];
  }
  if (!one || !other || typeof one !== 'object' || typeof other !== 'object')
    return one === other ? [] : [`${path}: ${JSON.stringify(one)} and ${JSON.stringify(other)}`];
  const keys = [...new Set([...Object.keys(one), ...Object.keys(other)])];
  return keys.flatMap((key) => differences(one[key], other[key], tolerance, `${path}/${key}`));
}
