// SPDX-License-Identifier: Apache-2.0
// A tour through the 17 subjects of a lecture on inertial sensors: text, equations, a figure that is
// computed here, and an exercise whose answer the command gives. "#tour/5" is the fifth, "#tour/all"
// a handout.

'use strict';

screens.tour = {
  title: 'Tour',
  show(root, rest) {
    root.classList.add('tour');
    const number = Number(rest);
    if (Number.isInteger(number) && tourSubjects[number - 1]) return showSubject(root, number);
    return rest === 'all' ? showHandout(root) : showContents(root);
  },
};

/** Numbers of the exercises that were answered, as long as the page is open. */
const tourAnswered = new Set();

function tourList(current) {
  return element('ol', {}, tourSubjects.map(({ title }, i) => element('li', {},
    element('a', { href: `#tour/${i + 1}`, 'aria-current': i + 1 === current ? 'page' : null }, title),
    tourAnswered.has(i + 1) ? element('span', { class: 'done', role: 'img', 'aria-label': ', answered' }, ' ✓') : null)));
}

function showContents(root) {
  root.append(element('h1', {}, 'Inertial sensors in 17 subjects'),
    element('p', {}, 'From the three kinds of gyroscope to the grades of inertial units, in the order of a lecture. Each subject has a short text, its equations, a figure to change, and an exercise. All that is shown is computed on your machine by the verbs of the command.'),
    element('nav', { class: 'subjects', 'aria-label': 'Subjects' }, tourList()),
    element('p', {}, element('a', { href: '#tour/1' }, 'Begin'), ' · ', element('a', { href: '#tour/all' }, 'Handout: all of it on one page, to print')));
}

function showSubject(root, number) {
  const subject = tourSubjects[number - 1], count = tourSubjects.length;
  const list = element('details', { class: 'subjects' });
  const renew = () => list.replaceChildren(element('summary', {}, `Subject ${number} of ${count}; ${tourAnswered.size} answered`), element('nav', { 'aria-label': 'Subjects' }, tourList(number)));
  const step = (to, text, rel) => (tourSubjects[to - 1] ? element('a', { href: `#tour/${to}`, rel }, text(tourSubjects[to - 1].title)) : element('a', { href: '#tour' }, 'All subjects'));
  const steps = () => element('nav', { class: 'steps', 'aria-label': 'Previous and next subject' },
    step(number - 1, (title) => `← ${title}`, 'prev'), step(number + 1, (title) => `${title} →`, 'next'));
  const drawing = element('section', { class: 'tour-figure', 'aria-label': 'Figure' });
  document.title = `${subject.title} · imukit`;
  renew();
  root.append(list, element('progress', { max: count, value: number, 'aria-label': 'Progress' }),
    element('h1', {}, `${number}. ${subject.title}`),
    element('div', { class: 'columns' }, element('section', {}, subjectText(subject)), drawing,
      showExercise(subject.exercise, () => (tourAnswered.add(number), renew()))), steps());
  lowerIndices(root);
  const end = showTourFigure(drawing, subject.figure);
  drawing.prepend(element('p', { class: 'caption' }, subject.figure.caption));
  const key = (event) => {
    const to = number + { ArrowRight: 1, ArrowLeft: -1 }[event.key];
    if (event.altKey || event.ctrlKey || event.metaKey || event.shiftKey || !tourSubjects[to - 1]) return;
    if (event.target.closest('input, select, textarea, pre, svg, summary, [role=application], [tabindex="0"]')) return;
    location.hash = `#tour/${to}`;
  };
  document.addEventListener('keydown', key);
  return () => {
    document.removeEventListener('keydown', key);
    if (end) end();
  };
}

function subjectText({ text, equations, letters }) {
  return [...text.map((part) => element('p', {}, part)), ...equations.map(equation), element('p', { class: 'weak' }, withIndices(letters))];
}

