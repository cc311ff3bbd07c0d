// SPDX-License-Identifier: Apache-2.0
// A device of the catalogue or a data sheet: its curve, its drift and what it costs.

'use strict';

screens.device = {
  title: 'Choose a sensor',
  show(root) {
    const list = element('pre', {}, 'Reading…');
    root.append(element('h1', {}, 'Choose a sensor'), list);
    engine.run(['devices']).then((done) => (list.textContent = done.out || done.err), (reason) => (list.textContent = reason.message));
  },
};
