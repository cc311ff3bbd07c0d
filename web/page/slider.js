// SPDX-License-Identifier: Apache-2.0
// A number with its unit, to be moved or written: a slider and a text field beside it.

'use strict';

/** Three digits, as a person writes them. */
function threeDigits(value) {
  return String(Number(value.toPrecision(3)));
}

/** Four digits, in columns of a table: 0.000123, 1.234e-9. */
function shownNumber(value) {
  if (!Number.isFinite(value)) return '–';
  const size = Math.abs(value);
  if (size !== 0 && (size < 1e-3 || size >= 1e6)) return value.toExponential(3).replace('e+', 'e').replace(/-/g, '−');
  return (size >= 1e4 ? value.toFixed(0) : value.toPrecision(4)).replace('-', '−');
}

/** A text without the last digits of doubles: "29.999999999999993 nm" is 30 nm. */
function tidyNumbers(text) {
  return text.replace(/\d[\d.]{13,}(e[-+]?\d+)?/gi, (number) => String(Number(Number(number).toPrecision(12))));
}

let sliderCount = 0;

/** A row of label, slider and field. `change(text)` gets "12.3 deg/s" and gives a problem or ''.
 *  label; text: at first; unit; minimum, maximum: in the unit; logarithmic; help. */
function makeSlider({ label, text, unit, minimum, maximum, logarithmic, help, change }) {
  const id = 'slider' + ++sliderCount, steps = 1000;
  const isLogarithmic = logarithmic && minimum > 0;
  const value = (place) => (isLogarithmic ? minimum * (maximum / minimum) ** (place / steps) : minimum + ((maximum - minimum) * place) / steps);
  const place = (number) => Math.round(steps * (isLogarithmic ? Math.log(number / minimum) / Math.log(maximum / minimum) : (number - minimum) / (maximum - minimum)));
  const written = (number) => (unit && unit !== '1' ? `${number} ${unit}` : String(number));
  const problem = element('p', { class: 'problem', id: id + 'p', role: 'alert' });
  const range = element('input', { type: 'range', id, min: 0, max: steps, oninput: moved, onkeydown: step });
  const field = element('input', { type: 'text', 'aria-label': `${label}, with unit`, 'aria-describedby': id + 'p', value: text, onchange: typed, spellcheck: 'false', autocomplete: 'off' });
  const row = element('div', { class: 'slider', title: help }, element('label', { for: id }, label), range, field, problem);

  function show() {
    const number = parseFloat(field.value);
    if (Number.isFinite(number)) range.value = place(number) || 0;
    range.setAttribute('aria-valuetext', field.value);
  }
  async function take() {
    range.setAttribute('aria-valuetext', field.value);
    const said = await change(field.value);
    problem.textContent = said || '';
    field.setAttribute('aria-invalid', said ? 'true' : 'false');
  }
  // Near the middle of a scale through zero, zero is meant.
  function moved() {
    const number = Number(range.value), zero = minimum < 0 && maximum > 0 ? place(0) : NaN;
    field.value = written(Math.abs(number - zero) < 8 ? 0 : threeDigits(value(number)));
    return take();
  }
  // With keys a step is a hundredth of the way.
  function step(event) {
    const direction = { ArrowRight: 1, ArrowUp: 1, ArrowLeft: -1, ArrowDown: -1, PageUp: 10, PageDown: -10 }[event.key];
    if (!direction) return;
    event.preventDefault();
    range.value = Number(range.value) + 10 * direction;
    moved();
  }
  function typed() {
    const bare = field.value.trim();
    if (/^[-+]?[\d.]+(e[-+]?\d+)?$/i.test(bare)) field.value = written(bare);
    show();
    return take();
  }
  show();
  return { row, field, set: (given) => ((field.value = given), (problem.textContent = ''), field.setAttribute('aria-invalid', 'false'), show()) };
}

/** A choice of words: "open|closed". */
function makeChoice({ label, text, choices, help, change }) {
  const id = 'slider' + ++sliderCount;
  const problem = element('p', { class: 'problem', role: 'alert' });
  const select = element('select', { id, onchange: async () => (problem.textContent = (await change(select.value)) || '') },
    choices.split('|').map((word) => element('option', { selected: word === text }, word)));
  return { row: element('div', { class: 'slider', title: help }, element('label', { for: id }, label), select, problem), field: select, set: (given) => (select.value = given) };
}
