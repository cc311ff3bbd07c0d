/* SPDX-License-Identifier: Apache-2.0 */
/* A panel drawn anew as SVG from its numbers: axes, regions, curves, in the sizes and styles of
 * figure_svg.c. A panel has `data` (figure_data.c), `x` and `y`, the axes as they are shown,
 * `curves` with those laid over, and `hidden`, the names of curves that are switched off. */
'use strict';

const imukitPanel = (() => {
  const {ticksOf, drawable, placeOf} = imukitAxes;
  const tickRoom = {x: 50, y: 36}, row = 13, bandWidth = 2; // [px]

  /* An element of SVG with its attributes and what it contains. */
  function svg(name, attributes, ...content) {
    const made = document.createElementNS('http://www.w3.org/2000/svg', name);
    for (const key of Object.keys(attributes))
      made.setAttribute(key, attributes[key]);
    made.append(...content);
    return made;
  }

  const pen = document.createElement('canvas').getContext('2d');
  function widthOf(text, size = 11) {
    if (!pen)
      return 0.62 * size * text.length;
    pen.font = `${size}px 'DejaVu Sans', Verdana, sans-serif`;
    return pen.measureText(text).width;
  }

  /* A line of text, shortened in the middle to the width that there is. */
  function line(text, x, y, room, attributes, size = 11) {
    let shown = text;
    while (shown.length > 5 && widthOf(shown, size) > room) {
      const kept = shown.replace('…', '').length - 1;
      shown = `${text.slice(0, Math.ceil(kept / 2))}…${text.slice(-Math.floor(kept / 2))}`;
    }
    return svg('text', {x: x.toFixed(1), y: y.toFixed(1), ...attributes}, shown);
  }

  /* ---- curves ------------------------------------------------------------------------------ */

  /* Points of {x, y, lower, upper} from the numbers of a curve; null is a gap. */
  function pointsOf(curve) {
    const points = [], p = curve.points;
    for (let i = 0; i < p.length; i += Math.max(curve.width, 2)) {
      if (p[i] === null)
        points.push(null);
      else if (curve.width === 3)
        points.push({x: p[i], lower: p[i + 1], upper: p[i + 2]});
      else
        points.push({x: p[i], y: p[i + 1], ...(curve.width === 4 && {lower: p[i + 2], upper: p[i + 3]})});
    }
    return points;
  }

  const isFilled = curve => curve.style === 'band' || curve.style === 'layer';
  const isLine = curve => ['line', 'dashes', 'over-line'].includes(curve.style);

  /* Where a point is drawn [px]; null: nowhere. */
  function spotOf(panel, curve, point) {
    if (!point || !drawable(panel.x, point.x))
      return null;
    const {frame} = panel, at = value => frame.bottom - placeOf(panel.y, value) * frame.height;
    const bounded = drawable(panel.y, point.lower) && drawable(panel.y, point.upper);
    if (isFilled(curve) ? !bounded : !drawable(panel.y, point.y))
      return null;
    const spot = {x: frame.left + placeOf(panel.x, point.x) * frame.width};
    if (bounded) {
      spot.lower = at(point.lower);
      spot.upper = at(point.upper);
    }
    spot.y = isFilled(curve) ? (spot.lower + spot.upper) / 2 : at(point.y);
    return spot;
  }

  const f = value => value.toFixed(1);

  /* The part of a segment within the frame; null: none. Dashes of a line that leaves a deep zoom
   * by a million pixels would take minutes. */
  function clip({left, right, top, bottom}, from, to) {
    const dx = to.x - from.x, dy = to.y - from.y;
    let begin = 0, end = 1;
    for (const [step, room] of [[-dx, from.x - left], [dx, right - from.x], [-dy, from.y - top],
      [dy, bottom - from.y]]) {
      if (step === 0 && room < 0)
        return null;
      if (step < 0)
        begin = Math.max(begin, room / step);
      else if (step > 0)
        end = Math.min(end, room / step);
    }
    const at = part => ({x: from.x + part * dx, y: from.y + part * dy});
    return begin <= end ? [at(begin), at(end)] : null;
  }

  /* A point between two gaps is a dot. */
  function linePath(spots, frame) {
    let path = '', pen = '';
    spots.forEach((spot, i) => {
      const before = spots[i - 1], place = spot && `${f(spot.x)} ${f(spot.y)}`;
      const part = spot && before && clip(frame, before, spot);
      if (part) {
        const [from, to] = part.map(end => `${f(end.x)} ${f(end.y)}`);
        path += `${from === pen ? '' : `M${from}`}L${to}`;
        pen = to;
      } else if (spot && !before && !spots[i + 1] && clip(frame, spot, spot)) {
        path += `M${place}h.1`;
      }
    });
    return path;
  }

  function bandPath(spots) {
    let path = '', run = [];
    for (const spot of [...spots, null]) {
      if (spot) {
        run.push(spot);
        continue;
      }
      if (run.length === 1)
        run = [-bandWidth / 2, bandWidth / 2].map(shift => ({...run[0], x: run[0].x + shift}));
      if (run.length > 0)
        path += `M${run.map(s => `${f(s.x)} ${f(s.upper)}`).join('L')}L` +
          `${run.reverse().map(s => `${f(s.x)} ${f(s.lower)}`).join('L')}z`;
      run = [];
    }
    return path;
  }

  const dotPath = spots => spots.map(s => s ? `M${f(s.x)} ${f(s.y)}h0` : '').join('');
  const markPath = spots => spots.map(s => s ? `M${f(s.x)} ${f(s.y - 8)}l8 8l-8 8l-8-8z` : '').join('');
  const barPath = spots => spots.map(s =>
    s && s.lower !== undefined ? `M${f(s.x)} ${f(s.lower)}V${f(s.upper)}` : '').join('');

  function curveElements(panel, curve) {
    const spots = curve.points.map(point => spotOf(panel, curve, point));
    const make = isFilled(curve) ? bandPath : isLine(curve) ? linePath
      : curve.style === 'marks' ? markPath : dotPath;
    const made = [svg('path', {class: `${curve.style} c${curve.color}`, d: make(spots, panel.frame)})];
    if (curve.bars)
      made.unshift(svg('path', {class: `bars c${curve.color}`, d: barPath(spots)}));
    return made;
  }

  /* A piece of the curve, for the key. */
  function sample(curve) {
    const d = isFilled(curve) ? 'M0 2h22v8h-22z' : isLine(curve) ? 'M1 6h20'
      : curve.style === 'marks' ? 'M11 0l6 6l-6 6l-6-6z' : 'M11 6h.1';
    return svg('svg', {width: 22, height: 12, viewBox: '0 0 22 12', 'aria-hidden': true},
      svg('path', {class: `${curve.style} c${curve.color}`, d}));
  }

  /* ---- regions ----------------------------------------------------------------------------- */

  /* A limit that cannot be drawn, such as infinity, becomes the limit of the frame. */
  function boxOf(panel, region) {
    const {frame, x, y} = panel, [xLow, xHigh, yLow, yHigh] = region.limits;
    const limit = (axis, value, high) => drawable(axis, value)
      ? Math.max(0, Math.min(1, placeOf(axis, value))) : Number(high);
    return {left: frame.left + frame.width * limit(x, xLow, false),
      right: frame.left + frame.width * limit(x, xHigh, true),
      bottom: frame.bottom - frame.height * limit(y, yLow, false),
      top: frame.bottom - frame.height * limit(y, yHigh, true)};
  }

  function regionElement(panel, region) {
    const box = boxOf(panel, region);
    return svg('rect', {class: `region c${region.color}${region.dashed ? ' dashed' : ''}`,
      x: f(box.left), y: f(box.top), width: f(Math.max(box.right - box.left, 0)),
      height: f(Math.max(box.bottom - box.top, 0))});
  }

  /* Names keep clear of one another and of marks, by moving down. */
  function regionNames(panel) {
    const placed = [], {frame} = panel;
    for (const curve of panel.curves.filter(c => c.style === 'marks' && !panel.hidden.has(c.group)))
      for (const spot of curve.points.map(point => spotOf(panel, curve, point)))
        if (spot)
          placed.push({left: spot.x - 7, right: spot.x + 7, top: spot.y - 7, bottom: spot.y + 7});
    return panel.data.regions.filter(region => {
      const box = boxOf(panel, region);
      return region.label && box.right > box.left && box.bottom > box.top;
    }).map(region => {
      const box = boxOf(panel, region), width = Math.min(widthOf(region.label), frame.width - 10);
      const left = Math.max(frame.left + 5, Math.min(frame.right - 5 - width,
        region.right ? box.right - 5 - width : box.left + 5));
      const name = {left, right: left + width, top: box.top + 3, bottom: box.top + 3 + row};
      const inWay = other => name.left < other.right && other.left < name.right &&
        name.top < other.bottom && other.top < name.bottom;
      while (name.bottom + row <= frame.bottom && placed.some(inWay)) {
        name.top += row;
        name.bottom += row;
      }
      placed.push(name);
      return line(region.label, left, name.bottom - 3, frame.width - 10,
        {class: `region-name c${region.color}`});
    });
  }

  /* ---- axes and texts ---------------------------------------------------------------------- */

  function layOut(panel, width, height) {
    const {data} = panel, notes = data.note ? data.note.split('\n') : [];
    const frame = {top: data.title ? 36 : 30, right: width - 14};
    frame.bottom = height - 24 - (data.x.label ? 18 : 0) - 14 * notes.length;
    frame.height = frame.bottom - frame.top;
    const y = ticksOf(panel.y, frame.height, tickRoom.y);
    frame.left = (data.y.label ? 20 : 0) + 16 + Math.max(...y.map(tick => widthOf(tick.text)), 0);
    frame.width = Math.max(frame.right - frame.left, 40);
    panel.frame = frame;
    let x = [], room = tickRoom.x;
    for (let tries = 0; tries < 3; tries++) {
      x = ticksOf(panel.x, frame.width, room);
      const needed = Math.max(...x.map(tick => widthOf(tick.text)), 0) + 16;
      if (needed <= room)
        break;
      room = needed;
    }
    return {x, y, notes};
  }

  function grid(frame, ticks, labelled) {
    const those = list => list.filter(tick => Boolean(tick.text) === labelled);
    const xs = those(ticks.x).map(t => `M${f(frame.left + t.place * frame.width)} ${f(frame.top)}v${f(frame.height)}`);
    const ys = those(ticks.y).map(t => `M${f(frame.left)} ${f(frame.bottom - t.place * frame.height)}h${f(frame.width)}`);
    return svg('path', {class: labelled ? 'coarse' : 'fine', d: [...xs, ...ys].join('')});
  }

  function axisLines(frame, ticks) {
    const length = tick => tick.text ? 4 : 2;
    const xs = ticks.x.map(t => `M${f(frame.left + t.place * frame.width)} ${f(frame.bottom)}v${length(t)}`);
    const ys = ticks.y.map(t => `M${f(frame.left)} ${f(frame.bottom - t.place * frame.height)}h-${length(t)}`);
    return svg('path', {class: 'axis',
      d: `M${f(frame.left)} ${f(frame.top)}V${f(frame.bottom)}H${f(frame.right)}${xs.join('')}${ys.join('')}`});
  }

  /* Labels that would run into the one before are left out. */
  function tickLabels(frame, ticks) {
    const made = [];
    let end = -Infinity;
    for (const tick of ticks.x.filter(t => t.text)) {
      const x = frame.left + tick.place * frame.width, half = widthOf(tick.text) / 2;
      if (x - half >= end + 6) {
        made.push(svg('text', {x: f(x), y: f(frame.bottom + 17), 'text-anchor': 'middle'}, tick.text));
        end = x + half;
      }
    }
    end = Infinity;
    for (const tick of ticks.y.filter(t => t.text)) {
      const y = frame.bottom - tick.place * frame.height;
      if (y <= end - 13) {
        made.push(svg('text', {x: f(frame.left - 7), y: f(y + 4), 'text-anchor': 'end'}, tick.text));
        end = y;
      }
    }
    return made;
  }

  function names(panel, width, notes) {
    const {data, frame} = panel, middle = frame.left + frame.width / 2;
    const half = frame.top + frame.height / 2, centred = {class: 'large', 'text-anchor': 'middle'};
    return [
      line(data.title, middle, 20, 2 * Math.min(middle, width - middle) - 8,
        {...centred, class: 'large title'}, 13),
      line(data.x.label, middle, frame.bottom + 36, width - 16, centred, 12),
      ...notes.map((note, i) => line(note, frame.left, frame.bottom + 52 + 14 * i,
        width - frame.left - 4, {})),
      line(data.y.label, 13, half, frame.height + 30,
        {...centred, transform: `rotate(-90 13 ${f(half)})`}, 12)];
  }

  /* ---- all of it --------------------------------------------------------------------------- */

  /* Draw a panel of this size, and say in panel.frame where its axes are. The last group is empty:
   * it is for what follows the pointer. */
  function draw(panel, width, height) {
    const ticks = layOut(panel, width, height), {frame, data} = panel;
    const shown = panel.curves.filter(curve => !panel.hidden.has(curve.group));
    const box = {x: f(frame.left), y: f(frame.top), width: f(frame.width), height: f(frame.height)};
    return svg('svg', {width, height, viewBox: `0 0 ${width} ${height}`, role: 'img',
      'aria-label': `${data.title}${data.title ? ': ' : ''}${data.y.label} against ${data.x.label}`},
      grid(frame, ticks, false), grid(frame, ticks, true),
      svg('svg', {...box, viewBox: `${box.x} ${box.y} ${box.width} ${box.height}`},
        ...data.regions.map(region => regionElement(panel, region)),
        ...shown.flatMap(curve => curveElements(panel, curve))),
      axisLines(frame, ticks), ...tickLabels(frame, ticks), ...names(panel, width, ticks.notes),
      ...regionNames(panel), svg('g', {class: 'pointed'}));
  }

  return {draw, svg, pointsOf, spotOf, boxOf, sample, isFilled};
})();
