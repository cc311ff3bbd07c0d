// SPDX-License-Identifier: Apache-2.0
// A unit on a table, drawn as a box with its axes, for an attitude that is given by which direction
// of the unit points up: [x, y, z] with x forward, y right, z down.

'use strict';

const poseSize = [1.5, 1, 0.5]; // of the box along its axes, halves
const poseAxes = ['x', 'y', 'z'];

/** Which direction of the unit points up, for roll, pitch and yaw [rad]. */
function upFromAngles([roll, pitch]) {
  return [Math.sin(pitch), -Math.sin(roll) * Math.cos(pitch), -Math.cos(roll) * Math.cos(pitch)];
}

/** In words: "up: +x", "up: between −y and +z". */
function poseWords(up) {
  const parts = poseAxes.map((axis, i) => (Math.abs(up[i]) > 0.35 ? (up[i] > 0 ? '+' : '−') + axis : null)).filter(Boolean);
  if (parts.length === 1) return `${parts[0]} up`;
  return `${parts.slice(0, -1).join(', ')} and ${parts.at(-1)} up${parts.length === 2 ? ', on an edge' : ', on a corner'}`;
}

/** Turns directions of the unit into the room (right, back, up), by the shortest way from level. */
function poseTurn(up) {
  const level = ([x, y, z]) => [x, -y, -z];
  const length = Math.hypot(...up), [x, y, z] = level(up.map((part) => part / length));
  if (z < -0.9999) return (v) => (([a, b, c]) => [a, -b, -c])(level(v)); // upside down: about x
  // Rodrigues' formula about (x, y, z) × (0, 0, 1), simplified.
  return (v) => {
    const [a, b, c] = level(v), along = (y * a - x * b) / (1 + z);
    return [z * a - x * c + y * along, z * b - y * c - x * along, x * a + y * b + z * c];
  };
}

/** Onto the picture, seen from the front right and from above. */
function poseProject([right, back, up]) {
  const azimuth = 0.6, elevation = 0.42;
  const across = right * Math.cos(azimuth) + back * Math.sin(azimuth), away = back * Math.cos(azimuth) - right * Math.sin(azimuth);
  return { x: across, y: -(up * Math.cos(elevation) + away * Math.sin(elevation)), near: up * Math.sin(elevation) - away * Math.cos(elevation) };
}

function svgElement(name, attributes, ...content) {
  const made = document.createElementNS('http://www.w3.org/2000/svg', name);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  made.append(...content);
  return made;
}

/** The four corners of a face, in order, and whether it is seen. */
function poseFace(turn, axis, side) {
  const [a, b] = [(axis + 1) % 3, (axis + 2) % 3];
  const corner = (i, j) => {
    const v = [0, 0, 0];
    v[axis] = side * poseSize[axis];
    v[a] = i * poseSize[a];
    v[b] = j * poseSize[b];
    return turn(v);
  };
  const corners = [corner(1, 1), corner(1, -1), corner(-1, -1), corner(-1, 1)], outward = [0, 0, 0];
  outward[axis] = side;
  return { corners, seen: poseProject(turn(outward)).near > 0 };
}

/** A face as a polygon; the lid, opposite to z, is tinted. */
function poseFaceElement(turn, axis, side, place) {
  const { corners, seen } = poseFace(turn, axis, side);
  if (!seen) return null;
  return svgElement('polygon', { class: axis === 2 && side < 0 ? 'face lid' : 'face', points: corners.map((c) => place(c).join(',')).join(' ') });
}

/** An axis as an arrow that begins at its face. */
function poseArrow(turn, axis, place) {
  const at = (reach) => {
    const v = [0, 0, 0];
    v[axis] = poseSize[axis] + reach;
    return place(turn(v));
  };
  const [x1, y1] = at(0), [x2, y2] = at(0.75), [x3, y3] = at(1.05), name = poseAxes[axis];
  const angle = (Math.atan2(y2 - y1, x2 - x1) * 180) / Math.PI;
  const head = Math.hypot(x2 - x1, y2 - y1) > 4 ? svgElement('path', { d: 'M0 -4L7 0L0 4z', transform: `translate(${x2} ${y2}) rotate(${angle})` }) : svgElement('circle', { cx: x2, cy: y2, r: 4 });
  return svgElement('g', { class: name }, svgElement('line', { x1, y1, x2, y2 }), head,
    svgElement('text', { x: x3, y: y3 + 5, 'text-anchor': 'middle' }, name));
}

/** The drawing of a pose; `words` is what readers hear. */
function drawPose(up, words = poseWords(up)) {
  const turn = poseTurn(up), scale = 32;
  const place = (v) => {
    const { x, y } = poseProject(v);
    return [(100 + scale * x).toFixed(1), (88 + scale * y).toFixed(1)].map(Number);
  };
  const corners = [-1, 1].flatMap((i) => [-1, 1].flatMap((j) => [-1, 1].map((k) => turn([i * poseSize[0], j * poseSize[1], k * poseSize[2]]))));
  const low = Math.min(...corners.map(([, , z]) => z));
  const ground = [[-2.1, -1.6], [2.1, -1.6], [2.1, 1.6], [-2.1, 1.6]].map(([x, y]) => place([x, y, low]).join(',')).join(' ');
  const isBehind = (axis) => !poseFace(turn, axis, 1).seen;
  const faces = [0, 1, 2].flatMap((axis) => [1, -1].map((side) => poseFaceElement(turn, axis, side, place))).filter(Boolean);
  const arrows = [0, 1, 2].map((axis) => ({ behind: isBehind(axis), drawn: poseArrow(turn, axis, place) }));
  return svgElement('svg', { class: 'pose', viewBox: '0 0 200 180', role: 'img', 'aria-label': words },
    svgElement('polygon', { class: 'ground', points: ground }), ...arrows.filter(({ behind }) => behind).map(({ drawn }) => drawn), ...faces,
    ...arrows.filter(({ behind }) => !behind).map(({ drawn }) => drawn));
}
