// SPDX-License-Identifier: Apache-2.0
// A log: dropped or chosen, looked at, identified, and its results to look at and to take away.
//
// Names for tests: #log-files (-input: the field for files; -text), #log-example, #log-options
// (fields data-option="rate" …), #log-info, #log-go, #log-identify (data-part="status|cancel|error|
// result|terminal|downloads"), #log-sort (of several logs), #log-kalibr, a[href="#device/mine"].

'use strict';

screens.log = {
  title: 'My log',
  kept: true,
  show(root) {
    new LogScreen(root);
  },
};

/** Can two logs be runs of one sensor? They have the same channels at the same rate. */
function belongTogether(one, other) {
  const channels = ({ columns }) => columns.map(({ name }) => name).filter((name) => /^(gyro|accel)/.test(name)).sort().join();
  const [a, b] = [one, other].map(({ interval }) => interval?.value);
  return channels(one) === channels(other) && !(Math.abs(a - b) > 0.01 * b);
}

class LogScreen {
  constructor(root) {
    this.choice = new FileChoice({ id: 'log-files', label: 'Choose a log', change: () => {
      this.made = null;
      this.look();
    } });
    this.options = new ReadingOptions({ id: 'log-options', change: () => this.look() });
    this.about = new VerbView({ id: 'log-info', own: true });
    this.identified = new VerbView({ id: 'log-identify', own: true });
    this.sort = element('div', { class: 'buttons', id: 'log-sort' });
    this.go = element('button', { type: 'button', id: 'log-go', class: 'main', hidden: true, onclick: () => this.identify() }, 'Identify');
    this.turn = 0;
    root.append(element('h1', {}, 'What is my sensor worth?'),
      element('p', {}, 'Record the sensor at rest, for an hour or more, and put the log here: text or CSV, .npy, .npz, PX4 ULog, ArduPilot .bin, ROS 1 bag, MCAP, UBX and others, also compressed. You get its noise with intervals, a verdict on the log, and a model to use elsewhere.'),
      this.choice.root,
      element('p', { class: 'no-print' }, 'No log at hand? ', element('button', { type: 'button', id: 'log-example', onclick: () => this.example() }, 'Take an example: an hour of a tactical unit, simulated')),
      this.options.root, this.about.root, this.sort, this.go, this.identified.root);
  }

  /** An hour of a log, made here. */
  async example() {
    const words = ['simulate', 'tactical', '--rate', '100Hz', '--duration', '1h', '--seed', '1', '-o', 'example.csv'];
    this.about.clear();
    const done = await this.about.run(words);
    if (!done) return;
    this.choice.files = [];
    this.choice.add([['example.csv', new Blob([fileOf(done, 'example.csv')])]]);
    this.made = words;
  }

  /** What is in the logs, and what is missing; a log of a sensor at rest is identified at once. */
  async look() {
    const turn = ++this.turn, logs = this.choice.logs();
    if (this.identified.waiting) this.identified.cancel();
    this.identified.clear();
    this.about.clear();
    this.go.hidden = true;
    this.sort.replaceChildren();
    this.go.textContent = 'Identify';
    const records = [], errors = [];
    for (const [name] of logs) {
      const record = await this.lookAt(name, turn);
      if (turn !== this.turn) return;
      if (record) records.push(record);
      else if (this.about.error) errors.push(this.about.error);
    }
    if (errors.length > 0) { // of the first one, what is missing stays to be seen
      this.about.showProblem(errors[0]);
      this.options.mark(errors[0]);
    }
    if (logs.length === 0 || records.length < logs.length) return;
    this.go.hidden = false;
    if (logs.length > 1) this.askSort(records);
    else if (records[0].motion === 'at_rest') this.identify();
    else this.about.result.append(this.hintOfRest(records[0].motion));
  }

  /** Why a log is not identified at once. */
  hintOfRest(motion) {
    const parts = { poses: ['It rests in several poses, which is for ', element('a', { href: '#calibrate' }, 'calibration'), '.'],
      moves: ['It moves. If it also rests, choose that part above: leave out before, leave out after.'],
      unknown: ['Whether this one rested cannot be told: its gyros or accelerometers are missing, or it has less than three seconds without holes. If it did, identify it.'] };
    this.options.root.open ||= motion === 'moves';
    return element('p', { 'data-part': 'rest' }, 'Noise is identified from a sensor at rest. ', parts[motion]);
  }

  /** @return the record of a log that can be identified; null if something is missing */
  async lookAt(name, turn) {
    const words = ['info', operand(name), ...this.options.words()];
    const done = await this.about.run([...words, '--json'], { files: this.choice.files, begin: `Reading ${name} …` });
    if (turn !== this.turn) return null;
    const error = done ? done.json.error : this.about.error;
    if (error && error.message.includes('the page cannot read')) // but the command can: core/absent.c
      this.about.showProblem({ ...error, next: commandLine(['convert', operand(name), name.replace(/\.\w+$/, '') + '.npz']) });
    const result = done && done.json.result;
    this.options.mark(error);
    if (result) this.about.result.append(this.summary(name, done.json, words));
    if (error && this.choice.logs().length > 1)
      this.about.result.append(...(result ? [] : [element('h2', {}, name)]), element('p', { class: 'failed' }, error.message));
    if (!result || error) return null;
    const readable = result.topics.filter((topic) => topic.readable);
    if (readable.length > 1 && !this.options.value('topic')) {
      this.askTopic(readable);
      return null;
    }
    return result.record;
  }

