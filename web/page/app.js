// SPDX-License-Identifier: Apache-2.0
// The page as a whole: screens by the part of the address behind #, each an entry of `screens`
// (screens/*.js): { title, show(root, rest) } that fills `root` and may return a function that ends
// it. `rest` is what follows the name: "#instruments/ring_laser" shows screens.instruments with
// "ring_laser".

'use strict';

const engine = new Engine();
let leave = null;

function showScreen() {
  const [name, ...rest] = decodeURIComponent(location.hash.slice(1)).split('/');
  const known = Object.hasOwn(screens, name) ? name : Object.keys(screens)[0];
  const root = element('main', { id: 'main', tabindex: '-1' });
  if (leave) leave();
  for (const link of document.querySelectorAll('nav a'))
    if (link.hash === '#' + known) link.setAttribute('aria-current', 'page');
    else link.removeAttribute('aria-current');
  document.title = `${screens[known].title} · imukit`;
  document.getElementById('main').replaceWith(root);
  leave = screens[known].show(root, rest.join('/')) || null;
}

function begin() {
  document.querySelector('nav').append(...Object.entries(screens).map(([name, screen]) =>
    element('a', { href: '#' + name }, screen.title)));
  addEventListener('hashchange', showScreen);
  showScreen();
  document.documentElement.dataset.ready = 'yes';
}
