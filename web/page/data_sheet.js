// SPDX-License-Identifier: Apache-2.0
// The figures of a data sheet as a model file: the text beside the fields is what a verb reads, and
// may be changed by hand. Units and meanings are taken as the sheet states them; the command turns
// them into its own.

'use strict';

/** [key in the model file, label, units]; a key has the path within gyro or accel. */
const dataSheetRows = {
  gyro: [
    ['noise.angle_random_walk', 'Noise density or angle random walk', ['deg/sqrt(h)', 'deg/s/sqrt(Hz)', 'mdeg/s/sqrt(Hz)', 'deg/h/sqrt(Hz)', 'rad/s/sqrt(Hz)']],
    ['noise.bias_instability', 'Bias instability', ['deg/h', 'deg/s', 'mdeg/s']],
    ['noise.rate_random_walk', 'Rate random walk', ['deg/h/sqrt(h)', 'deg/s/sqrt(s)', 'rad/s/sqrt(s)']],
    ['bias.repeatability', 'Bias from switch-on to switch-on, 1 sigma', ['deg/h', 'deg/s', 'mdeg/s']],
    ['scale_factor.repeatability', 'Scale factor error, 1 sigma', ['ppm', '%']],
    ['misalignment', 'Misalignment', ['mrad', 'deg', 'arcsec']],
  ],
  accel: [
    ['noise.velocity_random_walk', 'Noise density or velocity random walk', ['ug/sqrt(Hz)', 'mg/sqrt(Hz)', 'm/s/sqrt(h)', 'm/s^2/sqrt(Hz)']],
    ['noise.bias_instability', 'Bias instability', ['ug', 'mg', 'm/s^2']],
    ['noise.acceleration_random_walk', 'Acceleration random walk', ['ug/sqrt(h)', 'm/s^2/sqrt(s)', 'mg/sqrt(h)']],
    ['bias.repeatability', 'Bias from switch-on to switch-on, 1 sigma', ['mg', 'ug', 'm/s^2']],
    ['scale_factor.repeatability', 'Scale factor error, 1 sigma', ['ppm', '%']],
    ['misalignment', 'Misalignment', ['mrad', 'deg', 'arcsec']],
  ],
};

class DataSheet {
  /** change: is called with the text of the model file whenever it changes. */
  constructor({ change }) {
    this.change = change;
    this.fields = [];
    this.name = element('input', { type: 'text', id: 'sheet-name', value: 'my sensor', maxlength: 60, oninput: () => this.write() });
    this.text = element('textarea', { id: 'sheet-text', class: 'sheet-text', spellcheck: 'false', oninput: () => this.change(this.text.value) });
    this.densities = this.makeChoice('sheet-density', 'A figure per √Hz is', [['one-sided', 'one-sided, as most data sheets have it'], ['two-sided', 'two-sided, as in IEEE standards']]);
    this.floors = this.makeChoice('sheet-floor', 'Bias instability is', [['allan_floor', 'the floor of the Allan deviation, as most data sheets have it'], ['bias_instability', 'the coefficient B of IEEE 952: floor / 0.664']]);
    this.root = element('div', { id: 'data-sheet' },
      element('p', {}, 'Leave empty what the sheet does not state: 0 says that there is none. Three numbers are x, y and z.'),
      element('div', { class: 'fields' }, element('div', { class: 'field' }, element('label', { for: 'sheet-name' }, 'Name'), this.name), this.densities.root, this.floors.root),
      this.makeTriad('gyro', 'Gyroscopes'), this.makeTriad('accel', 'Accelerometers'),
      element('label', { for: 'sheet-text' }, 'The model file, which you may change'), this.text);
    this.write(false);
  }

  makeChoice(id, label, options) {
    const field = element('select', { id, onchange: () => this.write() }, options.map(([value, text]) => element('option', { value }, text)));
    return { field, root: element('div', { class: 'field' }, element('label', { for: id }, label), field) };
  }

  makeTriad(triad, title) {
    return element('fieldset', {}, element('legend', {}, title), element('div', { class: 'fields' },
      dataSheetRows[triad].map(([key, label, units]) => this.makeField(triad, key, label, units))));
  }

  makeField(triad, key, label, units) {
    const id = `sheet-${triad}-${key.replace(/\W/g, '-')}`;
    const number = element('input', { type: 'text', inputmode: 'decimal', id, 'data-key': `${triad}.${key}`, autocomplete: 'off', oninput: () => this.write() });
    const unit = element('select', { 'aria-label': `Unit of ${label.toLowerCase()}`, onchange: () => this.write() }, units.map((name) => element('option', {}, name)));
    this.fields.push({ triad, key, number, unit });
    return element('div', { class: 'field' }, element('label', { for: id }, label), element('div', { class: 'with-unit' }, number, unit));
  }

  /** Lines of a triad: groups such as noise become blocks. */
  lines(triad) {
    const groups = new Map();
    for (const { key, number, unit } of this.fields.filter((field) => field.triad === triad && field.number.value.trim())) {
      const [group, name] = key.includes('.') ? key.split('.') : ['', key];
      const written = name === 'bias_instability' ? this.floors.field.value : name;
      const lines = groups.get(group) || [];
      lines.push(`${written}: ${number.value.trim().replace(/(\d),(\d)/g, '$1.$2')} ${unit.value}`);
      if (/sqrt\(Hz\)/.test(unit.value) && !lines[0].startsWith('density')) lines.unshift(`density: ${this.densities.field.value}`);
      groups.set(group, lines);
    }
    const blocks = [...groups].map(([group, lines]) => (group ? `  ${group}:\n${lines.map((line) => `    ${line}\n`).join('')}` : lines.map((line) => `  ${line}\n`).join('')));
    return blocks.length > 0 ? `${triad}:\n${blocks.join('')}` : '';
  }

  write(tell = true) {
    const both = this.lines('gyro') + this.lines('accel');
    this.text.value = `imukit: 1\nname: ${JSON.stringify(this.name.value.trim() || 'my sensor')}\n${both}`;
    if (tell) this.change(both ? this.text.value : '');
  }
}
