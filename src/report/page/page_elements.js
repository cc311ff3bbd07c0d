/* SPDX-License-Identifier: Apache-2.0 */
/* What the other parts of the script make elements with; tables whose cells are copied; light and
 * dark. */
'use strict';

const imukitPage = (() => {
  /* An element with its attributes and what it contains. */
  function html(name, attributes, ...content) {
    const made = document.createElement(name);
    for (const key of Object.keys(attributes))
      made.setAttribute(key, attributes[key]);
    made.append(...content);
    return made;
  }

  /* A button; `title` is seen by those who rest on it, and heard instead of a mere sign. */
  function button(text, title, action) {
    const made = html('button', {type: 'button', title, ...(text.length === 1 && {'aria-label': title})},
      text);
    made.addEventListener('click', action);
    return made;
  }

  /* Where things are told, once for all articles, which may be hidden or taken away. It is there
   * before anything is told: only changes are heard. */
  let place = null, heard = null, told = null, timer = 0;
  function voice() {
    if (!place) {
      heard = html('div', {class: 'unseen', 'aria-live': 'polite', role: 'status'});
      told = html('div', {class: 'told', 'aria-hidden': true, hidden: ''});
      place = html('div', {class: 'imukit voice'}, heard, told);
    }
    if (!place.isConnected)
      document.body.append(place);
    return place;
  }

  /* Tell readers who hear the page; with `seen` those who see it, too, for two seconds. */
  function say(text, seen) {
    voice();
    heard.textContent = text;
    if (!seen)
      return;
    told.textContent = text;
    told.hidden = false;
    clearTimeout(timer);
    timer = setTimeout(() => { told.hidden = true; }, 2000);
  }

  /* ---- copying ------------------------------------------------------------------------------- */

  /* Where the clipboard is closed to pages of files, a field that is selected is copied. */
  function copyField(text) {
    const field = html('textarea', {class: 'unseen', 'aria-hidden': true}), before = document.activeElement;
    field.value = text;
    voice().append(field);
    field.select();
    const done = document.execCommand('copy');
    field.remove();
    if (before)
      before.focus({preventScroll: true});
    return done;
  }

  async function copy(text, what) {
    let done = false;
    try {
      await navigator.clipboard.writeText(text);
      done = true;
    } catch (error) {
      done = copyField(text);
    }
    say(done ? `Copied: ${what}` : 'The browser does not let this page copy', true);
  }

  const textOf = cell => cell.textContent.trim().replace(/\s+/g, ' ');
  const tableText = table =>
    [...table.rows].map(row => [...row.cells].map(textOf).join('\t')).join('\n');

  /* A click on a cell, or Ctrl-C at it, copies its text; arrow keys go from cell to cell. */
  function attachTable(root) {
    const table = root.querySelector('table');
    let here = null;
    const go = cell => {
      if (!cell)
        return;
      if (here)
        here.classList.remove('here');
      here = cell;
      here.classList.add('here');
      here.scrollIntoView({block: 'nearest', inline: 'nearest'});
    };
    const selected = () => String(window.getSelection()) !== '';
    root.classList.add('cells');
    root.append(button('Copy table', 'Copy the table, its cells separated by tabs',
      () => copy(tableText(table), 'the table')));
    root.lastChild.classList.add('copy');
    table.addEventListener('click', event => {
      const cell = event.target.closest('th, td');
      if (!cell || selected())
        return;
      go(cell);
      if (textOf(cell))
        copy(textOf(cell), textOf(cell));
    });
    root.addEventListener('keydown', event => {
      const steps = {ArrowLeft: [0, -1], ArrowRight: [0, 1], ArrowUp: [-1, 0], ArrowDown: [1, 0]};
      const row = here ? here.parentNode.rowIndex : 0, column = here ? here.cellIndex : 0;
      if (event.target !== root)
        return;
      if ((event.ctrlKey || event.metaKey) && event.key === 'c' && here && !selected()) {
        event.preventDefault();
        copy(textOf(here), textOf(here));
      } else if (steps[event.key] && !event.ctrlKey && !event.altKey) {
        const [down, across] = here ? steps[event.key] : [0, 0];
        const next = table.rows[row + down];
        event.preventDefault();
        go(next && next.cells[column + across]);
      }
    });
    root.addEventListener('blur', () => {
      if (here)
        here.classList.remove('here');
      here = null;
    });
  }

  /* ---- light and dark ------------------------------------------------------------------------ */

  /* The condition of the rules for a dark screen, which the reader's choice replaces. */
  function darkConditions() {
    return [...document.styleSheets].flatMap(sheet => [...sheet.cssRules])
      .filter(rule => rule.media && /prefers-color-scheme:\s*dark/.test(rule.media.mediaText))
      .map(rule => rule.media);
  }

  /* Drawings can have rules of their own, also such that are put into the page later. */
  let conditions = [], darkness = null;
  function setDark(dark) {
    darkness = dark;
    conditions = [...conditions, ...darkConditions()];
    conditions.forEach(media => { media.mediaText = dark ? 'screen' : 'not all'; });
  }
  const keepDark = () => darkness !== null && setDark(darkness);

  /* A button that changes the page from light to dark and back. */
  function attachTheme(article) {
    const system = matchMedia('(prefers-color-scheme: dark)');
    let dark = system.matches, chosen = false;
    const label = () => { made.textContent = dark ? 'Light page' : 'Dark page'; };
    const made = html('button', {type: 'button', class: 'theme'});
    made.addEventListener('click', () => {
      dark = !dark;
      chosen = true;
      setDark(dark);
      label();
    });
    system.addEventListener('change', () => {
      dark = chosen ? dark : system.matches;
      label();
    });
    label();
    article.prepend(made);
  }

  return {html, button, voice, say, attachTable, attachTheme, setDark, keepDark};
})();
