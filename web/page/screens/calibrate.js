// SPDX-License-Identifier: Apache-2.0
// A bench session without equipment: the poses as the command plans them, one after the other with a
// picture of the next, then the log of the session, its result, and which poses to repeat.
//
// Names for tests: #calibrate-procedure, #calibrate-unit, #calibrate-position, #calibrate-plan
// (data-part="status|error|result"), #calibrate-poses (li), #calibrate-begin, #calibrate-rest,
// #calibrate-back, #calibrate-now, #calibrate-files-input, #calibrate-example, #calibrate-options,
// #calibrate-result (data-part=…, data-part="repeat").

'use strict';

const procedures = [
  ['multiposition', '20 attitudes, by hand: accelerometers and gyros'],
  ['sixposition', 'six faces of a square housing: accelerometers'],
  ['ferraris', 'six faces and a turn about each axis: both'],
  ['turns', 'turns about each axis: gyros alone'],
];

screens.calibrate = {
  title: 'Calibrate by poses',
  kept: true,
  show(root) {
    this.screen = new CalibrateScreen(root);
  },
  arrive() {
    this.screen.arrive();
  },
};

class CalibrateScreen {
  constructor(root) {
    this.plan = new VerbView({ id: 'calibrate-plan' });
    this.calibrated = new VerbView({ id: 'calibrate-result', own: true });
    this.options = new ReadingOptions({ id: 'calibrate-options', change: () => this.calibrate(), button: 'Calibrate again',
      more: [['gravity', 'Gravity, if known better than from the place', 'such as 9.80743m/s^2', ''], ['placement', 'Error of each placement, 1 sigma', 'such as 0.1deg', ''], ['turn-angle', 'Angle of each turn', 'such as 360deg', '']] });
    this.choice = new FileChoice({ id: 'calibrate-files', label: 'Choose the log of the session', several: false, change: () => {
      this.made = null;
      this.calibrate();
    } });
    this.poses = element('ol', { class: 'poses', id: 'calibrate-poses' });
    this.now = element('div', { class: 'pose-now', id: 'calibrate-now', hidden: true });
    root.append(element('h1', {}, 'Calibrate without equipment'),
      element('p', {}, 'Put the unit down, let it rest, turn it by hand to the next attitude, let it rest, and so on, while it is logged. Angles need not be exact: gravity is the reference. x, y and z are the axes of the log: +x is up where the x accelerometer reads +1 g.'),
      this.makeSettings(), this.plan.root, this.now, this.poses,
      element('h2', {}, 'The log of the session'), this.choice.root,
      element('p', { class: 'no-print' }, 'No log at hand? ', element('button', { type: 'button', id: 'calibrate-example', onclick: () => this.example() }, 'Take an example: these poses, simulated')),
      this.options.root, this.calibrated.root);
    this.renew = settled(() => this.showPlan());
  }

  makeSettings() {
    const field = (label, control, help) => element('div', { class: 'field' }, element('label', { for: control.id }, label), control, help ? element('small', {}, help) : null);
    this.procedure = element('select', { id: 'calibrate-procedure', onchange: () => this.change() }, procedures.map(([name, text]) => element('option', { value: name }, `${name}: ${text}`)));
    this.unit = element('select', { id: 'calibrate-unit', onchange: () => this.renew() });
    this.position = element('input', { type: 'text', id: 'calibrate-position', placeholder: '48.1 deg, 11.6 deg, 520 m', autocomplete: 'off', onchange: () => this.change() });
    return element('div', { class: 'fields no-print' }, field('Procedure', this.procedure),
      field('The unit is like', this.unit, 'how well the poses will calibrate it follows from its noise'),
      field('Place: latitude, longitude, height', this.position, 'for gravity and the rotation of the Earth; without it 45° and sea level are taken'));
  }

  async arrive() {
    const before = this.unit.value || 'control';
    this.unit.replaceChildren(...(await sensorOptions()));
    this.unit.value = before;
    if (!this.steps) this.renew();
  }

  /** Another test or place: other poses, and another result of the same log, which an example's
   *  session is not. */
  change() {
    if (this.made) this.choice.files = [];
    this.made = null;
    this.choice.show();
    this.renew();
    this.calibrate();
  }

  place() {
    const position = this.position.value.trim();
    return position ? ['--position', position] : [];
  }

  planWords() {
    return ['calibrate', '--plan', ...sensors.words([this.unit.value]), '--procedure', this.procedure.value, ...this.place(), '-o', 'programme.yaml'];
  }

  /* ---- the poses ---- */

  async showPlan() {
    const words = this.planWords();
    this.stop();
    const done = await this.plan.run([...words, '--json'], { files: sensors.files([this.unit.value]) });
    this.poses.replaceChildren();
    this.plan.result.replaceChildren();
    if (!done || !done.json.result) return;
    const { steps, usability, duration } = done.json.result;
    Object.assign(this, { steps, duration, programme: fileOf(done, 'programme.yaml') });
    this.plan.result.append(element('p', { class: 'verdict note' }, usability.sentence),
      element('div', { class: 'buttons' }, element('button', { type: 'button', class: 'main', id: 'calibrate-begin', onclick: () => this.goTo(0) }, 'Begin the session'),
        element('button', { type: 'button', onclick: () => print() }, 'Print the poses')), terminalLine([words]));
    this.poses.append(...steps.map((step, i) => this.poseItem(step, i)));
  }

  /** What to do at a step. */
  stepWords({ action, angle, axis, rate, duration }) {
    const words = poseWords(upFromAngles(angle));
    if (action !== 'rate') return words;
    const degrees = Math.round((rate.value * duration.value * 180) / Math.PI);
    return `${words}; turn about ${poseAxes[axis]} by ${degrees > 0 ? '+' : '−'}${Math.abs(degrees)}°`;
  }

