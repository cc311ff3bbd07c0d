// SPDX-License-Identifier: Apache-2.0
// The bench of the lecture: four experiments about errors of sensors.

'use strict';

screens.bench = {
  title: 'Bench',
  show(root) {
    root.classList.add('bench');
    root.append(element('h1', {}, 'Bench'), element('p', {}, 'Four experiments about errors of inertial sensors. Every sample is simulated, and every result computed, by the code of the command, here on your machine.'));
    const ends = [showTarget, showHeading, showGrades, showNoises].map((show) => {
      const section = element('section', {});
      root.append(section);
      return show(section);
    });
    return () => ends.forEach((end) => end && end());
  },
};
