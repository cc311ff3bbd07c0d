/* SPDX-License-Identifier: Apache-2.0 */
/* Numbers as text, and the ticks of an axis: those of figure_ticks.c, so that a panel looks the
 * same when it is drawn anew. An axis has `low` and `high`, exponents of ten if it is `log`. */
'use strict';

const imukitAxes = (() => {
  const openDecade = 36; // shorter decades [px] have no ticks between the powers of ten
  const slimmer = 1.3; // powers of ten need less room than numbers
  const fewDecades = 2.83; // below this span powers of ten alone would give few labels

  const minus = text => text.replace('-', '−');
  const raised = power =>
    minus(String(power)).replace('−', '⁻').replace(/\d/g, digit => '⁰¹²³⁴⁵⁶⁷⁸⁹'[digit]);

  /* A value with its first digits, five unless told. */
  function number(value, digits = 5) {
    const size = Math.abs(value);
    if (size === 0 || (size >= 1e-4 && size < 10 ** Math.max(digits, 6)))
      return minus(String(Number(value.toPrecision(digits))));
    const [mantissa, power] = value.toExponential(digits - 1).split('e');
    return `${minus(String(Number(mantissa)))}·10${raised(Number(power))}`;
  }

  /* The digits that tell values on this axis apart. */
  function digitsFor(axis) {
    const most = Math.max(Math.abs(axis.low), Math.abs(axis.high));
    const more = axis.log ? 0 : Math.ceil(Math.log10(most / (axis.high - axis.low)));
    return Math.min(Math.max(5, 5 + more), 15);
  }

  function stepMake(span, most) {
    const rough = span / Math.max(most, 1), power = Math.floor(Math.log10(rough));
    const digit = rough / 10 ** power;
    return digit > 5 ? {digit: 1, power: power + 1} : {digit: digit <= 1 ? 1 : digit <= 2 ? 2 : 5, power};
  }

  /* From whole numbers, so that 3 times 0.1 is 0.3. */
  const stepValue = (step, n) =>
    step.power < 0 ? n * step.digit / 10 ** -step.power : n * step.digit * 10 ** step.power;

  const digitsOf = (power, decimals) => Math.max(power, 0) + 1 + (decimals > 0 ? decimals + 1 : 0);

  /* 0.25, or 2.5·10⁻⁷ if all labels are very small or large, unless this form is longer. */
  function linearLabel(axis, step, n) {
    const value = stepValue(step, n), most = Math.max(Math.abs(axis.low), Math.abs(axis.high));
    const power = Math.floor(Math.log10(most)), plain = Math.max(-step.power, 0);
    const behind = Math.max(power - step.power, 0);
    if (n === 0)
      return '0';
    if ((most >= 1e-3 && most < 1e6) || digitsOf(power, plain) <= digitsOf(0, behind) + 4)
      return minus(value.toFixed(Math.min(plain, 17)));
    const mantissa = power < 0 ? value * 10 ** -power : value / 10 ** power;
    return `${minus(mantissa.toFixed(Math.min(behind, 10)))}·10${raised(power)}`;
  }

  /* 0.02, 500 or 2·10⁻⁵ */
  function digitLabel(digit, power) {
    if (power >= -3 && power <= 4)
      return minus(stepValue({digit, power}, 1).toFixed(Math.max(-power, 0)));
    return `${digit > 1 ? `${digit}·` : ''}10${raised(power)}`;
  }

  function add(ticks, axis, at, text) {
    const place = (at - axis.low) / (axis.high - axis.low);
    if (place >= 0 && place <= 1)
      ticks.push({place, text});
  }

  function linearTicks(axis, most) {
    const low = axis.log ? 10 ** axis.low : axis.low, high = axis.log ? 10 ** axis.high : axis.high;
    const ticks = [], step = stepMake(high - low, most), parts = step.digit === 1 ? 2 : step.digit;
    const distance = stepValue(step, 1);
    const first = Math.floor(low / distance) * parts, last = Math.ceil(high / distance) * parts;
    for (let n = first; n <= last && ticks.length < 256; n++) {
      const labelled = n % parts === 0;
      const value = labelled ? stepValue(step, n / parts) : n / parts * distance;
      if (!axis.log || value > 0)
        add(ticks, axis, axis.log ? Math.log10(value) : value,
          labelled ? linearLabel({low, high}, step, n / parts) : '');
    }
    return ticks;
  }

  function digitTicks(axis) {
    const ticks = [];
    for (let power = Math.floor(axis.low); power <= Math.ceil(axis.high); power++)
      for (let digit = 1; digit <= 9; digit++)
        add(ticks, axis, power + Math.log10(digit),
          [1, 2, 5].includes(digit) ? digitLabel(digit, power) : '');
    return ticks;
  }

  /* Powers of ten: every one, or every second, fifth, tenth …, as there is room. */
  function powerTicks(axis, length, most) {
    const ticks = [], decades = axis.high - axis.low, room = most * slimmer;
    const stride = Math.round(stepValue(stepMake(Math.max(decades, room), room), 1));
    const open = stride === 1 && length / decades >= openDecade;
    for (let power = Math.floor(axis.low); power <= Math.ceil(axis.high); power++) {
      if (power % stride === 0 || decades <= 10 * room)
        add(ticks, axis, power, power % stride === 0 ? `10${raised(power)}` : '');
      for (let digit = 2; digit <= 9 && open; digit++)
        add(ticks, axis, power + Math.log10(digit), '');
    }
    return ticks;
  }

  /* Ticks of an axis of this length, whose labels need this much room: {place: 0 … 1, text}. */
  function ticksOf(axis, length, room) {
    const most = Math.max(length / room, 2);
    if (axis.log && axis.high - axis.low >= fewDecades)
      return powerTicks(axis, length, most);
    if (axis.log) {
      const ticks = digitTicks(axis);
      if (ticks.filter(tick => tick.text).length >= 3)
        return ticks;
    }
    return linearTicks(axis, most);
  }

  /* Can a value stand on such an axis? And where: 0 at its low end, 1 at its high end. */
  const drawable = (axis, value) =>
    value !== null && Number.isFinite(value) && (!axis.log || value > 0);
  const placeOf = (axis, value) => Math.max(-1e4, Math.min(1e4,
    ((axis.log ? Math.log10(value) : value) - axis.low) / (axis.high - axis.low)));

  return {number, digitsFor, ticksOf, drawable, placeOf};
})();