/** A question, a field, and the command that answers. */
function showExercise(exercise, done) {
  const said = element('p', { role: 'status' }), answer = element('div', {});
  const field = element('input', { type: 'text', autocomplete: 'off', spellcheck: 'false', id: 'answer', 'aria-describedby': 'question' });
  let found;
  const find = () => (found ||= answerOf(exercise));
  async function check(event) {
    event.preventDefault();
    said.textContent = 'Computing…';
    try {
      const { right, say } = judged(field.value, (await find()).quantity, exercise.tolerance);
      said.textContent = say;
      said.className = right ? 'right' : 'wrong';
      if (right) done();
    } catch (reason) {
      said.textContent = reason.message;
    }
  }
  async function show() {
    said.textContent = 'Computing…';
    try {
      answer.replaceChildren(...shownAnswer(exercise, await find()));
      said.textContent = said.className = '';
    } catch (reason) {
      said.textContent = reason.message;
    }
  }
  return element('section', { class: 'exercise' }, element('h2', {}, 'Exercise'),
    element('p', { id: 'question' }, withIndices(exercise.question)),
    exercise.table ? element('pre', { tabindex: 0 }, exercise.table) : null,
    element('form', { class: 'buttons', onsubmit: check }, element('label', { for: 'answer' }, 'Answer, with unit'), field,
      element('button', {}, 'Check'), element('button', { type: 'button', onclick: show }, 'Show the answer')), said, answer);
}

async function answerOf({ run, files, path, unit }) {
  const done = await runCommands((words, rest) => engine.run(words, rest), run, files);
  return { out: done.out, quantity: { ...quantityAt(JSON.parse(done.out), path), asked: unit } };
}

/** Command, output, and where in it the number stands. */
function shownAnswer({ run, files, path, solution }, { out, quantity }) {
  const mark = element('mark', {}), before = placeOfValue(out, path, quantity.value);
  const length = before < 0 ? 0 : /^[-+.\deE]*/.exec(out.slice(before))[0].length;
  mark.append(out.slice(before, before + length));
  const output = element('pre', { tabindex: 0, class: 'output' }, ...(before < 0 ? [out] : [out.slice(0, before), mark, out.slice(before + length)]));
  requestAnimationFrame(() => (output.scrollTop = mark.offsetTop - output.clientHeight / 2));
  return [element('p', {}, element('strong', {}, quantityText(quantity)), `: ${solution}`),
    element('pre', { tabindex: 0 }, terminalLines(run, files || {})),
    element('p', {}, 'In the output at ', element('code', {}, path.join(' › ')), `, in SI units: ${quantity.value} ${quantity.unit}`), output];
}

/** All subjects without controls, one after the other. */
function showHandout(root) {
  let ended = false;
  const status = element('p', { role: 'status' });
  root.append(element('h1', {}, 'Inertial sensors in 17 subjects'), element('p', { class: 'screen-only' }, element('a', { href: '#tour' }, 'All subjects')), status);
  (async () => {
    for (const [i, subject] of tourSubjects.entries()) {
      if (ended) return;
      status.textContent = `Subject ${i + 1} of ${tourSubjects.length}…`;
      root.append(element('h2', {}, `${i + 1}. ${subject.title}`), ...subjectText(subject), element('p', { class: 'caption' }, subject.figure.caption),
        await handoutFigure(subject.figure), element('p', {}, element('strong', {}, 'Exercise. '), withIndices(subject.exercise.question)),
        ...(subject.exercise.table ? [element('pre', {}, subject.exercise.table)] : []));
    }
    lowerIndices(root);
    status.textContent = '';
  })().catch((reason) => (status.textContent = reason.message));
  return () => (ended = true);
}

async function handoutFigure(figure) {
  const values = Object.fromEntries((figure.controls || []).map(({ name, value }) => [name, value]));
  if (figure.live) {
    const { schematic } = await askLive('open', figure.live);
    return element('img', { alt: '', class: 'drawn', src: 'data:image/svg+xml,' + encodeURIComponent(schematic) });
  }
  if (!figure.run) return '';
  const files = Object.fromEntries(Object.entries(figure.files || {}).map(([name, text]) => [name, filled(text, values)]));
  const done = await runCommands((words, rest) => engine.run(words, rest), figure.run.map((line) => filled(line, values)), files);
  const shown = shownResult(done, { ...figure, show: figure.show && filled(figure.show, values) });
  imukitFigures.attach(shown);
  return shown;
}
