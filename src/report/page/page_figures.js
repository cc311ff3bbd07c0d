/* SPDX-License-Identifier: Apache-2.0 */
/* Makes the figures and tables of a page interactive; without it the page is complete. Nothing is
 * fetched and nothing is stored.
 *
 * imukitFigures.attach(element) does it for all that is below an element, such as an article that
 * was put into a page later. What is interactive already stays as it is. imukitFigures.setDark(true)
 * makes the page dark, whatever the system is; false: light. */
'use strict';

const imukitFigures = (() => {
  const {number, digitsFor, drawable, placeOf} = imukitAxes;
  const {svg, spotOf, isFilled} = imukitPanel;
  const {html, button, say} = imukitPage;
  const zoomStep = 1.5, dragLeast = 6, reach = 60; // factor, [px], [px]

  /* "root density [ug/sqrt(Hz)], two-sided" is a name and a unit. */
  function nameAndUnit(label) {
    const found = /^(.*?)\s*\[([^\]]*)\](.*)$/.exec(label);
    return found ? {name: found[1] + found[3], unit: found[2] === '1' ? '' : found[2]}
      : {name: label, unit: ''};
  }

  /* Curves with points; one without a name goes with the first of its colour that has one. */
  function curvesOf(data) {
    return data.curves.map(curve => {
      const named = curve.label ? curve : data.curves.find(c => c.label && c.color === curve.color);
      return {...curve, points: imukitPanel.pointsOf(curve), group: named ? named.label : ''};
    });
  }

  class Panel {
    constructor(root, alone) {
      this.root = root;
      this.alone = alone;
      this.data = JSON.parse(root.querySelector('script').textContent);
      this.own = curvesOf(this.data);
      this.curves = this.own;
      this.hidden = new Set();
      this.pointed = null; // {curve, index}
      this.reset();
      this.readout = html('div', {class: 'readout', hidden: ''});
      this.plot = html('div', {class: 'plot', tabindex: 0, role: 'application',
        'aria-roledescription': 'chart', 'aria-label': this.name()}, this.readout);
      this.key = html('div', {class: 'key'});
      this.tools = html('div', {class: 'tools'},
        button('+', 'Zoom in', () => this.zoom(1 / zoomStep)),
        button('−', 'Zoom out', () => this.zoom(zoomStep)),
        button('↺', 'Show all', () => this.show(null)));
      this.listen();
      new ResizeObserver(() => Math.floor(root.clientWidth) !== this.width && this.later()).observe(root);
    }

    name() {
      const {title, x, y} = this.data;
      return `${title}${title ? ': ' : ''}${y.label} against ${x.label}. ` +
        'Arrow keys step through the points, plus and minus zoom, Escape shows all.';
    }

    reset() {
      this.x = {...this.data.x};
      this.y = {...this.data.y};
      this.zoomed = false;
    }

    /* ---- drawing ---- */

    /* Draw once before the next picture on the screen, whatever calls for it. */
    later() {
      if (!this.due)
        requestAnimationFrame(() => {
          this.due = false;
          this.draw();
        });
      this.due = true;
    }

    draw() {
      const width = Math.floor(this.root.clientWidth);
      if (width < 40) // is not shown
        return;
      this.width = width;
      const ratio = this.alone ? 0.6 : this.data.regions.length > 0 ? 0.74 : 0.8;
      const height = Math.round(Math.max(250, Math.min(560, ratio * width)));
      const drawing = imukitPanel.draw(this, width, height);
      if (this.drawing)
        this.drawing.replaceWith(drawing);
      else
        this.takeOver(drawing);
      this.drawing = drawing;
      this.pointer = drawing.querySelector('.pointed');
      this.plot.classList.toggle('zoomed', this.zoomed);
      this.tools.classList.toggle('zoomed', this.zoomed);
      this.point(this.pointed, false);
    }

    /* The first drawing stands in for the one that came with the page. */
    takeOver(drawing) {
      this.plot.prepend(drawing);
      this.root.querySelector('svg').remove();
      this.root.classList.add('live');
      this.root.prepend(this.plot, html('div', {class: 'foot'}, this.key, this.tools));
      this.drawKey();
    }

    drawKey() {
      const groups = [...new Set(this.curves.filter(c => c.label).map(c => c.label))];
      this.key.replaceChildren(...groups.map(group => {
        const curve = this.curves.find(c => c.label === group);
        const made = html('button', {type: 'button', 'aria-pressed': !this.hidden.has(group)},
          imukitPanel.sample(curve), html('span', {}, group));
        made.addEventListener('click', () => {
          if (!this.hidden.delete(group))
            this.hidden.add(group);
          made.setAttribute('aria-pressed', !this.hidden.has(group));
          this.point(null);
          this.later();
        });
        return made;
      }));
    }

    /* Curves of other sensors over those of the page, within what is shown. */
    layOver(curves) {
      this.curves = [...this.own, ...curves];
      for (const name of this.hidden)
        if (!this.curves.some(curve => curve.group === name))
          this.hidden.delete(name);
      this.reset();
      for (const point of curves.flatMap(curve => curve.points)) {
        if (!point || !drawable(this.data.x, point.x) || !drawable(this.data.y, point.y))
          continue;
        const at = placeOf(this.data.x, point.x), y = Math.log10(point.y);
        if (at >= 0 && at <= 1) {
          this.y.low = Math.min(this.y.low, y - 0.1);
          this.y.high = Math.max(this.y.high, y + 0.1);
        }
      }
      this.drawKey();
      this.point(null);
      this.later();
    }

    /* ---- zoom ---- */

    /* Show a part of the axes; null: all. */
    show(part) {
      if (part) {
        for (const name of ['x', 'y']) {
          const {low, high} = part[name], all = this.data[name];
          const span = (high - low) / (all.high - all.low);
          if (span > (all.log ? 1e-3 : 1e-6) && span < 8)
            Object.assign(this[name], {low, high});
        }
        this.zoomed = true;
      } else if (this.curves.length > this.own.length) {
        this.layOver(this.curves.slice(this.own.length));
      } else {
        this.reset();
      }
      this.later();
    }

    /* About a place of the frame, 0 … 1 from its lower left corner. */
    zoom(factor, x = 0.5, y = 0.5) {
      const part = (axis, at) => {
        const span = axis.high - axis.low, centre = axis.low + at * span;
        return {low: centre - at * span * factor, high: centre + (1 - at) * span * factor};
      };
      this.show({x: part(this.x, x), y: part(this.y, y)});
    }

    move(x, y) {
      const part = (axis, by) => {
        const shift = by * (axis.high - axis.low);
        return {low: axis.low + shift, high: axis.high + shift};
      };
      this.show({x: part(this.x, x), y: part(this.y, y)});
    }

    /* ---- the point that is looked at ---- */

    visible() {
      return this.curves.filter(curve => !this.hidden.has(curve.group));
    }

    within(spot) {
      const {frame} = this;
      return spot && spot.x >= frame.left - 1 && spot.x <= frame.right + 1 &&
        spot.y >= frame.top - 1 && spot.y <= frame.bottom + 1;
    }

    /* The point nearest to a place [px]; bands only where there is nothing else near. */
    nearest(x, y) {
      let best = null, least = Infinity;
      for (const curve of this.visible()) {
        const far = isFilled(curve) ? reach ** 2 : 0;
        if (isFilled(curve) && !curve.label)
          continue;
        curve.points.forEach((point, index) => {
          const spot = spotOf(this, curve, point);
          if (!this.within(spot))
            return;
          const dy = isFilled(curve) && y > spot.upper && y < spot.lower ? 0 : spot.y - y;
          const distance = (spot.x - x) ** 2 + dy ** 2 + far;
          if (distance < least) {
            least = distance;
            best = {curve, index, distance};
          }
        });
      }
      return best;
    }

    /* What is told of a point, line by line: the curve, x, y, the interval. A layer's value is its
     * height. */
    linesOf({curve, index}) {
      const point = curve.points[index], {lower, upper} = point, layer = curve.style === 'layer';
      const told = [curve.label || curve.group || this.data.title, this.quantity('x', point.x)];
      if (point.y !== undefined || layer)
        told.push(this.quantity('y', layer ? upper - lower : point.y));
      if (lower !== undefined && lower !== null && !layer)
        told.push(this.quantity('y', lower, upper, point.y === undefined ? '' : 'interval'));
      return told;
    }

    /* "averaging time: 10.24 s", or with an upper limit "… to …". */
    quantity(axis, value, upper, instead) {
      const {name, unit} = nameAndUnit(this.data[axis].label), digits = digitsFor(this.data[axis]);
      const text = v => v === null ? 'open' : number(v, digits);
      return `${instead || name}: ${text(value)}${upper === undefined ? '' : ` to ${text(upper)}`}` +
        `${unit ? ` ${unit}` : ''}`;
    }

    /* The smallest region at a place, where no point is near. */
    regionAt(x, y) {
      return this.data.regions.map(region => ({region, box: imukitPanel.boxOf(this, region)}))
        .filter(({box}) => x >= box.left && x <= box.right && y >= box.top && y <= box.bottom)
        .sort((a, b) => (a.box.right - a.box.left) * (a.box.bottom - a.box.top) -
          (b.box.right - b.box.left) * (b.box.bottom - b.box.top)).map(({region}) => region)[0];
    }

    /* Tell what is at a place [px]. */
    hover(x, y) {
      const at = this.nearest(x, y), region = this.regionAt(x, y);
      this.point(at && region && at.distance > reach ** 2 / 4 ? null : at);
      if (this.pointed || !region)
        return;
      const [xLow, xHigh, yLow, yHigh] = region.limits;
      this.tell([region.label, this.quantity('x', xLow, xHigh), this.quantity('y', yLow, yHigh)],
        {x, y});
    }

    tell(lines, spot) {
      this.readout.replaceChildren(html('b', {}, lines[0]),
        ...lines.slice(1).map(text => html('div', {}, text)));
      this.readout.hidden = false;
      this.placeReadout(spot);
    }

    /* Show a point, or none; `aloud` for readers who hear the page. */
    point(at, aloud = false) {
      const spot = at && spotOf(this, at.curve, at.curve.points[at.index]);
      this.pointed = this.within(spot) ? at : null;
      this.readout.hidden = !this.pointed;
      if (this.pointer)
        this.pointer.replaceChildren();
      if (!this.pointed)
        return;
      const {frame} = this, told = this.linesOf(at);
      this.pointer.append(
        svg('path', {class: 'cross',
          d: `M${spot.x} ${frame.top}V${frame.bottom}M${frame.left} ${spot.y}H${frame.right}`}),
        svg('circle', {class: `spot c${at.curve.color}`, cx: spot.x, cy: spot.y, r: 4.5}));
      this.tell(told, spot);
      if (aloud)
        say(told.join(', '), false);
    }

    /* Beside the point, away from the nearer side. */
    placeReadout(spot) {
      const {offsetWidth: width, offsetHeight: height} = this.readout;
      const room = this.plot.clientWidth;
      const left = spot.x + 14 + width <= room ? spot.x + 14 : spot.x - 14 - width;
      this.readout.style.left = `${Math.max(0, Math.min(left, room - width))}px`;
      this.readout.style.top = `${spot.y > height + 24 ? spot.y - 14 - height : spot.y + 14}px`;
    }

    /* To the next point of the curve that can be seen; from none to the first. */
    step(by) {
      const seen = this.visible(), named = seen.filter(c => c.label && !isFilled(c));
      const curve = this.pointed ? this.pointed.curve
        : named.filter(c => this.own.includes(c)).pop() || named[0] || seen[0];
      if (!curve)
        return;
      let index = this.pointed ? this.pointed.index + Math.sign(by) : by > 0 ? 0 : curve.points.length - 1;
      if (Math.abs(by) > 1)
        index = by > 0 ? curve.points.length - 1 : 0;
      const towards = Math.abs(by) > 1 ? -Math.sign(by) : Math.sign(by);
      while (curve.points[index] !== undefined &&
          !this.within(spotOf(this, curve, curve.points[index])))
        index += towards;
      if (curve.points[index] !== undefined)
        this.point({curve, index}, true);
    }

    /* To the point of another curve that is nearest along the axis. */
    change(by) {
      const curves = this.visible().filter(c => c.label || !isFilled(c));
      if (!this.pointed || curves.length === 0)
        return this.step(1);
      const from = spotOf(this, this.pointed.curve, this.pointed.curve.points[this.pointed.index]);
      const begin = curves.indexOf(this.pointed.curve);
      for (let k = 1; k <= curves.length; k++) {
        const curve = curves[(begin + by * k + curves.length * k) % curves.length];
        let best = -1, least = Infinity;
        curve.points.forEach((point, index) => {
          const spot = spotOf(this, curve, point);
          if (this.within(spot) && Math.abs(spot.x - from.x) < least) {
            least = Math.abs(spot.x - from.x);
            best = index;
          }
        });
        if (best >= 0)
          return this.point({curve, index: best}, true);
      }
      return undefined;
    }

    /* ---- pointer and keys ---- */

    listen() {
      const {plot} = this, here = event => {
        const box = this.drawing.getBoundingClientRect(), scale = this.drawing.width.baseVal.value / box.width;
        return {x: (event.clientX - box.left) * scale, y: (event.clientY - box.top) * scale};
      };
      plot.addEventListener('pointerdown', event => {
        const at = here(event);
        if (event.button !== 0)
          return;
        if (event.pointerType === 'touch') // what was told elsewhere goes
          plot.focus({preventScroll: true});
        if (event.pointerType === 'touch' && !this.zoomed)
          return void this.hover(at.x, at.y);
        this.drag = {from: at, to: at, moves: event.shiftKey || event.pointerType === 'touch'};
        plot.setPointerCapture(event.pointerId);
      });
      plot.addEventListener('pointermove', event => {
        const at = here(event);
        if (!this.drag)
          return void this.hover(at.x, at.y);
        if (this.drag.moves)
          this.move((this.drag.to.x - at.x) / this.frame.width, (at.y - this.drag.to.y) / this.frame.height);
        this.drag.to = at;
        if (!this.drag.moves)
          this.drawChoice();
      });
      plot.addEventListener('pointerup', event => {
        const {drag} = this;
        this.drag = null;
        if (drag && !drag.moves)
          this.choose(drag);
        if (drag && event.pointerType === 'touch')
          this.hover(here(event).x, here(event).y);
      });
      plot.addEventListener('pointercancel', () => { this.drag = null; });
      plot.addEventListener('pointerleave', event => {
        if (!this.drag && event.pointerType !== 'touch') // a finger always leaves
          this.point(null);
      });
      plot.addEventListener('blur', () => this.point(null));
      plot.addEventListener('dblclick', () => this.show(null));
      plot.addEventListener('wheel', event => {
        if (!event.ctrlKey)
          return;
        event.preventDefault();
        const at = here(event);
        this.zoom(event.deltaY > 0 ? zoomStep : 1 / zoomStep,
          (at.x - this.frame.left) / this.frame.width, (this.frame.bottom - at.y) / this.frame.height);
      }, {passive: false});
      plot.addEventListener('keydown', event => this.press(event));
    }

    press(event) {
      const shift = event.shiftKey, actions = {
        ArrowLeft: () => shift ? this.move(-0.1, 0) : this.step(-1),
        ArrowRight: () => shift ? this.move(0.1, 0) : this.step(1),
        ArrowUp: () => shift ? this.move(0, 0.1) : this.change(1),
        ArrowDown: () => shift ? this.move(0, -0.1) : this.change(-1),
        Home: () => this.step(-2),
        End: () => this.step(2),
        '+': () => this.zoom(1 / zoomStep),
        '-': () => this.zoom(zoomStep),
        Escape: () => {
          if (this.drag) {
            this.drag = null;
            this.pointer.replaceChildren();
          } else {
            this.show(null);
          }
        }
      };
      if (event.ctrlKey || event.metaKey || event.altKey || !actions[event.key])
        return;
      event.preventDefault();
      actions[event.key]();
    }

    /* The part of the frame that a drag has chosen; all of an axis along which it hardly went. */
    chosen({from, to}) {
      const {frame} = this, clamp = (v, low, high) => Math.max(low, Math.min(high, v));
      const [x0, x1] = [from.x, to.x].sort((a, b) => a - b).map(x => clamp(x, frame.left, frame.right));
      const [y0, y1] = [from.y, to.y].sort((a, b) => a - b).map(y => clamp(y, frame.top, frame.bottom));
      const wide = x1 - x0 >= dragLeast, high = y1 - y0 >= dragLeast;
      if (!wide && !high)
        return null;
      return {left: wide ? x0 : frame.left, right: wide ? x1 : frame.right,
        top: high ? y0 : frame.top, bottom: high ? y1 : frame.bottom};
    }

    drawChoice() {
      const box = this.chosen(this.drag);
      this.point(null);
      if (box)
        this.pointer.append(svg('rect', {class: 'choice', x: box.left, y: box.top,
          width: box.right - box.left, height: box.bottom - box.top}));
    }

    choose(drag) {
      const box = this.chosen(drag), {frame, x, y} = this;
      this.pointer.replaceChildren();
      if (!box)
        return;
      const across = at => x.low + (at - frame.left) / frame.width * (x.high - x.low);
      const along = at => y.low + (frame.bottom - at) / frame.height * (y.high - y.low);
      this.show({x: {low: across(box.left), high: across(box.right)},
        y: {low: along(box.bottom), high: along(box.top)}});
    }
  }

  /* ---- all of an element --------------------------------------------------------------------- */

  const attached = new WeakSet();

  /* The elements below a root that are not interactive yet. */
  function fresh(root, selector) {
    const found = [...root.querySelectorAll(selector)].filter(element => !attached.has(element));
    found.forEach(element => attached.add(element));
    return found;
  }

  function attach(root) {
    for (const figure of fresh(root, '.imukit figure.panels')) {
      const roots = [...figure.querySelectorAll('.panel')];
      const panels = roots.map(panel => new Panel(panel, roots.length === 1));
      panels.forEach(panel => panel.draw());
      imukitOverlay.attach(figure, panels.filter(panel => panel.data.allan));
    }
    fresh(root, '.imukit .table').forEach(imukitPage.attachTable);
    fresh(root, '.imukit-page article.imukit').forEach(imukitPage.attachTheme);
    imukitPage.keepDark();
    imukitPage.voice();
  }

  return {attach, setDark: imukitPage.setDark};
})();

imukitFigures.attach(document);
