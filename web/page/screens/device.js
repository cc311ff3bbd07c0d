// SPDX-License-Identifier: Apache-2.0
// A sensor of the catalogue, of a data sheet or of the reader's own: its Allan curve, its class and
// why, and how far a navigator with it drifts under conditions that are moved by sliders.
//
// Names for tests: #device-source-catalogue|sheet|file (radio buttons), #device-search, #device-list,
// #device-beside, #data-sheet (#sheet-text; fields data-key="gyro.bias.repeatability" …),
// #device-file-input, #device-entry, #device-grade, #device-drift (data-part="status|error|result"),
// #device-sliders. Address: #device/NAME.

'use strict';

const sheetFile = 'datasheet.yaml';

const aidChoices = [
  ['', 'none'],
  ['gnss position 3 m, velocity 0.1 m/s at 1 Hz until 5 min', 'GNSS for 5 min: 3 m, 0.1 m/s each second'],
  ['gnss position 3 m, velocity 0.1 m/s at 1 Hz', 'GNSS throughout: 3 m, 0.1 m/s each second'],
  ['zero velocity 1 cm/s every 10 s', 'zero velocity every 10 s'],
  ['height 1 m at 1 Hz', 'height, 1 m each second'],
  ['heading 1 deg at 1 Hz', 'heading, 1° each second'],
];

screens.device = {
  title: 'Choose a sensor',
  kept: true,
  show(root) {
    this.screen = new DeviceScreen(root);
  },
  arrive(name) {
    this.screen.arrive(name);
  },
};

class DeviceScreen {
  constructor(root) {
    this.settings = { duration: '60 min', latitude: '45 deg', yaw: '0 deg', 'initial-attitude': '0 deg', aligned: 'given', aid: '' };
    this.name = null;
    this.entry = new VerbView({ id: 'device-entry' });
    this.graded = new VerbView({ id: 'device-grade' });
    this.drift = new VerbView({ id: 'device-drift', own: true });
    this.sheet = new DataSheet({ change: settled(() => this.takeSheet(), 400) });
    this.renewDrift = settled(() => this.showDrift());
    root.append(element('h1', {}, 'What does a sensor do for me?'), element('div', { class: 'two' },
      element('div', { class: 'beside' }, this.makeSources(), this.makeConditions()),
      element('div', {}, element('h2', { id: 'device-name' }, 'No sensor chosen yet'), this.makeEntry(), this.drift.root, this.graded.root)));
  }

  /* ---- which sensor ---- */

  makeSources() {
    const tab = (value, text) => element('label', {}, element('input', { type: 'radio', name: 'device-source', value, id: 'device-source-' + value,
      checked: value === 'catalogue', onchange: () => this.showSource(value) }), ' ' + text);
    this.sources = { catalogue: this.makeCatalogue(), sheet: this.sheet.root, file: this.makeFile() };
    const made = element('section', { 'aria-label': 'Sensor' }, element('fieldset', { class: 'tabs' }, element('legend', {}, 'The sensor is'),
      tab('catalogue', 'in the catalogue, or mine'), tab('sheet', 'on a data sheet'), tab('file', 'a model file')), Object.values(this.sources), this.makeBeside());
    this.showSource('catalogue');
    return made;
  }

  showSource(chosen) {
    for (const [name, part] of Object.entries(this.sources)) part.hidden = name !== chosen;
    document.getElementById('device-source-' + chosen)?.setAttribute('checked', '');
    if (chosen === 'sheet') this.takeSheet();
  }

  makeCatalogue() {
    this.search = element('input', { type: 'search', id: 'device-search', oninput: () => this.fill(), autocomplete: 'off' });
    this.list = element('select', { id: 'device-list', size: 9, class: 'list', onchange: () => this.choose(this.list.value) });
    return element('div', {}, element('div', { class: 'field' }, element('label', { for: 'device-search' }, 'Search'), this.search),
      element('div', { class: 'field' }, element('label', { for: 'device-list' }, 'Sensors'), this.list));
  }

  makeFile() {
    const choice = new FileChoice({ id: 'device-file', label: 'Choose a model file', several: false, paste: false, change: async () => {
      if (choice.files.length === 0) return;
      const [name, content] = choice.files[0];
      sensors.keep(name, new Uint8Array(await content.arrayBuffer()));
      this.choose(name);
    } });
    return choice.root;
  }

  /** A second sensor in all results, or none. */
  makeBeside() {
    this.beside = element('select', { id: 'device-beside', onchange: () => this.showAll() }, element('option', { value: '' }, 'none'));
    return element('div', { class: 'field' }, element('label', { for: 'device-beside' }, 'Compare with'), this.beside);
  }

  async fill() {
    const value = this.name, other = this.beside.value;
    this.list.replaceChildren(...(await sensorOptions(this.search.value)));
    this.beside.replaceChildren(element('option', { value: '' }, 'none'), ...(await sensorOptions()));
    if (value) this.list.value = value;
    this.beside.value = other;
    if (this.beside.selectedIndex < 0) this.beside.selectedIndex = 0;
  }

