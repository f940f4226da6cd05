// Chromium through its debugging pipe (file descriptors 3 and 4, messages ended by a zero byte): no WebSocket, no
// package. One browser, one page.
import { spawn } from 'node:child_process';
import { mkdtempSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';

const kAnswerTimeoutMs = 60000;

export class Browser {
  static async start(program) {
    const browser = new Browser();
    browser.profile = mkdtempSync(join(tmpdir(), 'pac-chromium-'));
    browser.process = spawn(program, ['--headless', '--no-sandbox', '--disable-gpu', '--disable-dev-shm-usage',
      '--remote-debugging-pipe', `--user-data-dir=${browser.profile}`, '--window-size=1280,1000', 'about:blank'],
      { stdio: ['ignore', 'ignore', 'ignore', 'pipe', 'pipe'] });
    browser.exited = new Promise(resolve => browser.process.on('exit', resolve));
    browser.pending = new Map();
    browser.listeners = [];
    browser.nextId = 1;
    browser.receive(browser.process.stdio[4]);
    const { targetId } = await browser.send('Target.createTarget', { url: 'about:blank' });
    browser.session = (await browser.send('Target.attachToTarget', { targetId, flatten: true })).sessionId;
    for (const domain of ['Page', 'Runtime', 'Log', 'Network']) await browser.send(`${domain}.enable`);
    return browser;
  }

  receive(stream) {
    let buffered = Buffer.alloc(0);
    stream.on('data', chunk => {
      buffered = Buffer.concat([buffered, chunk]);
      for (let end = buffered.indexOf(0); end >= 0; end = buffered.indexOf(0)) {
        const message = JSON.parse(buffered.subarray(0, end).toString());
        buffered = buffered.subarray(end + 1);
        if (message.id === undefined) {
          for (const listener of this.listeners) listener(message);
          continue;
        }
        const { resolve, reject, timer } = this.pending.get(message.id);
        clearTimeout(timer);
        this.pending.delete(message.id);
        if (message.error) reject(new Error(message.error.message));
        else resolve(message.result);
      }
    });
  }

  send(method, params = {}) {
    const id = this.nextId++;
    const message = { id, method, params };
    if (this.session) message.sessionId = this.session;
    return new Promise((resolve, reject) => {
      const timer = setTimeout(() => reject(new Error(`${method}: no answer`)), kAnswerTimeoutMs);
      this.pending.set(id, { resolve, reject, timer });
      this.process.stdio[3].write(JSON.stringify(message) + '\0');
    });
  }

  onEvent(listener) { this.listeners.push(listener); }

  nextEvent(method) {
    return new Promise(resolve => {
      const listener = message => {
        if (message.method !== method) return;
        this.listeners.splice(this.listeners.indexOf(listener), 1);
        resolve(message.params);
      };
      this.listeners.push(listener);
    });
  }

  async open(url) {
    const loaded = this.nextEvent('Page.loadEventFired');
    await this.send('Page.navigate', { url });
    await loaded;
  }

  // The value of an expression (or of the promise that it gives) in the page.
  async evaluate(expression) {
    const { result, exceptionDetails } =
      await this.send('Runtime.evaluate', { expression, awaitPromise: true, returnByValue: true });
    if (exceptionDetails) throw new Error(exceptionDetails.exception?.description ?? exceptionDetails.text);
    return result.value;
  }

  async drag(from, to) {
    const mouse = (type, point) => this.send('Input.dispatchMouseEvent',
      { type, x: point.x, y: point.y, button: 'left', buttons: type === 'mouseReleased' ? 0 : 1, clickCount: 1 });
    await mouse('mousePressed', from);
    await mouse('mouseMoved', { x: (from.x + to.x) / 2, y: (from.y + to.y) / 2 });
    await mouse('mouseMoved', to);
    await mouse('mouseReleased', to);
  }

  async press(key) {
    for (const type of ['keyDown', 'keyUp']) await this.send('Input.dispatchKeyEvent', { type, key });
  }

  // clip: a rectangle of the visible part of the page. A PNG file in base64.
  async screenshot(clip) {
    const scrolled = await this.evaluate('({ x: scrollX, y: scrollY })');
    clip = { ...clip, x: clip.x + scrolled.x, y: clip.y + scrolled.y };
    return (await this.send('Page.captureScreenshot', { format: 'png', clip: { ...clip, scale: 1 } })).data;
  }

  async close() {
    this.process.stdio[3].end();
    this.process.kill();
    await this.exited;
    rmSync(this.profile, { recursive: true, force: true, maxRetries: 5 });
  }
}
