// SPDX-License-Identifier: Apache-2.0
// The page as a whole: screens by the part of the address behind #, each an entry of `screens`
// (screens/*.js): { title, show(root, rest) } that fills `root` and may return a function that ends
// it. `rest` is what follows the name: "#instruments/ring_laser" shows screens.instruments with
// "ring_laser". A screen with `kept` is filled once and stays as it was left; its arrive(rest) is
// called whenever it is shown.

'use strict';

const engine = new Engine();
const keptRoots = new Map();
let leave = null;

/** Words of the address: ['device', 'my log']; what is no text is left out. */
function addressWords() {
  try {
    return decodeURIComponent(location.hash.slice(1)).split('/');
  } catch (reason) {
    return [];
  }
}

/** The element of a screen. A kept one is made once. */
function screenRoot(name) {
  const root = keptRoots.get(name) || element('main', { id: 'main', tabindex: '-1', 'data-screen': name });
  if (screens[name].kept) keptRoots.set(name, root);
  return root;
}

function showScreen() {
  const [name, ...rest] = addressWords();
  const known = Object.hasOwn(screens, name) ? name : Object.keys(screens)[0];
  const screen = screens[known], isNew = !keptRoots.has(known), root = screenRoot(known);
  if (leave) leave();
  for (const link of document.querySelectorAll('nav a'))
    if (link.hash === '#' + known) link.setAttribute('aria-current', 'page');
    else link.removeAttribute('aria-current');
  document.title = `${screen.title} · imukit`;
  document.getElementById('main').replaceWith(root);
  leave = (isNew && screen.show(root, rest.join('/'))) || null;
  if (screen.kept) leave = null;
  if (screen.arrive) screen.arrive(rest.join('/'));
}

/** Which command this is; that it answers shows that this browser can run it. */
async function showVersion() {
  const place = document.getElementById('version');
  try {
    const { out } = await engine.run(['--version']);
    place.textContent = out.trim().split('\n')[0];
  } catch (reason) {
    document.getElementById('main').prepend(element('p', { class: 'failed', role: 'alert' },
      `This browser cannot run the page: ${reason.message}. A browser of 2023 or later can.`));
  }
}

function begin() {
  document.querySelector('nav').append(...Object.entries(screens).map(([name, screen]) =>
    element('a', { href: '#' + name }, screen.title)));
  document.getElementById('skip').addEventListener('click', (event) => {
    event.preventDefault();
    document.getElementById('main').focus();
  });
  addEventListener('hashchange', () => {
    showScreen();
    scrollTo(0, 0);
    document.getElementById('main').focus({ preventScroll: true });
  });
  // What is dropped beside a field for files would replace this page.
  for (const kind of ['dragover', 'drop']) addEventListener(kind, (event) => event.preventDefault());
  showScreen();
  showVersion();
  document.documentElement.dataset.ready = 'yes';
}
