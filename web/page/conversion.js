// SPDX-License-Identifier: Apache-2.0
// A model as the parameter file of another program.

'use strict';

// Those that hold noise, but Gazebo's, whose XML the page does not write.
const noiseFormats = ['kalibr', 'openvins', 'vins', 'orb-slam3', 'lio-sam', 'fast-lio', 'dlio', 'glim', 'gtsam', 'airsim', 'matlab',
  'gnss-ins-sim', 'navego', 'filter'];

/** The usual name of such a file. */
function parameterFile(format) {
  const names = { matlab: 'imu.json', 'gnss-ins-sim': 'imu.txt', navego: 'imu.m', airsim: 'settings.json', gtsam: 'imu.txt' };
  return names[format] || 'imu.yaml';
}

/** Choose, convert, take away. model: the bytes of its file; interval: of its log, or none. */
function makeConversion(model, { interval }) {
  const option = ([value, text]) => element('option', { value }, text);
  const format = element('select', { id: 'log-format' }, noiseFormats.map((name) => element('option', {}, name)));
  const walk = element('select', { id: 'log-walk' }, [['', 'nothing'], ['--use-bounds', 'the largest walk that the log allows'],
    ['--bias-instability-tau 10s', 'bias instability as a walk, right at 10 s'], ['--bias-instability-tau 100s', 'bias instability as a walk, right at 100 s']].map(option));
  const view = new VerbView({ id: 'log-converted' });
  const scans = element('input', { type: 'text', id: 'log-scans', value: '10Hz', autocomplete: 'off', spellcheck: 'false' });
  const scansField = element('div', { class: 'field', hidden: true }, element('label', { for: 'log-scans' }, 'Scans of the LiDAR per second'), scans);
  format.addEventListener('change', () => (scansField.hidden = format.value !== 'glim'));
  const rate = interval ? `${Number((1 / interval.value).toPrecision(6))}Hz` : '100Hz';
  const convert = async () => {
    const words = ['convert', 'model.yaml', 'imu.yaml', '--to', format.value, '--rate', rate, ...(format.value === 'glim' ? ['--frame-rate', scans.value] : []), ...shellWords(walk.value)];
    const done = await view.run([...words, '--json'], { files: [['model.yaml', model]] });
    const made = done && fileOf(done, 'imu.yaml');
    view.result.replaceChildren();
    if (!made) return;
    const notes = (done.json.findings || []).map(({ message }) => element('li', {}, message));
    view.result.append(element('pre', { tabindex: '0' }, decodeText(made)), element('ul', { 'data-part': 'notes' }, notes),
      downloadButtons([[`Parameters for ${format.value}`, parameterFile(format.value), made]]), terminalLine([words]));
  };
  return element('div', { class: 'conversion' }, element('div', { class: 'fields' },
    element('div', { class: 'field' }, element('label', { for: 'log-format' }, 'As parameters of another program'), format), scansField,
    element('div', { class: 'field' }, element('label', { for: 'log-walk' }, 'Where the log shows no random walk of the bias, and the program needs one'), walk)),
    element('button', { type: 'button', id: 'log-kalibr', onclick: convert }, 'Convert'), view.root);
}