  async arrive(name) {
    await this.fill();
    if (name) this.choose(name === 'mine' ? 'model.yaml' : name);
    else if (!this.name) this.choose('tactical');
  }

  takeSheet() {
    const text = this.sheet.text.value;
    if (!/^(gyro|accel):/m.test(text) || this.sources.sheet.hidden) return;
    sensors.keep(sheetFile, new TextEncoder().encode(text));
    this.choose(sheetFile);
  }

  choose(name) {
    if (!name) return;
    this.name = name;
    this.list.value = name;
    document.getElementById('device-name').textContent = name === sheetFile ? 'The sensor of the data sheet' : name;
    history.replaceState(null, '', '#device/' + encodeURIComponent(name));
    this.showAll();
  }

  names() {
    return [this.name, this.beside.value].filter((name, i, all) => name && all.indexOf(name) === i);
  }

  /* ---- what it does ---- */

  /** Source, notes and model file. */
  makeEntry() {
    return element('details', { class: 'wide' }, element('summary', {}, 'Its model file and where the figures are from'), this.entry.root);
  }

  async showAll() {
    if (!this.name) return;
    this.renewDrift();
    const turn = (this.turn = (this.turn || 0) + 1), names = this.names(), files = sensors.files(names);
    const words = ['grade', ...sensors.words(names), '--report', 'grade.html'];
    const done = await this.graded.run([...words, '--json'], { files });
    if (turn !== this.turn) return;
    if (!done) this.graded.result.replaceChildren();
    else this.graded.showReport(fileOf(done, 'grade.html'), { after: [terminalLine([words])], edit: (article) => this.arrange(article) });
    this.showEntry();
  }

  /** The noise first; the maps have a screen of their own. @return what stands below the judgement */
  arrange(article) {
    const maps = sectionOf(article, 'Maps');
    for (const node of maps) node.remove();
    return [...sectionOf(article, 'Noise'), element('p', {}, element('a', { href: '#grades/' + encodeURIComponent(this.name) }, 'Where it stands on the maps of technologies'), '.')];
  }

  async showEntry() {
    const own = sensors.own.get(this.name), words = ['devices', this.name];
    const text = own ? decodeText(own) : ((await this.entry.run(words)) || { out: '' }).out;
    this.entry.result.replaceChildren(element('pre', { tabindex: '0' }, text),
      downloadButtons([['Model (YAML)', own ? this.name : this.name.replace(/\W+/g, '-') + '.yaml', text]]), own ? '' : terminalLine([words]));
  }

  /** Sliders and choices: each change computes the drift anew. */
  makeConditions() {
    const slider = (option, label, text, unit, minimum, maximum, logarithmic) => makeSlider({ label, text, unit, minimum, maximum, logarithmic,
      change: (value) => this.set(option, value) }).row;
    const select = (option, label, choices) => element('div', { class: 'field' }, element('label', { for: 'device-' + option }, label),
      element('select', { id: 'device-' + option, onchange: (event) => this.set(option, event.target.value) },
        choices.map(([value, text]) => element('option', { value }, text))));
    return element('section', { 'aria-labelledby': 'device-how', id: 'device-sliders' }, element('h2', { id: 'device-how' }, 'It navigates'),
      slider('duration', 'for', '60 min', 'min', 0.2, 1440, true),
      slider('latitude', 'at latitude', '45 deg', 'deg', -89, 89),
      slider('yaw', 'with the heading', '0 deg', 'deg', -180, 180),
      slider('initial-attitude', 'with an attitude error at the start, 1 sigma, of', '0 deg', 'deg', 0, 2),
      select('aligned', 'with an attitude that is', [['given', 'known at the start, but for this error'], ['self', 'found at rest by the unit itself']]),
      select('aid', 'with updates', aidChoices));
  }

  set(option, value) {
    this.settings[option] = value;
    if (this.drift.waiting && performance.now() - this.began > 700) this.drift.cancel();
    this.renewDrift();
    return '';
  }

  driftWords() {
    const { settings } = this, words = ['drift', ...sensors.words(this.names())];
    for (const option of ['duration', 'latitude', 'yaw', 'initial-attitude']) words.push('--' + option, settings[option]);
    if (settings.aligned !== 'given') words.push('--aligned', settings.aligned);
    if (settings.aid) words.push('--aid', settings.aid);
    return [...words, '--report', 'drift.html'];
  }

  async showDrift() {
    const words = this.driftWords(), names = this.names().join();
    this.began = performance.now();
    // What was drawn of another sensor would be read as this one's.
    if (names !== this.drawn) this.drift.result.replaceChildren();
    const begin = this.settings.aid ? 'Computing, about two seconds for each hour with updates …' : 'Computing …';
    const done = await this.drift.run([...words, '--json'], { files: sensors.files(this.names()), begin });
    if (!done) return;
    this.drawn = names;
    this.drift.showReport(fileOf(done, 'drift.html'), { after: [terminalLine([words])] });
  }
}
