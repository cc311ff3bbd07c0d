// SPDX-License-Identifier: Apache-2.0
// Files of the reader's: dropped, chosen, pasted as text; several, each under a name of its own.

'use strict';

/** Is it the companion of one of these files? LOG.npy.columns names the columns of LOG.npy. */
const isCompanion = (name, files) => files.some(([other]) => name === other + '.columns');

/** Is it the same file of the disk, chosen again? Texts and what is made here are no files. */
const isSameFile = (one, other) => one instanceof File && other instanceof File && one.name === other.name &&
  one.size === other.size && one.lastModified === other.lastModified;

class FileChoice {
  /** change: is called when files have come or gone. paste: whether a text can be pasted. */
  constructor({ id, label, change, paste = true, several = true }) {
    Object.assign(this, { files: [], change, several });
    this.input = element('input', { type: 'file', id: id + '-input', multiple: several, class: 'unseen', onchange: () => this.chosen() });
    this.list = element('ul', { class: 'files', 'data-part': 'files' });
    this.note = element('p', { class: 'note', role: 'status', hidden: true });
    this.zone = element('div', { class: 'drop' },
      element('label', { for: id + '-input', class: 'choose' }, label), ' ',
      element('span', {}, several ? 'or drop files here' : 'or drop a file here'));
    this.listen();
    this.root = element('section', { id, class: 'file-choice', 'aria-label': label }, this.input, this.zone,
      paste ? this.makePaste(id) : null, this.note, this.list);
  }

  listen() {
    const { zone } = this, mark = (on) => (event) => {
      event.preventDefault();
      zone.classList.toggle('over', on);
    };
    for (const kind of ['dragenter', 'dragover']) zone.addEventListener(kind, mark(true));
    zone.addEventListener('dragleave', mark(false));
    zone.addEventListener('drop', (event) => {
      mark(false)(event);
      this.dropped(event.dataTransfer);
    });
  }

  makePaste(id) {
    const text = element('textarea', { id: id + '-text', rows: 6, spellcheck: 'false', placeholder: 'time [s],gyro_x [deg/s],gyro_y [deg/s],gyro_z [deg/s]\n0.00,0.011,-0.204,0.048' });
    const take = () => {
      if (text.value.trim()) this.add([['pasted.csv', new Blob([text.value.replace(/\n?$/, '\n')])]]);
    };
    return element('details', { class: 'paste' }, element('summary', {}, 'Paste text'),
      element('label', { for: text.id }, 'Lines of a log, with or without a header'), text,
      element('button', { type: 'button', onclick: take, 'data-part': 'take' }, 'Take this text'));
  }

  chosen() {
    const files = [...this.input.files];
    this.input.value = '';
    this.add(files.map((file) => [file.name, file]));
  }

  dropped(transfer) {
    const folders = [...transfer.items].map((item) => item.webkitGetAsEntry && item.webkitGetAsEntry())
      .filter((entry) => entry && entry.isDirectory).map((entry) => entry.name);
    this.add([...transfer.files].filter((file) => !folders.includes(file.name)).map((file) => [file.name, file]));
    if (folders.length > 0)
      this.say(`${folders[0]} is a folder, which this page cannot read. A folder of rosbag2 becomes a file by: ${commandLine(['convert', folders[0], folders[0] + '.csv.zst'])}`);
  }

  say(text) {
    this.note.hidden = !text;
    this.note.textContent = text;
  }

  /** The files but for companions, which only go along with what is read. */
  logs() {
    return this.files.filter(([name]) => !isCompanion(name, this.files));
  }

  /** Keep the last file, with its companion, and the newer of two of one name. */
  keepLast(files) {
    const all = [...this.files.filter(([name]) => !files.some(([other]) => other === name)), ...files];
    const [last] = all.filter(([name]) => !isCompanion(name, all)).at(-1);
    this.files = [];
    return all.filter(([name]) => name === last || isCompanion(name, [[last]]));
  }

  /** files: [[name, File or Blob], …]. Without `several` the last one counts. */
  add(files) {
    if (files.length === 0) return;
    this.say('');
    if (!this.several) files = this.keepLast(files);
    this.files = this.files.filter(([, kept]) => !files.some(([, content]) => isSameFile(kept, content)));
    const taken = new Set(this.files.map(([name]) => name)), come = [];
    // A log before the names of its columns, which are called after it.
    for (const [name, content] of [...files].sort(([one], [other]) => isCompanion(one, files) - isCompanion(other, files))) {
      const log = [...come, ...this.files].find(([free, { name: given = free }]) => name === given + '.columns' && !taken.has(free + '.columns'));
      const free = freeName(log ? log[0] + '.columns' : name, taken);
      taken.add(free);
      come.push([free, content]);
    }
    this.files.push(...come);
    this.show();
    this.change();
  }

  remove(name) {
    this.files = this.files.filter(([other]) => other !== name);
    this.show();
    this.input.focus();
    this.change();
  }

  show() {
    const size = ({ size, length }) => {
      const bytes = size ?? length;
      return bytes < 1e6 ? `${Math.ceil(bytes / 1000)} kB` : `${(bytes / 1e6).toFixed(1)} MB`;
    };
    this.list.replaceChildren(...this.files.map(([name, content]) => element('li', {},
      element('span', { class: 'file-name' }, name), ` ${size(content)} `,
      element('button', { type: 'button', 'aria-label': `Remove ${name}`, onclick: () => this.remove(name) }, 'Remove'))));
  }
}
