// SPDX-License-Identifier: Apache-2.0
// Moves the parts of a schematic (imukit/schematic.h) in the page. Only the attributes transform,
// opacity and stroke-dashoffset change; where the parts are is computed by live_show.c.

'use strict';

/** A drawing with styles and names of its own, and its moving parts in the order given. Its pace is
 *  left out, which the page lets choose. */
function importSchematic(text, about) {
  const host = element('div', { class: 'schematic' });
  const shadow = host.attachShadow({ mode: 'open' });
  const svg = document.importNode(new DOMParser().parseFromString(text, 'image/svg+xml').documentElement, true);
  shadow.append(element('style', {}, 'svg { display: block; width: 100%; height: auto; } .pace { display: none; }'), svg);
  const parts = about.parts.map(({ id, move, origin }) => ({ group: svg.getElementById(id), move, origin }));
  return { host, parts };
}

const partMoves = {
  turn: (v, x, y) => `rotate(${v} ${x} ${y})`,
  'shift-x': (v) => `translate(${v} 0)`,
  'shift-y': (v) => `translate(0 ${v})`,
  'stretch-x': (v) => `scale(${v} 1)`,
  'stretch-y': (v) => `scale(1 ${v})`,
  squeeze: (v) => `scale(${1 + v} ${1 - v})`,
};

function placePart({ group, move, origin }, value) {
  if (!group || !Number.isFinite(value)) return;
  value = Math.max(-1e6, Math.min(1e6, value)); // farther away is not drawn
  if (move === 'glow') group.style.opacity = value;
  else if (move === 'flow') group.style.strokeDashoffset = value;
  else {
    const v = move.startsWith('stretch') && Math.abs(value) < 0.001 ? 0.001 : Number(value.toPrecision(7));
    group.setAttribute('transform', partMoves[move](v, ...origin));
  }
}
