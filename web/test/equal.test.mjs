// SPDX-License-Identifier: Apache-2.0
// What the page computes is what the command computes, to the last byte: logs, Allan deviations,
// estimates, intervals and verdicts. The command has the C library of the machine and the kernels of
// its processor; the page has musl and none.
import assert from 'node:assert/strict';
import { createHash } from 'node:crypto';
import { existsSync, mkdirSync, readFileSync, writeFileSync } from 'node:fs';
import { test } from 'node:test';
import { gunzipSync } from 'node:zlib';
import { basename, join } from 'node:path';
import { build, byCommand, byPage, differences, logOf, root } from './command.mjs';

const sha256 = (bytes) => createHash('sha256').update(bytes).digest('hex');

function sameFiles(words, files = []) {
  const [command, page] = [byCommand(words, files), byPage(words, files)];
  assert.equal(command.code, 0, command.err);
  assert.equal(page.code, 0, page.err);
  assert.deepEqual([...page.files.keys()].sort(), [...command.files.keys()].sort());
  assert.ok(command.files.size > 0);
  for (const [name, bytes] of command.files) assert.equal(sha256(page.files.get(name)), sha256(bytes), name);
}

// What differs is shown number by number.
function sameResult(words, files) {
  const [command, page] = [byCommand(words, files), byPage(words, files)];
  assert.equal(page.code, command.code, page.err);
  assert.deepEqual(differences(JSON.parse(page.out), JSON.parse(command.out), 0), []);
  assert.equal(page.out, command.out);
  return JSON.parse(page.out);
}

for (const [model, ...more] of [['AHRS'], ['navigation', '--temperature', '40degC'], ['tactical', '--seed', '7', '--run', '3'],
  ['control', '--rate', '333Hz'], ['ADIS16405', '--increments']])
  test(`simulate ${model}: the same bytes`, () => {
    const rate = more.includes('--rate') ? [] : ['--rate', '200Hz'];
    sameFiles(['simulate', model, '--duration', '30s', ...rate, ...more, '-o', 'log.csv', '--truth', 'truth.csv']);
  });

test('simulate: the same bytes in .npy and in a ROS bag', () => {
  sameFiles(['simulate', 'AHRS', '--rate', '100Hz', '--duration', '20s', '-o', 'log.npy']);
  sameFiles(['simulate', 'AHRS', '--rate', '100Hz', '--duration', '20s', '-o', 'log.bag']);
});

test('arrays are written as by the command; what the page does not write, it refuses in words', () => {
  const words = ['simulate', 'AHRS', '--rate', '10Hz', '--duration', '20s', '-o'];
  for (const name of ['log.npz', 'log.mat']) sameFiles([...words, name]);
  for (const name of ['log.csv.gz', 'log.csv.zst', 'log.mcap', 'log.h5', 'log.db3']) {
    const { code, err, files } = byPage([...words, name]);
    assert.notEqual(code, 0);
    assert.match(err, /which the page does not write|that the page does not write/, name);
    assert.match(err, /expected a name .*, or the command/, name);
    assert.equal(files.size, 0);
  }
});

test('the page offers the parameter formats that hold noise, but Gazebo\'s, and they are written as by the command', () => {
  const [, list] = /noiseFormats = \[([^\]]*)\]/.exec(readFileSync(join(root, 'web/page/conversion.js'), 'utf8'));
  const offered = list.match(/'[^']+'/g).map((name) => name.slice(1, -1)), model = [['model.yaml', Buffer.from(byCommand(['devices', 'tactical']).out)]];
  for (const format of offered)
    sameFiles(['convert', 'model.yaml', 'imu.yaml', '--to', format, '--rate', '100Hz', ...(format === 'glim' ? ['--frame-rate', '10Hz'] : [])], model);
  const [, known] = /one of (\S+)/.exec(byCommand(['convert', 'model.yaml', 'imu.yaml', '--to', 'no'], model).err);
  const others = ['model', 'euroc', 'gazebo', 'px4', 'ardupilot', 'fusion']; // of logs and of calibrations, and Gazebo's
  assert.deepEqual(offered.sort(), known.split('|').filter((name) => !others.includes(name)).sort());
});

