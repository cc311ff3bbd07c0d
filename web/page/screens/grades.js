// SPDX-License-Identifier: Apache-2.0
// The maps of technologies and classes with sensors on them, and the classes with their numbers.
//
// Names for tests: #grades-add, #grades-list, #grades-map (which map), #grades-class, #grades-view.
// Address: #grades/NAME.

'use strict';

screens.grades = {
  title: 'Grade map',
  kept: true,
  show(root) {
    this.screen = new GradesScreen(root);
  },
  arrive(name) {
    this.screen.arrive(name);
  },
};

class GradesScreen {
  constructor(root) {
    this.names = [];
    this.view = new VerbView({ id: 'grades-view' });
    this.add = element('select', { id: 'grades-add', onchange: () => (this.include(this.add.value), (this.add.value = '')) });
    this.list = element('ul', { class: 'files', id: 'grades-list' });
    this.map = element('select', { id: 'grades-map', onchange: () => this.selectMap() });
    this.assumed = element('select', { id: 'grades-class', onchange: () => this.renew() },
      [['none', 'left out, and named'], ['own', 'taken as is typical of the class']].map(([value, text]) => element('option', { value }, text)));
    this.renew = settled(() => this.show(), 50);
    const field = (label, control) => element('div', { class: 'field' }, element('label', { for: control.id }, label), control);
    root.append(element('h1', {}, 'Where does a sensor stand?'),
      element('p', {}, 'Five classes, from control system to strategic, by the bias that stays after calibration and by the error of position that all terms make together.'),
      element('div', { class: 'fields no-print' }, field('Put on the maps', this.add), field('Map', this.map), field('What a model does not state is', this.assumed)),
      this.list, this.view.root);
  }

  async arrive(name) {
    this.add.replaceChildren(element('option', { value: '' }, 'a sensor …'), ...(await sensorOptions()));
    const mine = [...sensors.own.keys()].at(-1);
    if (name) this.include(name);
    else if (this.names.length === 0) this.include(mine || 'tactical');
  }

  include(name) {
    if (!name || this.names.includes(name)) return;
    this.names = [...this.names, name].slice(-8); // the verb takes eight
    this.showNames();
  }

  showNames() {
    const remove = (name) => () => {
      this.names = this.names.filter((other) => other !== name);
      this.showNames();
      this.add.focus();
    };
    this.list.replaceChildren(...this.names.map((name) => element('li', {}, element('span', { class: 'file-name' }, name), ' ',
      element('button', { type: 'button', 'aria-label': `Take ${name} off the maps`, onclick: remove(name) }, 'Remove'))));
    this.renew();
  }

  async show() {
    if (this.names.length === 0) {
      this.view.clear();
      return;
    }
    const words = ['grade', ...sensors.words(this.names), ...(this.assumed.value === 'none' ? [] : ['--assume-class', this.assumed.value]), '--report', 'grade.html'];
    const done = await this.view.run(words, { files: sensors.files(this.names) });
    if (!done) return;
    this.view.showReport(fileOf(done, 'grade.html'), terminalLine([words]));
    this.nameMaps();
  }

  panels() {
    return [...this.view.result.querySelectorAll('figure.panels .panel')];
  }

  /** The maps that there are, by the titles in their numbers. */
  nameMaps() {
    const before = this.map.value;
    const titles = this.panels().map((panel) => JSON.parse(panel.querySelector('script').textContent).title);
    this.map.replaceChildren(element('option', { value: '' }, 'all'), ...titles.map((title, i) => element('option', { value: i }, title)));
    this.map.value = before;
    if (this.map.selectedIndex < 0) this.map.value = '';
    this.selectMap();
  }

  /** One map has the room of all. */
  selectMap() {
    const chosen = this.map.value;
    this.panels().forEach((panel, i) => (panel.hidden = chosen !== '' && Number(chosen) !== i));
    for (const figure of this.view.result.querySelectorAll('figure.panels')) figure.classList.toggle('one-map', chosen !== '');
  }
}
