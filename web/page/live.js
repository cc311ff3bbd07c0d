// SPDX-License-Identifier: Apache-2.0
// In the worker: an instrument that runs on and on, by the functions of core/live.c.

'use strict';

async function doLive({ id, live: name, values }) {
  postMessage({ id, failed: `no instrument runs here yet: ${name} ${values}` });
}
