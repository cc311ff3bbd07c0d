// SPDX-License-Identifier: Apache-2.0
// A log: dropped or chosen, identified, and its results to look at and to take away.

'use strict';

screens.log = {
  title: 'My log',
  show(root) {
    const status = element('p', { role: 'status' });
    const result = element('section');
    const choose = element('input', { type: 'file', id: 'file', onchange: () => identify(choose.files[0]) });
    async function identify(file) {
      if (!file) return;
      status.textContent = 'Reading…';
      try {
        const done = await engine.run(['identify', file.name, '--report', 'report.html'], {
          files: [[file.name, file]],
          progress: (line) => (status.textContent = line),
        });
        status.textContent = `${(done.milliseconds / 1000).toFixed(2)} s`;
        result.replaceChildren(element('pre', {}, done.code === 0 ? done.out : done.err));
      } catch (reason) {
        status.textContent = reason.message;
      }
    }
    root.append(element('h1', {}, 'My log'), element('label', { for: 'file' }, 'Log '), choose, status, result);
  },
};