  poseItem(step, i) {
    return element('li', { 'data-pose': i + 1 }, drawPose(upFromAngles(step.angle)), `${i + 1}. ${this.stepWords(step)}`);
  }

  /* ---- the session ---- */

  stop() {
    clearInterval(this.timer);
    this.now.hidden = true;
  }

  /** Show a pose to take; past the last one the session is over. */
  goTo(index) {
    clearInterval(this.timer);
    const { steps } = this, over = index >= steps.length;
    [...this.poses.children].forEach((item, i) => {
      item.classList.toggle('done', i < index);
      item.classList.toggle('now', i === index);
    });
    this.now.hidden = false;
    if (over) this.now.replaceChildren(element('p', { role: 'status' }, 'All poses are taken. Stop the log and put it below.'));
    else this.showNow(index);
  }

  showNow(index) {
    const step = this.steps[index], say = element('p', { class: 'big', role: 'status' }, `${index + 1} of ${this.steps.length}`);
    const rest = element('button', { type: 'button', class: 'main', id: 'calibrate-rest', onclick: () => this.countDown(index, say, rest) }, step.action === 'rate' ? 'It is turned and rests' : 'It rests');
    const back = element('button', { type: 'button', id: 'calibrate-back', disabled: index === 0, onclick: () => this.goTo(index - 1) }, 'Back');
    this.now.replaceChildren(drawPose(upFromAngles(step.angle)), element('div', {}, say,
      element('p', {}, `${this.stepWords(step)}.`),
      element('p', {}, index === 0 ? 'The log must be running. Put the unit down like this and take your hands off: it rests 10 s the first time, to show its noise.' : 'Put the unit down like this and take your hands off.'),
      element('div', { class: 'buttons' }, rest, back, element('button', { type: 'button', onclick: () => this.stop() }, 'End'))));
    rest.focus();
  }

  /** Seconds of rest, then the next pose. */
  countDown(index, say, button) {
    const until = performance.now() + 1000 * (index === 0 ? 10 : 5);
    button.disabled = true;
    this.timer = setInterval(() => {
      const left = Math.ceil((until - performance.now()) / 1000);
      say.textContent = `Hold still: ${Math.max(left, 0)} s`;
      if (left <= 0) this.goTo(index + 1);
    }, 250);
  }

  /* ---- the result ---- */

  /** The session as it would be logged, of the unit that the poses are planned for. */
  async example() {
    if (!this.programme) return;
    const words = ['simulate', ...sensors.words([this.unit.value]), '--motion', 'programme.yaml', '--rate', '100Hz', '--duration', `${this.duration.value}s`, '-o', 'session.csv'];
    const done = await this.calibrated.run(words, { files: [...sensors.files([this.unit.value]), ['programme.yaml', this.programme]] });
    if (!done) return;
    const made = [this.planWords(), words];
    this.choice.add([['session.csv', new Blob([fileOf(done, 'session.csv')])]]);
    this.made = made;
  }

  async calibrate() {
    const { files } = this.choice;
    if (this.calibrated.waiting) this.calibrated.cancel();
    this.calibrated.clear();
    if (files.length === 0) return;
    const taken = new Set(files.map(([name]) => name)), report = freeName('report.html', taken), model = freeName('model.yaml', taken);
    const words = ['calibrate', operand(this.choice.logs()[0][0]), '--procedure', this.procedure.value, ...this.place(), ...this.options.words(), '--poses', '-o', model, '--report', report];
    const done = await this.calibrated.run([...words, '--json'], { files, begin: 'Calibrating …' });
    this.options.mark(this.calibrated.error);
    if (done) this.showCalibrated(done, words, report, model);
  }

  showCalibrated(done, words, report, model) {
    const page = fileOf(done, report), bytes = fileOf(done, model);
    const made = this.made || [];
    const offers = [['Model (YAML)', 'calibrated.yaml', bytes], ['Report (HTML)', 'report.html', page], ['Numbers (JSON)', 'calibrate.json', done.out]];
    const beside = [downloadButtons(offers.filter(([, , content]) => content)), this.makeRepeat(done.json.result)];
    if (bytes) {
      sensors.keep('calibrated.yaml', bytes);
      beside.push(element('p', {}, element('a', { href: '#device/calibrated.yaml' }, 'What a navigator with this sensor does'), '. To take the errors out of a log: ',
        element('code', {}, 'imukit compensate LOG calibrated.yaml -o clean.csv')));
    }
    const after = [terminalLine([...made, words])];
    if (page) this.calibrated.showReport(page, { beside, after });
    else this.calibrated.result.replaceChildren(element('pre', { tabindex: '0' }, done.out), ...beside, ...after);
    this.calibrated.comeIntoView();
  }

  /** Poses that the solution has left out or counts for less. */
  makeRepeat({ poses }) {
    const wrong = (poses || []).filter(({ weight }) => weight < 0.5);
    if (wrong.length === 0) return element('p', { 'data-part': 'repeat' }, poses && poses.length > 0 ? 'No pose has to be repeated.' : '');
    const [title, they] = wrong.length === 1 ? ['Repeat this pose', 'It does not fit the others, so it was left out or counts'] : ['Repeat these poses', 'They do not fit the others, so they were left out or count'];
    return element('section', { 'data-part': 'repeat' }, element('h3', {}, title),
      element('p', {}, `${they} for less: the unit was touched, the table moved, or a sensor was at its limit. Log again, with all the other poses.`),
      element('ol', { class: 'poses' }, wrong.map(({ begin, force, distance }) => element('li', { class: 'wrong' }, drawPose(force),
        `${poseWords(force)}, at ${begin.value.toFixed(1)} s: off by ${Number(distance.toPrecision(2))} sigmas`))));
  }
}
