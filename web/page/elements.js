// SPDX-License-Identifier: Apache-2.0
// Making and finding elements of the page.

'use strict';

/** element('button', { class: 'main', onclick: go }, 'Go', …): text is never markup. */
function element(name, attributes = {}, ...content) {
  const made = document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) {
    if (key.startsWith('on')) made.addEventListener(key.slice(2), value);
    else if (value === true) made.setAttribute(key, '');
    else if (value !== false && value !== undefined && value !== null) made.setAttribute(key, value);
  }
  made.append(...content.flat().filter((part) => part !== undefined && part !== null));
  return made;
}

/** Offer bytes or text as a file. */
function download(name, content, type = 'application/octet-stream') {
  const address = URL.createObjectURL(new Blob([content], { type }));
  element('a', { href: address, download: name }).click();
  setTimeout(() => URL.revokeObjectURL(address), 1000);
}
