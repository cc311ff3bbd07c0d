// SPDX-License-Identifier: Apache-2.0
// Fields for what a log does not say of itself: each is an option of the command, and where a verb
// asks for one, its field is shown and marked. Fields are called data-option="rate" and so on.

'use strict';

const readingFields = [
  ['rate', 'Sampling rate', 'such as 100Hz; needed without a time column', ''],
  ['gyro-unit', 'Unit of the gyros', 'where the file has none', 'deg/s rad/s deg/h mdeg/s count'],
  ['accel-unit', 'Unit of the accelerometers', 'where the file has none', 'm/s^2 g mg count'],
  ['time-unit', 'Unit of the time', 'where the file has none', 's ms us ns'],
  ['columns', 'Columns in their order', 'of a log without header: time,gyro_x,gyro_y,gyro_z,accel_x,…; - skips one', ''],
  ['map', 'Columns by their names', 'gyro_x=wx,time=stamp', ''],
  ['axes', 'Directions of x, y and z', 'such as right-forward-up; mapped to forward-right-down', ''],
  ['topic', 'Topic', 'of a log with several sensors', ''],
  ['instance', 'Instance', 'of several sensors of one name', ''],
  ['after', 'Leave out before', 'time from the start, such as 30s', ''],
  ['before', 'Leave out after', 'time from the start, such as 2h', ''],
  ['gyro-scale', 'What a count of the gyros is', 'such as 16.4 LSB/(deg/s)', ''],
  ['accel-scale', 'What a count of the accelerometers is', 'such as 2048 LSB/g', ''],
];

/** Words of a text as a shell divides it: blanks separate, quotes hold together. */
function shellWords(text) {
  const words = [];
  for (const [, single, double, bare] of text.matchAll(/'([^']*)'|"([^"]*)"|([^\s'"]+)/g)) words.push(single ?? double ?? bare);
  return words;
}

class ReadingOptions {
  /** change: is called when the reader has changed a field and wants the log read again.
   *  more: [[option, label, help, suggestions]] of the screen. */
  constructor({ id, change, more = [], button = 'Read again' }) {
    this.fields = new Map();
    this.hint = element('p', { class: 'failed', hidden: true, id: id + '-hint' });
    const rows = [...more, ...readingFields].map((row) => this.makeField(id, row));
    const others = this.makeField(id, ['other', 'Other options', 'as at a terminal: --gaps longest', '']);
    this.root = element('details', { class: 'options', id },
      element('summary', {}, 'What the file does not say of itself'), this.hint,
      element('form', { onsubmit: (event) => (event.preventDefault(), change()) },
        element('div', { class: 'fields' }, rows, others),
        element('button', { type: 'submit', 'data-part': 'again' }, button)));
  }

  makeField(id, [option, label, help, suggestions]) {
    const list = `${id}-${option}-list`, field = element('input', { type: 'text', id: `${id}-${option}`, 'data-option': option,
      list: suggestions ? list : null, 'aria-describedby': `${id}-${option}-help`, spellcheck: 'false', autocomplete: 'off', autocapitalize: 'off' });
    this.fields.set(option, field);
    return element('div', { class: 'field' }, element('label', { for: field.id }, label), field,
      suggestions ? element('datalist', { id: list }, suggestions.split(' ').map((unit) => element('option', { value: unit }))) : null,
      element('small', { id: `${id}-${option}-help` }, help));
  }

  set(option, value) {
    this.fields.get(option).value = value;
  }

  value(option) {
    return this.fields.get(option).value.trim();
  }

  /** Words of the command line. */
  words() {
    const words = [];
    for (const [option, field] of this.fields) {
      const value = field.value.trim();
      if (option === 'other') words.push(...shellWords(value));
      else if (value) words.push('--' + option, value);
    }
    return words;
  }

  /** Show the fields of the options that an error asks for, and go to the first. */
  mark(error) {
    const asked = error ? [...error.message.matchAll(/--([a-z-]+)/g)].map(([, name]) => name) : [];
    const found = [...this.fields].filter(([option]) => asked.includes(option));
    for (const [option, field] of this.fields) field.setAttribute('aria-invalid', asked.includes(option) ? 'true' : 'false');
    this.hint.hidden = found.length === 0;
    if (found.length === 0) return;
    this.hint.textContent = `${error.message}.`;
    this.root.open = true;
    const empty = found.find(([, field]) => !field.value) || found[0];
    empty[1].focus();
  }
}