const instruments = JSON.parse(byPage(['physics', '--json']).out).result.instruments.map(({ name }) => name);
test('physics: the same bytes of every instrument', () => {
  assert.ok(instruments.length >= 12);
  for (const name of instruments) sameFiles(['physics', name, '--duration', '2s', '-o', 'samples.csv']);
});

// Lines, resonance, filter and a Gauss-Markov term in one sensor.
mkdirSync(join(build, 'web-tests'), { recursive: true });
const shaped = join(build, 'web-tests/shaped.yaml');
writeFileSync(shaped, `imukit: 1
gyro:
  bandwidth: 6 Hz
  damping: 0.7
  noise:
    angle_random_walk: 0.3 deg/sqrt(h)
    gauss_markov: [{sigma: 60 deg/h, correlation_time: 20 s}]
    sinusoid: [{amplitude: 100 deg/h, frequency: 2.37 Hz}]
    resonance: [{sigma: 0.05 deg/s, frequency: 4 Hz, q: 8}]
`);

const logs = [
  logOf('ahrs.csv', 'AHRS', '--rate', '100Hz', '--duration', '10min', '--seed', '1'),
  logOf('tactical.npy', 'tactical', '--rate', '50Hz', '--duration', '20min', '--seed', '2'),
  logOf('icm20602.csv', 'ICM20602', '--rate', '40Hz', '--duration', '20min', '--seed', '3'),
  logOf('navigation.npz', 'navigation', '--rate', '20Hz', '--duration', '40min', '--seed', '4'),
  logOf('control.csv', 'control', '--rate', '50Hz', '--duration', '10min', '--seed', '5'),
  logOf('rounded.csv', 'ADIS16405', '--rate', '100Hz', '--duration', '5min', '--seed', '6'),
  logOf('warm.csv', 'tactical', '--temperature', '40degC', '--rate', '20Hz', '--duration', '10min', '--seed', '7'),
  logOf('shaped.csv', shaped, '--no-earth', '--rate', '20Hz', '--duration', '20min', '--seed', '8'),
];
const real = join(root, '../shared/data/static/adis16405_imu1_100hz.csv.gz'); // beside the checkout, as for other tests
if (existsSync(real)) {
  const lines = gunzipSync(readFileSync(real)).toString().split('\n', 60000);
  logs.push(join(build, 'web-tests/adis16405.csv'));
  writeFileSync(logs.at(-1), lines.join('\n') + '\n');
}

for (const path of logs)
  test(`${basename(path)}: the same Allan deviations, estimates and verdict`, () => {
    const name = basename(path), files = [[name, readFileSync(path)]];
    const beside = path + '.columns';
    if (existsSync(beside)) files.push([name + '.columns', readFileSync(beside)]);
    const rate = path.includes('adis16405') ? ['--rate', '100Hz'] : [];
    assert.ok(sameResult(['allan', name, ...rate, '--json'], files).result);
    assert.ok(sameResult(['identify', name, ...rate, '--json'], files).result.verdict);
  });

test('several logs: the same joint estimates', () => {
  const runs = [1, 2].map((run) => logOf(`run${run}.csv`, 'AHRS', '--rate', '50Hz', '--duration', '5min', '--run', `${run}`));
  const files = runs.map((path) => [basename(path), readFileSync(path)]);
  for (const how of ['--runs', '--devices'])
    assert.ok(sameResult(['identify', 'run1.csv', 'run2.csv', how, '--json'], files).result);
});

test('a file that is no log is refused in the same words', () => {
  const files = [['log.csv', Buffer.from('this is no log\n')]];
  const [command, page] = [byCommand(['identify', 'log.csv'], files), byPage(['identify', 'log.csv'], files)];
  assert.deepEqual([page.code, page.err, page.out], [command.code, command.err, command.out]);
  assert.notEqual(page.code, 0);
});
