// SPDX-License-Identifier: Apache-2.0
// Sensors that verbs take: those of the catalogue by their names, and the reader's own as model
// files, which come from a log, a calibration, a data sheet or a file.

'use strict';

const sensors = {
  own: new Map(), // name of the model file to its bytes
  devices: null,

  /** Keep a model under a name, which replaces the one before it. */
  keep(name, bytes) {
    this.own.set(name, bytes);
  },

  /** The catalogue: [{ name, grade, preset, … }], from the command. */
  catalogue() {
    return (this.devices ||= engine.run(['devices', '--json']).then(({ out }) => JSON.parse(out).result.devices));
  },

  /** Files that a command needs for these names. */
  files(names) {
    return names.filter((name) => this.own.has(name)).map((name) => [name, this.own.get(name)]);
  },

  /** Words of a command for these names. */
  words(names) {
    return names.map((name) => (this.own.has(name) ? operand(name) : name));
  },
};

/** Options of a select: own models first, then grades and devices whose name or class has `part`. */
async function sensorOptions(part = '') {
  const fits = ({ name, grade }) => `${name} ${grade}`.toLowerCase().includes(part.trim().toLowerCase());
  const found = (await sensors.catalogue()).filter(fits);
  const group = (label, members) => (members.length > 0 ? element('optgroup', { label }, members) : null);
  const option = ({ name, grade, preset }) => element('option', { value: name }, preset ? name : `${name} · ${grade}`);
  return [
    group('Mine', [...sensors.own.keys()].filter((name) => fits({ name, grade: '' })).map((name) => element('option', { value: name }, name))),
    group('Grades: typical of a class', found.filter(({ preset }) => preset).map(option)),
    group('Devices', found.filter(({ preset }) => !preset).map(option)),
  ].filter(Boolean);
}
