/* SPDX-License-Identifier: Apache-2.0 */
/* Other sensors laid over the Allan deviations of a figure: those of the catalogue, whose curves
 * the page holds, and those of files that the reader chooses. A file is read here and goes nowhere.
 *
 * A layer is {name, curves}; a curve is {channel, si, unit, style, points}. Its points are in SI
 * units where `si` names them, else in `unit`. */
'use strict';

const imukitOverlay = (() => {
  const {html, button, say} = imukitPage;
  const colors = [3, 4, 5, 2, 1, 0, 6, 7];
  const isDeviation = name => ['adev', 'oadev', 'totdev'].includes(name);

  /* A point in a unit that is `scale` times as small. */
  function scaled(point, scale) {
    const times = value => value === null ? null : value * scale; // null: an open limit
    const limits = point.lower !== undefined &&
      {lower: times(point.lower), upper: times(point.upper)};
    return {x: point.x, y: times(point.y), ...limits};
  }

  /* ---- layers -------------------------------------------------------------------------------- */

  function layerOfSensor(catalogue, sensor) {
    const curves = ['rad/s', 'm/s^2'].filter(si => sensor[si]).map(si => ({channel: '', si, style: 'over-line',
      points: catalogue.tau.map((x, i) => ({x, y: sensor[si][i]}))}));
    return {name: sensor.name, curves};
  }

  function curveOfAllan(channel) {
    const {unit} = channel.points[0].deviation;
    return {channel: channel.name, si: unit, unit, style: 'points', points: channel.points.map(p =>
      ({x: p.tau.value, y: p.deviation.value, lower: p.lower.value, upper: p.upper.value}))};
  }

  /* The curve of the terms that were identified, by their closed forms [IEEE952]. */
  function curveOfTerms(channel) {
    const of = (...names) => names.map(name => channel.terms[name]).find(Boolean) || {value: 0};
    const q = of('quantization').value, b = of('bias_instability').value;
    const n = of('angle_random_walk', 'velocity_random_walk').value;
    const k = of('rate_random_walk', 'acceleration_random_walk').value;
    const r = of('rate_ramp', 'acceleration_ramp').value;
    const {unit} = of('bias_instability'), points = [];
    for (let i = -12; i <= 20; i++) {
      const x = 10 ** (i / 4);
      points.push({x, y: Math.sqrt(3 * (q / x) ** 2 + n * n / x + 2 * Math.LN2 / Math.PI * b * b +
        k * k * x / 3 + (r * x) ** 2 / 2)});
    }
    return {channel: channel.name, si: unit, unit, style: 'over-line',
      points: points.filter(point => point.y > 0)};
  }

  function curvesOfJson(text) {
    const {command, result} = JSON.parse(text);
    const channels = result && Array.isArray(result.channels) ? result.channels : [];
    if (command === 'allan')
      return channels.filter(c => isDeviation(c.statistic) && c.points.length > 0).map(curveOfAllan);
    return channels.filter(c => c.terms).map(curveOfTerms);
  }

  /* What was measured, from the numbers beside the figures of another page. */
  function curvesOfPage(text) {
    const page = new DOMParser().parseFromString(text, 'text/html');
    const panels = [...page.querySelectorAll('.panel > script[type="application/json"]')];
    return panels.map(script => JSON.parse(script.textContent)).filter(data => data.allan)
      .flatMap(data => data.curves.filter(c => c.style === 'points' && c.label !== 'twin').map(curve => {
        const scale = data.unit ? data.unit.scale : 1;
        return {channel: curve.label === 'log' ? data.title : curve.label, style: 'points',
          si: data.unit && data.unit.si, unit: unitOf(data),
          points: imukitPanel.pointsOf(curve).filter(Boolean).map(point => scaled(point, scale))};
      }));
  }

  /* The beginning tells pages and JSON from logs, which can be long. */
  async function layerOfFile(file) {
    const begin = (await file.slice(0, 200).text()).trimStart()[0];
    const read = {'{': curvesOfJson, '<': curvesOfPage}[begin];
    const curves = read ? read(await file.text()) : [];
    if (curves.length === 0)
      throw new Error('no Allan deviations');
    return {name: file.name.replace(/\.(html?|json)$/i, ''), curves};
  }

  /* ---- layers on panels ---------------------------------------------------------------------- */

  const unitOf = data => (/\[([^\]]*)\]\s*$/.exec(data.y.label) || ['', ''])[1];

  /* The curves of a layer that belong on a panel: of the channel that it shows, else all that have
   * its dimension. */
  function curvesFor(data, layer, color) {
    const fitting = layer.curves.filter(curve => data.unit && curve.si ? curve.si === data.unit.si
      : curve.unit === unitOf(data));
    const same = fitting.filter(curve => curve.channel === data.title);
    const chosen = same.length > 0 ? same : fitting;
    return chosen.map((curve, i) => {
      const scale = data.unit && curve.si ? data.unit.scale : 1;
      const label = chosen.length > 1 ? `${layer.name} ${curve.channel}` : layer.name;
      return {label, group: label, style: curve.style, color: (color + i) % colors.length,
        bars: curve.style === 'points', points: curve.points.map(point => scaled(point, 1 / scale))};
    });
  }

  /* ---- the control --------------------------------------------------------------------------- */

  function choices(catalogue) {
    const group = (label, grade) => html('optgroup', {label}, ...catalogue.sensors
      .filter(sensor => sensor.grade === grade && (sensor['rad/s'] || sensor['m/s^2']))
      .map(sensor => html('option', {value: sensor.name}, sensor.name)));
    return html('select', {}, group('Grades', true), group('Devices', false));
  }

  /* A control above the panels of a figure; none if none of them shows Allan deviations. */
  function attach(figure, panels) {
    const stored = figure.closest('.imukit').querySelector('script.catalogue');
    if (panels.length === 0 || !stored)
      return;
    const catalogue = JSON.parse(stored.textContent), select = choices(catalogue);
    const input = html('input', {type: 'file', multiple: '', accept: '.html,.htm,.json', hidden: ''});
    const problem = html('span', {class: 'problem', role: 'alert'});
    let layers = [];
    const show = () => {
      remove.hidden = layers.length === 0;
      for (const panel of panels)
        panel.layOver(layers.flatMap((layer, i) => curvesFor(panel.data, layer, colors[i % colors.length])));
    };
    const add = ({name, curves}) => {
      const own = panels.some(panel => panel.own.some(curve => curve.group === name));
      const layer = {name: own ? `${name}, laid over` : name, curves}; // has a key of its own
      layers = [...layers.filter(other => other.name !== layer.name), layer];
      const used = panels.some(panel => curvesFor(panel.data, layer, 0).length > 0);
      problem.textContent = used ? '' : `${layer.name} has no sensor of the kinds that are shown here.`;
      if (used)
        say(`${layer.name} is laid over`, false);
      else
        layers.pop();
      show();
    };
    const remove = button('Take away', 'Take away what is laid over', () => {
      layers = [];
      problem.textContent = '';
      show();
    });
    remove.hidden = true;
    /* By a button, because arrow keys in a list choose all that they pass. */
    const choose = button('Add', 'Lay the sensor over the figure', () => {
      const sensor = catalogue.sensors.find(s => s.name === select.value);
      if (sensor)
        add(layerOfSensor(catalogue, sensor));
    });
    input.addEventListener('change', async () => {
      for (const file of [...input.files])
        try {
          add(await layerOfFile(file));
        } catch (error) {
          problem.textContent = `${file.name} holds no Allan deviations. Choose a page that imukit ` +
            'allan or imukit identify wrote with --report, or what they print with --json.';
        }
      input.value = '';
    });
    figure.querySelector('.panes').before(html('div', {class: 'over'},
      html('label', {}, 'Lay over ', select), choose,
      button('A file …', 'Lay over a report or what --json printed', () => input.click()),
      input, remove, problem));
  }

  return {attach};
})();
