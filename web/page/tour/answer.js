// SPDX-License-Identifier: Apache-2.0
// Commands of the tour as words and files, numbers of their output, and answers of the reader.

'use strict';

/** 'physics x.yaml --rate "10 deg/s"' as words. */
function wordsOf(line) {
  return line.match(/"[^"]*"|\S+/g).map((word) => word.replace(/^"(.*)"$/, '$1'));
}

/** Text with {name} replaced by the value of that control, {name.number} by its number alone. */
function filled(text, values) {
  return text.replace(/\{(\w+)(\.number)?\}/g, (all, name, number) => (!(name in values) ? all : number ? parseFloat(values[name]) : values[name]));
}

/** Do the commands one after the other; each has the files given and those made before.
 *  Gives the last one's result; `files` has all that was made. run: as Engine.run(). */
async function runCommands(run, lines, files = {}) {
  const all = new Map(Object.entries(files).map(([name, text]) => [name, new TextEncoder().encode(text)]));
  let done;
  for (const line of lines) {
    done = await run(wordsOf(line), { files: [...all] });
    if (done.code !== 0) throw new Error(done.err.trim() || done.out.trim());
    for (const [name, bytes] of done.files) all.set(name, bytes);
  }
  return { ...done, files: all };
}

/** The quantity { value, unit } at a path of keys; a list is entered by the name of an entry or by
 *  its place, from the end if negative. */
function quantityAt(json, path) {
  return path.reduce((at, key) => {
    const next = !Array.isArray(at) ? at[key] : typeof key === 'number' ? at.at(key) : at.find(({ name }) => name === key);
    if (next === undefined) throw new Error(`the output has no ${key}`);
    return next;
  }, json);
}

const degree = Math.PI / 180, standardGravity = 9.80665;
/** What the units are in those of the output, which are SI. */
const unitSizes = {
  'rad/s': { 'deg/s': degree, 'deg/h': degree / 3600, 'rad/s': 1 },
  rad: { deg: degree, arcmin: degree / 60, arcsec: degree / 3600, mrad: 1e-3, rad: 1 },
  m: { m: 1, km: 1000, nmi: 1852, mm: 1e-3, um: 1e-6, nm: 1e-9, pm: 1e-12 },
  'm/s^2': { 'm/s^2': 1, g: standardGravity, mg: 1e-3 * standardGravity, ug: 1e-6 * standardGravity },
  Hz: { Hz: 1, kHz: 1000 },
  'kg*m^2/s': { 'kg m^2/s': 1, 'N m s': 1 },
  'N*m': { 'N m': 1, 'mN m': 1e-3, 'uN m': 1e-6 },
  'rad/(rad/s)': { 'mrad/(deg/s)': 1e-3 / degree, 'rad/(rad/s)': 1, 'deg/(deg/s)': 1, s: 1 },
  'm/s^2/(rad/s)': { 'm/s^2/(deg/s)': 1 / degree, 'm/s^2/(rad/s)': 1 },
  'rad/s/(m/s^2)': { 'deg/h/g': degree / 3600 / standardGravity, 'deg/s/g': degree / standardGravity },
};

/** Is "12.3 deg/h" the quantity? Gives { right, say }. */
function judged(text, { value, unit, asked }, tolerance) {
  const units = unitSizes[unit], names = Object.keys(units);
  const plain = text.trim().replace(/,(?=\d)/, '.').replace(/[−–]/g, '-').replace(/[µμ]/g, 'u').replace(/°/g, 'deg').replace(/²/g, '^2').replace(/×\s*10\^?/, 'e');
  const [, number, rest] = /^([-+]?(?:\d+\.?\d*|\.\d+)(?:e[-+]?\d+)?)\s*(.*)$/i.exec(plain) || [];
  if (number === undefined) return { right: false, say: `Write a number with its unit, such as 1.2 ${asked}.` };
  const same = (name) => name.replace(/[\s*·]/g, '') === rest.replace(/[\s*·]/g, '');
  const name = names.find(same);
  if (!name) return { right: false, say: rest ? `The unit must be one of ${names.join(', ')}.` : `The unit is missing, such as ${asked}.` };
  const given = Number(number) * units[name];
  if (Math.abs(given - value) <= tolerance * Math.abs(value)) return { right: true, say: 'Right.' };
  if (Math.abs(given + value) <= tolerance * Math.abs(value)) return { right: false, say: 'The size is right, the sign is not.' };
  return { right: false, say: 'Not right.' + (given * value > 0 ? ` ${given / value > 1 ? 'Too large' : 'Too small'}.` : '') };
}

/** The quantity in the unit that was asked for, with four digits. */
function quantityText({ value, unit, asked }) {
  return `${Number((value / unitSizes[unit][asked]).toPrecision(4))} ${asked}`;
}

/** Where the text of the value begins: after the names of the path, one after the other. */
function placeOfValue(out, path, value) {
  let at = 0;
  for (const key of path) if (typeof key === 'string') at = Math.max(at, out.indexOf(`"${key}"`, at));
  const numbers = /"value": ([-+.\de]+)/g;
  numbers.lastIndex = at;
  for (let found; (found = numbers.exec(out)); ) if (Number(found[1]) === value) return found.index + 9;
  return -1;
}

if (typeof module !== 'undefined') module.exports = { wordsOf, filled, runCommands, quantityAt, placeOfValue, unitSizes, judged, quantityText };
