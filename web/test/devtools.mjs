// SPDX-License-Identifier: Apache-2.0
// Drives Debian's Chromium over the DevTools protocol, through pipes and without any package:
//
//     const browser = await Browser.open();
//     const page = await browser.page('file:///…/index.html', { width: 360, dark: true });
//     await page.until('document.querySelector("h1")');
//     page.faults(), page.requests      // errors of the console; addresses asked for
//     await browser.close();
import { spawn } from 'node:child_process';
import { mkdtempSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';

const pause = (milliseconds) => new Promise((resolve) => setTimeout(resolve, milliseconds));

export class Browser {
  static async open() {
    const browser = new Browser();
    browser.folder = mkdtempSync(join(tmpdir(), 'imukit-web-'));
    const flags = ['--headless', '--no-sandbox', '--disable-gpu', '--disable-dev-shm-usage', '--hide-scrollbars',
      '--no-first-run', '--disable-background-networking', '--disable-component-update', '--disable-extensions',
      '--remote-debugging-pipe', `--user-data-dir=${browser.folder}/profile`, 'about:blank'];
    browser.process = spawn(process.env.CHROMIUM || 'chromium', flags,
      { stdio: ['ignore', 'ignore', 'ignore', 'pipe', 'pipe'], env: { ...process.env, HOME: browser.folder } });
    browser.ended = new Promise((resolve) => browser.process.on('exit', resolve));
    browser.process.on('error', (reason) => browser.stop(reason));
    browser.ended.then(() => browser.stop(new Error('Chromium has ended')));
    browser.process.stdio[3].on('error', () => {});
    browser.waiting = new Map();
    browser.sessions = new Map();
    browser.next = 1;
    browser.listen(browser.process.stdio[4]);
    return browser;
  }

  stop(reason) {
    for (const { reject } of this.waiting.values()) reject(reason);
    this.waiting.clear();
  }

  /** Messages end with a zero byte. */
  listen(pipe) {
    let parts = [];
    pipe.on('data', (data) => {
      let end;
      while ((end = data.indexOf(0)) >= 0) {
        parts.push(data.subarray(0, end));
        this.receive(JSON.parse(Buffer.concat(parts).toString()));
        parts = [];
        data = data.subarray(end + 1);
      }
      if (data.length) parts.push(data);
    });
  }

  receive({ id, sessionId, method, params, result, error }) {
    if (!id) {
      const page = this.sessions.get(sessionId);
      if (page) page.event(method, params, sessionId);
      return;
    }
    const asked = this.waiting.get(id);
    this.waiting.delete(id);
    if (!asked) return;
    if (error) asked.reject(new Error(`${asked.method}: ${error.message}`));
    else asked.resolve(result);
  }

  send(method, params = {}, sessionId = undefined) {
    const id = this.next++;
    return new Promise((resolve, reject) => {
      this.waiting.set(id, { resolve, reject, method });
      this.process.stdio[3].write(JSON.stringify({ id, method, params, sessionId }) + '\0');
    });
  }

  /** A new page of `width` x `height` CSS pixels. still: the user wants reduced motion. */
  async page(address, { width = 1280, height = 900, dark = false, still = false } = {}) {
    const { targetId } = await this.send('Target.createTarget', { url: 'about:blank' });
    const { sessionId } = await this.send('Target.attachToTarget', { targetId, flatten: true });
    const page = new Page(this, targetId, sessionId);
    this.sessions.set(sessionId, page);
    await Promise.all(['Page', 'Runtime', 'Log', 'Network', 'DOM'].map((domain) => page.send(domain + '.enable')));
    await page.send('Target.setAutoAttach', { autoAttach: true, waitForDebuggerOnStart: false, flatten: true });
    await page.size(width, height);
    await page.send('Emulation.setEmulatedMedia', { features: [
      { name: 'prefers-color-scheme', value: dark ? 'dark' : 'light' },
      { name: 'prefers-reduced-motion', value: still ? 'reduce' : 'no-preference' }] });
    if (address) await page.go(address);
    return page;
  }

  async close() {
    this.process.kill();
    const hard = setTimeout(() => this.process.kill('SIGKILL'), 3000);
    await this.ended;
    clearTimeout(hard);
    rmSync(this.folder, { recursive: true, force: true, maxRetries: 5 });
  }
}

export class Page {
  constructor(browser, target, session) {
    Object.assign(this, { browser, target, session, messages: [], requests: [], downloads: [], handlers: new Map() });
  }

  send(method, params) {
    return this.browser.send(method, params, this.session);
  }

  /** Call `act` with the parameters of each event of this name. */
  on(method, act) {
    this.handlers.set(method, act);
  }

  event(method, params, session) {
    if (this.handlers.has(method)) this.handlers.get(method)(params);
    if (method === 'Runtime.exceptionThrown') {
      const { text, exception } = params.exceptionDetails;
      this.messages.push(`exception: ${(exception && exception.description) || text}`);
    } else if (method === 'Runtime.consoleAPICalled') {
      this.messages.push(`${params.type}: ${params.args.map((one) => one.value ?? one.description).join(' ')}`);
    } else if (method === 'Log.entryAdded') {
      this.messages.push(`${params.entry.level}: ${params.entry.text} ${params.entry.url || ''}`);
    } else if (method === 'Network.requestWillBeSent') {
      this.requests.push(params.request.url);
    } else if (method === 'Target.attachedToTarget' && session === this.session) {
      this.browser.sessions.set(params.sessionId, this); // a worker
      for (const domain of ['Runtime', 'Log', 'Network'])
        this.browser.send(domain + '.enable', {}, params.sessionId).catch(() => {});
    }
  }

  /** What the console has told that is no mere information. */
  faults() {
    return this.messages.filter((line) => /^(exception|error|warning|assert)/.test(line));
  }

  /** Requests to other addresses than the page itself. */
  strangers() {
    return this.requests.filter((address) => !/^(file|data|blob|about):/.test(address));
  }

  async go(address) {
    const loaded = new Promise((resolve) => this.on('Page.loadEventFired', resolve));
    const { errorText } = await this.send('Page.navigate', { url: address });
    if (errorText) throw new Error(`${address}: ${errorText}`);
    // Another part of the same page is not loaded again.
    await Promise.race([loaded, address.includes('#') ? pause(1000) : loaded]);
  }

  async reload() {
    const loaded = new Promise((resolve) => this.on('Page.loadEventFired', resolve));
    await this.send('Page.reload');
    await loaded;
  }

  async size(width, height) {
    await this.send('Emulation.setDeviceMetricsOverride', { width, height, deviceScaleFactor: 1, mobile: false });
  }

  /** Value of an expression in the page, waited for when it is a promise. */
  async value(expression) {
    const { result, exceptionDetails } = await this.send('Runtime.evaluate',
      { expression, awaitPromise: true, returnByValue: true, userGesture: true });
    if (exceptionDetails) throw new Error(`${expression}: ${exceptionDetails.exception?.description || exceptionDetails.text}`);
    return result.value;
  }

  /** Wait until an expression holds. @return its value */
  async until(expression, seconds = 20) {
    const end = Date.now() + 1000 * seconds;
    for (;;) {
      const value = await this.value(`(() => { const found = ${expression}; return found instanceof Node ? true : found; })()`);
      if (value) return value;
      if (Date.now() > end)
        throw new Error(`not within ${seconds} s: ${expression}\n${(await this.value('document.body.innerText')).slice(0, 2000)}\n${this.messages.join('\n')}`);
      await pause(30);
    }
  }

  /** Choose files of the disk in an input. */
  async choose(selector, ...paths) {
    const { result } = await this.send('Runtime.evaluate', { expression: `document.querySelector(${JSON.stringify(selector)})` });
    if (!result.objectId) throw new Error(`there is no ${selector}`);
    await this.send('DOM.setFileInputFiles', { objectId: result.objectId, files: paths });
  }

  async click(selector) {
    const done = await this.value(`(() => { const found = document.querySelector(${JSON.stringify(selector)});
      if (found) found.click(); return Boolean(found); })()`);
    if (!done) throw new Error(`there is no ${selector}`);
  }

  /** The mouse at a place of the window [px]. */
  async mouse(type, { x, y }, buttons = 0) {
    const button = type === 'mouseMoved' && !buttons ? 'none' : 'left';
    await this.send('Input.dispatchMouseEvent', { type, x, y, button, buttons, clickCount: type === 'mouseMoved' ? 0 : 1 });
  }

  /** Press, move in two steps and let go. */
  async drag(from, to) {
    await this.mouse('mouseMoved', from);
    await this.mouse('mousePressed', from, 1);
    await this.mouse('mouseMoved', { x: (from.x + to.x) / 2, y: (from.y + to.y) / 2 }, 1);
    await this.mouse('mouseMoved', to, 1);
    await this.mouse('mouseReleased', to);
  }

  /** Press a key: 'Tab', 'Enter', 'Escape', 'ArrowRight', ' ' or a letter; modifiers: 8 is Shift. */
  async press(key, modifiers = 0) {
    const codes = { Tab: 9, Enter: 13, Escape: 27, ' ': 32, End: 35, Home: 36, ArrowLeft: 37, ArrowUp: 38, ArrowRight: 39, ArrowDown: 40 };
    const code = codes[key] || key.toUpperCase().charCodeAt(0);
    const text = key === 'Enter' ? '\r' : key.length === 1 ? key : undefined;
    const what = { key, code: key === ' ' ? 'Space' : key, windowsVirtualKeyCode: code, modifiers };
    await this.send('Input.dispatchKeyEvent', { type: text ? 'keyDown' : 'rawKeyDown', text, ...what });
    await this.send('Input.dispatchKeyEvent', { type: 'keyUp', ...what });
  }

  /** Pixels by which the content is wider than the window. */
  overflow() {
    return this.value('document.documentElement.scrollWidth - document.documentElement.clientWidth');
  }

  async picture() {
    const { data } = await this.send('Page.captureScreenshot', { captureBeyondViewport: true });
    return Buffer.from(data, 'base64');
  }

  /** The page as PDF. */
  async print() {
    const { data } = await this.send('Page.printToPDF', { printBackground: false });
    return Buffer.from(data, 'base64');
  }

  /** Violations of WCAG 2.1 A and AA that axe-core finds; `axe`: text of its script. */
  async violations(axe) {
    if (!(await this.value('typeof axe !== "undefined"'))) await this.send('Runtime.evaluate', { expression: axe });
    return this.value(`axe.run(document, { runOnly: ['wcag2a', 'wcag2aa', 'wcag21a', 'wcag21aa'], resultTypes: ['violations'] })
      .then(({ violations }) => violations.map(({ id, help, nodes }) => id + ': ' + help + ': '
        + nodes.slice(0, 3).map((one) => one.html.slice(0, 160) + ' ' + one.failureSummary.slice(0, 200)).join('; ')))`);
  }

  async close() {
    await this.browser.send('Target.closeTarget', { targetId: this.target });
  }
}
