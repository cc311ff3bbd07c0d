// SPDX-License-Identifier: Apache-2.0
// What a verb looks like on a screen: how far it is, with Cancel; its error; its page, as the report
// of the command; the same at a terminal. Names of parts: data-part="status|far|cancel|error|result|
// terminal".

'use strict';

/** A word of a command line as a shell reads it. */
function shellWord(word) {
  return /^[\w@%+=:,./-]+$/.test(word) ? word : `'${word.replace(/'/g, `'\\''`)}'`;
}

function commandLine(words) {
  return ['imukit', ...words].map(shellWord).join(' ');
}

/** A name under which a file can lie beside others: "log (2).csv" for the second log.csv. */
function freeName(name, taken) {
  const clean = [...(name || '').replace(/[\x00-\x1f\x7f/\\]/g, '_').replace(/^\.+$/, '_')].slice(-120).join('') || 'log';
  const [, stem, ending] = /^(.+?)((?:\.[^.]*){0,2})$/.exec(clean);
  let free = clean;
  for (let n = 2; taken.has(free); n++) free = `${stem} (${n})${ending}`;
  return free;
}

/** A file's name as an operand: what begins with a dash would be an option. */
function operand(name) {
  return name.startsWith('-') ? './' + name : name;
}

/** The article of a report, with headings one level down, since the screen has the first. */
function articleOf(page) {
  const article = document.adoptNode(new DOMParser().parseFromString(page, 'text/html').querySelector('article'));
  for (const level of [2, 1])
    for (const heading of article.querySelectorAll('h' + level)) {
      const lower = element('h' + (level + 1), { class: level === 1 ? 'title' : null });
      lower.append(...heading.childNodes);
      heading.replaceWith(lower);
    }
  return article;
}

/** The nodes of a section of an article: its heading and all up to the next one of its level. */
function sectionOf(article, title) {
  const heading = [...article.querySelectorAll('h3')].find(({ textContent }) => textContent === title), nodes = [];
  for (let node = heading; node && (node === heading || node.tagName !== 'H3'); node = node.nextElementSibling) nodes.push(node);
  return nodes;
}

/** A line of the command with a button that copies it. */
function terminalLine(lines, title = 'The same at a terminal') {
  const text = lines.map(commandLine).join('\n');
  return element('div', { class: 'terminal', 'data-part': 'terminal' }, element('p', {}, title),
    element('pre', { tabindex: '0' }, text),
    element('button', { type: 'button', onclick: () => copyText(text) }, 'Copy'));
}

/** Where the clipboard is closed to pages of files, a field that is selected is copied. */
async function copyText(text) {
  try {
    await navigator.clipboard.writeText(text);
  } catch (reason) {
    const field = element('textarea', { class: 'unseen', 'aria-hidden': 'true' }), before = document.activeElement;
    field.value = text;
    document.body.append(field);
    field.select();
    document.execCommand('copy');
    field.remove();
    if (before) before.focus({ preventScroll: true });
  }
}

const decodeText = (bytes) => new TextDecoder().decode(bytes);

/** A file that a verb has written. */
function fileOf(done, name) {
  const found = done.files.find(([made]) => made === name);
  return found && found[1];
}

/** What a verb printed with --json; null if it is no JSON. */
function jsonOf(done) {
  try {
    return JSON.parse(done.out);
  } catch (reason) {
    return null;
  }
}

/** One verb after the other in one place of a screen. With an engine of its own, Cancel stops it
 *  alone. */
class VerbView {
  constructor({ id, own = false }) {
    this.engine = own ? new Engine() : engine;
    this.said = element('span', { role: 'status', 'data-part': 'status' });
    this.far = element('span', { 'aria-hidden': 'true', 'data-part': 'far' }); // changes too often to be heard
    this.cancelButton = element('button', { type: 'button', hidden: true, 'data-part': 'cancel', onclick: () => this.cancel() }, 'Cancel');
    this.problem = element('div', { role: 'alert', class: 'failed', hidden: true, 'data-part': 'error' });
    this.result = element('div', { 'data-part': 'result', 'aria-busy': 'false' });
    this.root = element('section', { id, class: 'verb' },
      element('p', { class: 'progress' }, this.said, ' ', this.far, ' ', this.cancelButton), this.problem, this.result);
    this.waiting = 0;
  }

  cancel() {
    this.engine.cancel();
  }

  say(text, far = '') {
    if (this.said.textContent !== text) this.said.textContent = text;
    this.far.textContent = far;
  }

  /** Show an error in the command's words: { message, next }, or none. */
  showProblem(error) {
    this.error = error;
    this.problem.hidden = !error;
    this.problem.replaceChildren();
    if (!error) return;
    this.problem.append(element('p', {}, error.message));
    if (error.next) this.problem.append(element('pre', { tabindex: '0' }, error.next.replace(' --json', '')));
  }

  /** Do a verb and give what it did, with `json`; null when it was cancelled or gave nothing.
   *  begin: what is said until it tells how far it is. */
  async run(words, { files = [], begin = 'Computing …' } = {}) {
    this.waiting++;
    this.cancelButton.hidden = false;
    this.result.setAttribute('aria-busy', 'true');
    this.say(begin);
    try {
      const done = await this.engine.run(words, { files, progress: (line) => this.say(...line.split(/ {2}(.*)/, 2)) });
      done.json = jsonOf(done);
      this.say(`${words[0]}: ${(done.milliseconds / 1000).toFixed(2)} s`);
      return this.judge(words, done);
    } catch (reason) {
      if (!(reason instanceof Cancelled)) this.showProblem({ message: reason.message });
      this.say(reason instanceof Cancelled ? 'Cancelled.' : '');
      return null;
    } finally {
      this.waiting--;
      if (this.waiting === 0) this.cancelButton.hidden = true;
      this.result.setAttribute('aria-busy', 'false');
    }
  }

  /** Show why a verb has failed. What it printed in spite of that is given, too. */
  judge(words, done) {
    const error = done.json && done.json.error;
    if (error) this.showProblem(error);
    else if (done.code !== 0) this.showProblem({ message: done.err.trim() || `imukit ${words[0]} ended with ${done.code}` });
    else this.showProblem(null);
    return done.code === 0 || (done.json && done.json.result) ? done : null;
  }

  /** Show the report of a verb; what stood there stays until now.
   *  beside: elements below its first sentence; after: below all; edit: changes the article. */
  showReport(page, { beside = [], after = [], edit = () => [] } = {}) {
    const article = articleOf(decodeText(page)), judgement = article.querySelector('.judgement') || article.querySelector('.subtitle, .title');
    judgement.after(...beside, ...edit(article));
    this.result.replaceChildren(article, ...after);
    imukitFigures.attach(this.result);
  }

  /** Bring the result into view if it is below what is seen. */
  comeIntoView() {
    if (this.result.getBoundingClientRect().top > 0.4 * innerHeight) this.root.scrollIntoView({ block: 'start' });
  }

  clear() {
    this.showProblem(null);
    this.say('');
    this.result.replaceChildren();
  }
}

/** Do something when its cause has come to rest, and never twice at a time: a call while it is under
 *  way does it again afterwards. */
function settled(act, milliseconds = 150) {
  let timer = 0, busy = false, again = false;
  async function go() {
    if (busy) {
      again = true;
      return;
    }
    busy = true;
    try {
      await act();
    } finally {
      busy = false;
    }
    if (again) {
      again = false;
      go();
    }
  }
  return () => {
    clearTimeout(timer);
    timer = setTimeout(go, milliseconds);
  };
}

/** Buttons that offer files: [[label, name, bytes or text], …]. */
function downloadButtons(offers) {
  return element('div', { class: 'buttons', 'data-part': 'downloads' }, offers.map(([label, name, content]) =>
    element('button', { type: 'button', 'data-file': name, onclick: () => download(name, content) }, label)));
}
