// SPDX-License-Identifier: Apache-2.0
// A worker: does verbs and runs instruments, away from the page. It is begun with the compiled
// module; each verb has an instance of its own.
//
// Messages in:  { packed: text }                             answered by { module }, and that is all
//               { module }                                   once
//               { id, words, files, environment }            a verb; files: [[name, Blob or bytes]]
//               { id, live: NAME_OF_FUNCTION, values: […] }  see live.js
// Messages out: { id, progress: text } and then { id, code, out, err, files } or { id, failed, kind }

'use strict';

let compiled;
const live = { instance: null };

async function doVerb({ id, words, files, environment }) {
  let line = ''; // of the terminal, which comes in pieces: a stage, "  43 %", "  12 s left"
  const system = new PageSystem({
    words: ['imukit', ...words],
    files: new Map(files),
    environment,
    warn: (text) => {
      line += text;
      line = line.slice(Math.max(line.lastIndexOf('\x1b[K'), 0));
      const shown = line.startsWith('\x1b[K') ? line.slice(3) : '';
      if (text && shown && !shown.includes('\n')) postMessage({ id, progress: shown });
    },
  });
  const instance = await WebAssembly.instantiate(await compiled, system.imports);
  const start = performance.now();
  const code = system.run(instance.exports);
  const given = new Set(files.map(([name]) => name));
  const made = [];
  for (const name of system.files.keys()) if (!given.has(name)) made.push([name, system.file(name)]);
  const err = system.text(2).replace(/\r?\x1b\[K[^\n\r]*(?=\r|$)/g, '').replace(/\r?\x1b\[K/g, '');
  postMessage({ id, code, out: system.text(1), err, files: made, milliseconds: performance.now() - start },
    made.map(([, bytes]) => bytes.buffer));
}

// A fault outside an answer, and a request that cannot be received, end in `onerror` of the page.
onmessageerror = () => {
  throw new Error('a request cannot be received');
};
onunhandledrejection = ({ reason }) => setTimeout(() => {
  throw reason;
});

onmessage = async ({ data }) => {
  try {
    if (data.packed) postMessage({ module: await WebAssembly.compile(unpackLzma(bytesOf(data.packed))) });
    else if (data.module) compiled = data.module;
    else if (data.live) await doLive(data);
    else await doVerb(data);
  } catch (reason) {
    postMessage({ id: data.id, failed: String((reason && reason.message) || reason), kind: reason && reason.name });
  }
};
