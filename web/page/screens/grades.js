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
    const done = await this.view.run([...words, '--json'], { files: sensors.files(this.names) });
    if (!done) return;
    this.view.showReport(fileOf(done, 'grade.html'), { after: [terminalLine([words])], edit: (article) => this.arrange(article) });
    this.selectMap();
  }

  /** The maps first, each with the sources of its regions folded away. @return the maps */
  arrange(article) {
    const before = this.map.value;
    this.maps = [];
    for (const node of sectionOf(article, 'Maps').slice(1)) {
      if (node.matches('figure')) this.maps.push(element('section', {}, node));
      else this.maps.at(-1)?.append(node);
    }
    for (const map of this.maps) this.foldSources(map);
    sectionOf(article, 'Maps').forEach((node) => node.remove());
    const titles = this.maps.map((map) => JSON.parse(map.querySelector('figure script').textContent).title);
    this.map.replaceChildren(element('option', { value: '' }, 'all'), ...titles.map((title, i) => element('option', { value: i }, title)));
    this.map.value = before;
    if (this.map.selectedIndex < 0) this.map.value = '';
    return this.maps;
  }

  foldSources(map) {
    const folded = element('details', { class: 'wide' }, element('summary', {}, 'Where the regions are from'));
    folded.append(...[...map.children].filter((node) => !node.matches('figure')));
    map.append(folded);
  }

  /** One map, or all. */
  selectMap() {
    const chosen = this.map.value;
    (this.maps || []).forEach((map, i) => (map.hidden = chosen !== '' && Number(chosen) !== i));
  }
}
