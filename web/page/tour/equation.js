// SPDX-License-Identifier: Apache-2.0
// Equations as a person types them, "Δφ = (8 π N A Ω)/(λ c)", set as MathML; the typed text is
// their plain alternative. Numbers, letters, words of three letters or more (upright), a_index,
// a^power, a/b and (a b)/(c d) as fractions, √(a), letters with a vector's arrow or a tilde,
// matrix(a, b; c, d).

'use strict';

/** Nodes [name, text] or [name, [nodes]]. */
function parseEquation(text) {
  const words = text.match(/matrix\(|√\(|[A-Za-z]{3,}|[A-Za-zα-ωΑ-Ωνϕ]\p{M}?|\d[\d.]*|[^\s]/gu);
  let at = 0;
  const row = (nodes) => (nodes.length === 1 ? nodes[0] : ['mrow', nodes]);
  function list(end) {
    const nodes = [];
    while (at < words.length && !end.includes(words[at])) {
      if (words[at] === '/') {
        at++;
        nodes.push(['mfrac', [bare(nodes.pop()), bare(atom())]]);
      } else nodes.push(atom());
    }
    return nodes;
  }
  // Brackets around a numerator or a denominator only group.
  function bare(node) {
    return node.inside ? row(node.inside) : node;
  }
  function matrix() {
    const rows = [[]];
    do {
      rows[rows.length - 1].push(['mtd', list(',;)')]);
      if (words[at] === ';') rows.push([]);
    } while (words[at++] !== ')');
    return ['mrow', [['mo', '('], ['mtable', rows.map((cells) => ['mtr', cells])], ['mo', ')']]];
  }
  function base() {
    const word = words[at++];
    if (word === 'matrix(') return matrix();
    if (word === '√(' || word === '(') {
      const inside = list(')');
      at++;
      if (word === '√(') return ['msqrt', inside];
      const size = { stretchy: String(JSON.stringify(inside).includes('mfrac')) };
      return Object.assign(['mrow', [['mo', '(', size], ...inside, ['mo', ')', size]]], { inside });
    }
    if (/^\d/.test(word)) return ['mn', word];
    if (!/^\p{L}/u.test(word)) return ['mo', word === '-' ? '−' : word];
    if (/\p{M}/u.test(word)) return ['mover', [['mi', word[0]], ['mo', word[1] === '\u20d7' ? '→' : '~']]];
    return word.length > 2 ? ['mrow', [['mi', word], ['mspace', '', { width: '.17em' }]]] : ['mi', word];
  }
  function script() {
    if (words[at] === '(') return bare(base());
    // An index is a word of its own, of one letter or more.
    let word = words[at++];
    while (at < words.length && /^[A-Za-z]+$/.test(word) && /^[A-Za-z]+$/.test(words[at]) && glued(at)) word += words[at++];
    return [/^\d/.test(word) ? 'mn' : 'mi', word, word.length === 1 && /[a-z]/.test(word) ? {} : { mathvariant: 'normal' }];
  }
  const places = [];
  let from = 0;
  for (const word of words) {
    places.push(text.indexOf(word, from));
    from = places[places.length - 1] + word.length;
  }
  const glued = (i) => places[i] === places[i - 1] + words[i - 1].length;
  function atom() {
    let node = base(), below, above;
    if (words[at] === '_') at++, (below = script());
    if (words[at] === '^') at++, (above = script());
    if (below && above) return ['msubsup', [node, below, above]];
    if (below) return ['msub', [node, below]];
    return above ? ['msup', [node, above]] : node;
  }
  return list('');
}

/** Text in which letters with an index, "x_max", are set as such. */
function withIndices(text) {
  return text.split(/(?<=\p{L})_([\p{L}\d]+)/u).map((part, i) => (i % 2 ? element('sub', {}, part) : part));
}

/** Without a font for mathematics indices stand on the line: the style lowers them. */
function lowerIndices(root) {
  const probe = equation('H_E');
  root.append(probe);
  const [letter, index] = [...probe.querySelectorAll('mi')].map((part) => part.getBoundingClientRect());
  probe.remove();
  root.classList.toggle('flat', index.bottom - letter.bottom < 0.1 * letter.height);
}

/** An element that shows the equation. */
function equation(text) {
  const space = 'http://www.w3.org/1998/Math/MathML';
  function make([name, content, attributes = {}]) {
    const made = document.createElementNS(space, name);
    for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
    if (name === 'mo' && '→~'.includes(content)) made.setAttribute('stretchy', 'false');
    made.append(...(typeof content === 'string' ? [content] : content.map(make)));
    return made;
  }
  const math = make(['math', parseEquation(text), { display: 'block', alttext: text }]);
  return element('div', { class: 'equation' }, math, element('code', {}, text));
}

if (typeof module !== 'undefined') module.exports = { parseEquation };
