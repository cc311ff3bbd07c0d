// SPDX-License-Identifier: Apache-2.0
// What the page computes is what the command computes: logs to the last byte, results to 1e-9.
//
// Results are not the same bits, for two reasons: kernels add in other orders on other processors, and
// functions of the C library differ in the last bit. 1e-9 is far above both (1e-13 is seen) and far
// below what any result states.
import assert from 'node:assert/strict';
import { createHash } from 'node:crypto';
import { existsSync, readFileSync } from 'node:fs';
import { test } from 'node:test';
import { basename, join } from 'node:path';
import { byCommand, byPage, differences, logOf, root } from './command.mjs';

const tolerance = 1e-9;
const sha256 = (bytes) => createHash('sha256').update(bytes).digest('hex');

function sameFiles(words, files = []) {
  const [command, page] = [byCommand(words, files), byPage(words, files)];
  assert.equal(command.code, 0, command.err);
  assert.equal(page.code, 0, page.err);
  assert.deepEqual([...page.files.keys()].sort(), [...command.files.keys()].sort());
  assert.ok(command.files.size > 0);
  for (const [name, bytes] of command.files) assert.equal(sha256(page.files.get(name)), sha256(bytes), name);
}

function sameResult(words, files) {
  const [command, page] = [byCommand(words, files), byPage(words, files)];
  assert.equal(page.code, command.code, page.err);
  assert.deepEqual(differences(JSON.parse(page.out), JSON.parse(command.out), tolerance), []);
  return JSON.parse(page.out);
}

for (const [model, ...more] of [['AHRS'], ['navigation', '--temperature', '40degC'], ['tactical', '--seed', '7', '--run', '3'],
  ['control', '--rate', '333Hz'], ['ADIS16405', '--increments']])
  test(`simulate ${model}: the same bytes`, () => {
    const rate = more.includes('--rate') ? [] : ['--rate', '200Hz'];
    sameFiles(['simulate', model, '--duration', '30s', ...rate, ...more, '-o', 'log.csv', '--truth', 'truth.csv']);
  });

test('simulate: the same bytes in .npy and in MCAP', () => {
  sameFiles(['simulate', 'AHRS', '--rate', '100Hz', '--duration', '20s', '-o', 'log.npy']);
  sameFiles(['simulate', 'AHRS', '--rate', '100Hz', '--duration', '20s', '-o', 'log.mcap']);
});

const instruments = JSON.parse(byPage(['physics', '--json']).out).result.instruments.map(({ name }) => name);
test('physics: the same bytes of every instrument', () => {
  assert.ok(instruments.length >= 12);
  for (const name of instruments) sameFiles(['physics', name, '--duration', '2s', '-o', 'samples.csv']);
});

const logs = [
  logOf('ahrs.csv', 'AHRS', '--rate', '100Hz', '--duration', '10min', '--seed', '1'),
  logOf('tactical.npy', 'tactical', '--rate', '50Hz', '--duration', '20min', '--seed', '2'),
  logOf('icm20602.csv', 'ICM20602', '--rate', '40Hz', '--duration', '20min', '--seed', '3'),
  logOf('navigation.npz', 'navigation', '--rate', '20Hz', '--duration', '40min', '--seed', '4'),
];
const real = join(root, '../shared/data/navigation/laser_gyro_parked_100hz_increments.csv.gz');
if (existsSync(real)) logs.push(real); // beside the checkout, as for other tests

for (const path of logs)
  test(`${basename(path)}: the same Allan deviations, terms and verdict`, () => {
    const name = basename(path), files = [[name, readFileSync(path)]];
    const known = name.endsWith('.npy') ? ['--rate', '50Hz'] : [];
    const allan = sameResult(['allan', name, ...known, '--json'], files);
    assert.ok(allan.result);
    const { result } = sameResult(['identify', name, ...known, '--json'], files);
    assert.ok(result.verdict);
  });

test('a file that is no log is refused in the same words', () => {
  const files = [['log.csv', Buffer.from('this is no log\n')]];
  const [command, page] = [byCommand(['identify', 'log.csv'], files), byPage(['identify', 'log.csv'], files)];
  assert.deepEqual([page.code, page.err, page.out], [command.code, command.err, command.out]);
  assert.notEqual(page.code, 0);
});