  /** What is in a log, in the words of `info`. */
  summary(name, { inputs, result }, words) {
    const { usability, record } = result;
    const made = this.made ? [this.made] : [];
    return element('div', { class: 'summary' }, element('h2', {}, name),
      element('p', {}, `${inputs.format}. ${usability ? usability.sentence : ''}`),
      record ? this.columns(record) : null, terminalLine([...made, words]));
  }

  columns({ rows, columns, rows_from: from }) {
    const shown = columns.map(({ name, unit }) => `${name} [${unit || '?'}]`).join(', ');
    return element('p', { class: 'weak' }, `${rows} ${rows === 1 ? 'row' : 'rows'}${from === 'size' ? ', by its size' : ''}: ${shown}`);
  }

  /** Which of the sensors in a log. */
  askTopic(topics) {
    const take = ({ topic, instance }) => () => {
      this.options.set('topic', topic);
      this.options.set('instance', instance > 0 ? String(instance) : '');
      this.look();
    };
    this.about.result.append(element('p', {}, 'Which of its sensors?'), element('div', { class: 'buttons', 'data-part': 'topics' },
      topics.map((entry) => element('button', { type: 'button', onclick: take(entry) },
        `${entry.topic}${entry.instance > 0 ? `, instance ${entry.instance}` : ''}, ${entry.samples ?? '?'} samples`))));
  }

  /** Several logs: of what? Those of other channels or another rate are no runs of one sensor. */
  askSort(records) {
    const alike = records.every((record) => belongTogether(record, records[0]));
    const choice = (value, text) => element('label', {}, element('input', { type: 'radio', name: 'sort', value, checked: value === (alike ? 'runs' : 'compare'),
      onchange: () => this.nameGo() }), ' ' + text);
    this.sort.replaceChildren(element('fieldset', {}, element('legend', {}, 'These logs are'),
      choice('runs', 'runs of one sensor: one model, and what changes from run to run'),
      choice('devices', 'of different sensors of one type: their mean and spread'),
      choice('compare', 'to be compared: Allan deviations of each, channel by channel, without a model')));
    this.nameGo();
  }

  /** What is done with several logs; '' with one. */
  sortOf() {
    const chosen = this.sort.querySelector('input:checked');
    return chosen ? chosen.value : '';
  }

  nameGo() {
    this.go.textContent = this.sortOf() === 'compare' ? 'Compare' : 'Identify';
    this.go.hidden = false;
  }

  async identify() {
    const turn = this.turn, { files } = this.choice, taken = new Set(files.map(([name]) => name));
    const names = this.choice.logs().map(([name]) => operand(name)), reading = this.options.words(), sort = this.sortOf();
    const [report, model] = [freeName('report.html', taken), freeName('model.yaml', taken)];
    const words = sort === 'compare' ? ['allan', ...names, ...reading, '--report', report]
      : ['identify', ...names, ...(sort ? ['--' + sort] : []), ...reading, '-o', model, '--report', report];
    this.go.hidden = true;
    const done = await this.identified.run([...words, '--json'], { files, begin: sort === 'compare' ? 'Comparing …' : 'Identifying …' });
    if (turn !== this.turn) return;
    this.go.hidden = Boolean(done) && !sort;
    this.options.mark(this.identified.error);
    if (done) this.showIdentified(done, words, report, model);
  }

  showIdentified(done, words, report, model) {
    const page = fileOf(done, report), bytes = fileOf(done, model);
    const offers = [['Model (YAML)', 'model.yaml', bytes], ['Report (HTML)', 'report.html', page], ['Numbers (JSON)', words[0] + '.json', done.out]];
    const beside = [downloadButtons(offers.filter(([, , content]) => content))];
    const after = [];
    if (bytes) {
      sensors.keep('model.yaml', bytes);
      beside.push(element('p', {}, 'What would it cost me? ', element('a', { href: '#device/model.yaml' }, 'How far a navigator with this sensor drifts'), ', and ',
        element('a', { href: '#grades/model.yaml' }, 'where it stands among others'), '.'));
      after.push(element('h2', {}, 'For another program'), makeConversion(bytes, done.json.inputs));
    }
    after.push(terminalLine([words]));
    if (page) this.identified.showReport(page, { beside, after });
    else this.identified.result.replaceChildren(element('pre', { tabindex: '0' }, done.out), ...beside, ...after);
    this.identified.comeIntoView();
  }
}
