// SPDX-License-Identifier: Apache-2.0
// An instrument that runs in the page has the samples of `imukit physics`, to the last bit: each
// runs from its start, and its outputs and signals are compared with the log that the verb writes.
//
//     node web/test/live_instruments.mjs IMUKIT.wasm [NAME…]
import { readFile } from 'node:fs/promises';
import { createRequire } from 'node:module';

const { PageSystem } = createRequire(import.meta.url)('../page/wasi.js');
const { LiveInstrument } = createRequire(import.meta.url)('../page/live.js');
const [wasm, ...names] = process.argv.slice(2);
const compiled = await WebAssembly.compile(await readFile(wasm));

async function begin(words, files = []) {
  const system = new PageSystem({ words: ['imukit', ...words], files: new Map(files) });
  const { exports } = await WebAssembly.instantiate(compiled, system.imports);
  system.memory = exports.memory;
  return { system, exports };
}

async function verb(words, files) {
  const { system, exports } = await begin(words, files);
  const code = system.run(exports);
  if (code !== 0) throw new Error(`${words.join(' ')}: ${system.text(2)}`);
  return system;
}

/** Rows of a .npy of doubles. */
function table(bytes) {
  const header = 10 + bytes[8] + 256 * bytes[9];
  return new Float64Array(bytes.slice(header).buffer);
}

/** All columns of a run, in the units of the verb. */
async function wanted(name, design, rate, count) {
  const words = ['physics', design ? 'design.yaml' : name, '--rate', '3 1 -2 deg/s', '--acceleration', '0.5 0.1 1 g',
    '--temperature', '30 degC', '--output-rate', `${rate}Hz`, '--duration', `${count / rate}s`, '-o', 'out.npy', '--signals', 'inside.npy'];
  const system = await verb(words, design ? [['design.yaml', new TextEncoder().encode(design)]] : []);
  return [table(system.file('out.npy')), table(system.file('inside.npy'))];
}

async function compare(name) {
  const { exports } = await begin([]);
  const live = new LiveInstrument(exports);
  const told = (answer) => {
    if (answer.problem) throw new Error(`${name}: ${answer.problem}`);
    return answer;
  };
  let { about } = told(live.do('open', [name]));
  const changed = about.fields.find((field) => field.unit && /[1-9]/.test(field.value));
  const design = `imukit: 1\ninstrument: ${name}\n${changed.path.replace('.', ': {')}: ${changed.value}${changed.path.includes('.') ? '}' : ''}\n`;
  const again = told(live.do('change', [design]));
  let compared = 0;
  for (const pace of [about.pace, 100 * about.pace, 1]) {
    about = told(live.do('pace', [pace, 1])).about;
    for (const [what, text] of [['rate', '3 1 -2 deg/s'], ['acceleration', '0.5 0.1 1 g'], ['temperature', '30 degC']])
      told(live.do('expose', [what, text]));
    told(live.do('restart', []));
    const { rows, width } = live.do('step', [1]);
    const count = rows.length / width;
    const [outputs, inside] = await wanted(name, design, about.rate, count);
    const all = [...about.outputs, ...about.signals];
    for (let k = 0; k < count; k++)
      for (let i = 0; i < all.length; i++) {
        const value = rows[k * width + 1 + i];
        const width1 = about.outputs.length + 1, width2 = about.signals.length + 1;
        const same = i < about.outputs.length ? outputs[k * width1 + 1 + i] : inside[k * width2 + 1 + i - about.outputs.length];
        if (value !== same) throw new Error(`${name}, row ${k}, ${all[i].name}: ${value} instead of ${same}`);
        compared++;
      }
  }
  if (!(compared > 1000)) throw new Error(`${name}: only ${compared} numbers`);
  return compared;
}

const known = (await verb(['physics', '--json'])).text(1);
const all = [...known.matchAll(/"name": "([a-z_]+)"/g)].map(([, name]) => name);
if (all.length < 12) throw new Error('the list of instruments is too short');
for (const name of names.length ? names : all) console.log(`${name}: ${await compare(name)} numbers are the same`);
