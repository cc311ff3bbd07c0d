// SPDX-License-Identifier: Apache-2.0
// Curves that run: the last seconds on the screen, drawn on a canvas. It never asks the page for
// sizes while it runs, and draws one path a curve.

'use strict';

class StripChart {
  /** unit: of all curves; names: of them; seconds: on the screen. */
  constructor({ label, unit, names, seconds = 6, room = 8192 }) {
    Object.assign(this, { unit, names, seconds, room, count: 0, first: 0, scale: null });
    this.canvas = element('canvas', { role: 'img', 'aria-label': label });
    this.root = element('div', { class: 'chart' }, this.canvas);
    this.time = new Float64Array(room);
    this.curves = names.map(() => new Float64Array(room));
    this.theme = matchMedia('(prefers-color-scheme: dark)');
    this.theme.onchange = () => this.colours();
    this.watch = new ResizeObserver(([entry]) => this.resize(entry.contentRect));
    this.watch.observe(this.root);
  }

  end() {
    this.watch.disconnect();
    this.theme.onchange = null;
  }

  colours() {
    const style = getComputedStyle(this.root);
    this.paint = ['--one', '--two', '--weak', '--text'].map((name) => style.getPropertyValue(name).trim() || '#888');
  }

  resize({ width, height }) {
    const dots = Math.min(devicePixelRatio || 1, 2);
    Object.assign(this, { width, height, dots });
    this.canvas.width = width * dots;
    this.canvas.height = height * dots;
    this.colours();
    this.draw();
  }

  /** One moment: time on the screen [s], a value a curve; NaN: a gap. */
  add(time, ...values) {
    const at = (this.first + this.count) % this.room;
    this.time[at] = time;
    this.curves.forEach((curve, c) => (curve[at] = values[c]));
    if (this.count < this.room) this.count++;
    else this.first = (this.first + 1) % this.room;
  }

  clear() {
    this.count = this.first = 0;
    this.scale = null;
  }

  /** Least and largest value that is in sight. */
  limits(from) {
    let low = Infinity, high = -Infinity;
    for (const curve of this.curves)
      for (let k = 0; k < this.count; k++) {
        const i = (this.first + k) % this.room;
        if (this.time[i] < from) continue;
        if (curve[i] < low) low = curve[i];
        if (curve[i] > high) high = curve[i];
      }
    return [low, high];
  }

  /** The scale grows at once, and shrinks when the curve has long been smaller. */
  rescale(from) {
    let [low, high] = this.limits(from);
    if (!(high >= low)) return false;
    const least = 1e-9 * Math.max(Math.abs(low), Math.abs(high)) || 1e-12;
    if (high - low < least) [low, high] = [low - least, high + least];
    const span = high - low, now = this.scale;
    if (!now || low < now[0] || high > now[1] || span < 0.3 * (now[1] - now[0]))
      this.scale = [low - 0.15 * span, high + 0.15 * span];
    return true;
  }

  draw() {
    if (!this.width || !this.paint) return;
    const { width, height, dots } = this, pen = this.canvas.getContext('2d');
    const left = 72, bottom = 6, top = 6;
    const end = this.count ? this.time[(this.first + this.count - 1) % this.room] : 0, begin = end - this.seconds;
    pen.setTransform(dots, 0, 0, dots, 0, 0);
    pen.clearRect(0, 0, width, height);
    if (!this.rescale(begin)) return;
    const [low, high] = this.scale;
    const x = (time) => left + ((time - begin) / this.seconds) * (width - left - 4);
    const y = (value) => height - bottom - ((value - low) / (high - low)) * (height - top - bottom);
    this.drawGrid(pen, left, y);
    pen.save();
    pen.beginPath();
    pen.rect(left, 0, width - left, height);
    pen.clip();
    if (this.curves[1]) this.drawLine(pen, this.curves[1], 1, begin, x, y);
    if (this.count > 1.2 * (width - left)) this.drawColumns(pen, this.curves[0], end, width - left - 4, y);
    else this.drawLine(pen, this.curves[0], 0, begin, x, y);
    pen.restore();
  }

  /** A line through the values; what stays the same is one piece. */
  drawLine(pen, curve, c, begin, x, y) {
    let open = false, last = NaN;
    pen.beginPath();
    for (let k = 0; k < this.count; k++) {
      const i = (this.first + k) % this.room, value = curve[i];
      if (this.time[i] < begin - 0.1) continue;
      if (c && open && value === last && k < this.count - 1) continue;
      if (Number.isNaN(value)) open = false;
      else if (open) {
        if (c) pen.lineTo(x(this.time[i]), y(last));
        pen.lineTo(x(this.time[i]), y(value));
      } else pen.moveTo(x(this.time[i]), y(value)), (open = true);
      last = value;
    }
    pen.strokeStyle = this.paint[c];
    pen.lineWidth = c ? 1 : 1.5;
    pen.setLineDash(c ? [5, 4] : []);
    pen.stroke();
  }

  /** Of more values than pixels the least and the largest of each column, as upright bars: much less
   *  work than a line that goes to and fro. Columns belong to times, so that they do not flicker. */
  drawColumns(pen, curve, end, columns, y) {
    const each = this.seconds / columns, latest = Math.floor(end / each);
    let column = null, low = 0, high = 0, before = NaN;
    pen.fillStyle = this.paint[0];
    const put = () => pen.fillRect(this.width - 4 - (latest - column), y(high) - 0.75, 1, y(low) - y(high) + 1.5);
    for (let k = 0; k < this.count; k++) {
      const i = (this.first + k) % this.room, at = Math.floor(this.time[i] / each), value = curve[i];
      if (at < latest - columns) continue;
      if (Number.isNaN(value)) {
        if (column !== null) put();
        column = null;
        before = NaN;
        continue;
      }
      if (at !== column) {
        if (column !== null) put();
        [column, low, high] = [at, value, value];
        if (before < low) low = before;
        if (before > high) high = before;
      } else if (value < low) low = value;
      else if (value > high) high = value;
      before = value;
    }
    if (column !== null) put();
  }

  drawGrid(pen, left, y) {
    const [low, high] = this.scale;
    const raw = (high - low) / 4, power = 10 ** Math.floor(Math.log10(raw));
    const step = [1, 2, 5, 10].find((digit) => digit * power >= raw) * power;
    pen.font = '12px system-ui, sans-serif';
    pen.textAlign = 'right';
    pen.textBaseline = 'middle';
    pen.fillStyle = this.paint[3];
    pen.strokeStyle = this.paint[2];
    pen.lineWidth = 1;
    pen.setLineDash([]);
    for (let k = Math.ceil(low / step); k * step <= high; k++) {
      pen.beginPath();
      pen.moveTo(left, y(k * step));
      pen.lineTo(this.width, y(k * step));
      pen.stroke();
      pen.fillText(tickText(k * step, step), left - 6, y(k * step));
    }
  }
}

/** A number of an axis with the digits that its step needs. */
function tickText(value, step) {
  if (value === 0) return '0';
  const size = Math.abs(value);
  const digits = Math.max(1, Math.floor(Math.log10(size)) - Math.floor(Math.log10(step)) + 1);
  if (size >= 1e6 || size < 1e-4) return value.toExponential(Math.min(digits - 1, 6)).replace('e+', 'e').replace('-', '−');
  return String(Number(value.toPrecision(Math.min(digits, 9)))).replace('-', '−');
}
