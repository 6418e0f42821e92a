// SPDX-License-Identifier: Apache-2.0
// A headless Chromium with a profile of its own, and the processes that a test starts; all of it ends with the test.
import { spawn } from 'node:child_process';
import { mkdirSync, mkdtempSync, rmSync } from 'node:fs';
import { createRequire } from 'node:module';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { createInterface } from 'node:readline';

const { chromium } = createRequire(join(process.env.PAGE_TEST_WEB, 'package.json'))('playwright-core');
const shots = process.env.PAGE_TEST_SHOTS ?? join(process.env.PAGE_TEST_PAGE, '..', 'screenshots');

export const flags = ['--no-sandbox', '--disable-gpu', '--use-gl=angle', '--use-angle=swiftshader', '--enable-unsafe-swiftshader',
  '--disable-background-networking', '--no-first-run', '--disable-component-update', '--disable-sync'];

export class Browser {
  problems = []; // errors in the console, exceptions, and requests to other hosts

  static async start(options = {}) {
    const browser = new Browser();
    browser.profile = mkdtempSync(join(tmpdir(), 'overtone-chromium-'));
    browser.context = await chromium.launchPersistentContext(browser.profile, {
      executablePath: process.env.CHROMIUM, headless: true, viewport: { width: 1500, height: 900 }, colorScheme: 'dark', args: flags, ...options });
    browser.page = browser.context.pages()[0] ?? await browser.context.newPage();
    browser.page.setDefaultTimeout(60_000);
    browser.page.on('console', (message) => message.type() === 'error' && browser.problems.push(message.text()));
    browser.page.on('pageerror', (error) => browser.problems.push(error.stack));
    browser.page.on('request', (request) => {
      if (!['localhost', '127.0.0.1'].includes(new URL(request.url()).hostname)) browser.problems.push(`asked ${request.url()}`);
    });
    return browser;
  }

  async shot(name) {
    mkdirSync(shots, { recursive: true });
    await this.page.screenshot({ path: join(shots, `${name}.png`) });
  }

  async close() {
    await this.context.close();
    rmSync(this.profile, { recursive: true, force: true });
  }
}

/** A process whose first line with "listening on" ends in its address. */
export class Process {
  static async start(program, args) {
    const started = new Process();
    started.child = spawn(program, args, { stdio: ['pipe', 'pipe', 'inherit'] });
    started.lines = createInterface({ input: started.child.stdout })[Symbol.asyncIterator]();
    started.ended = new Promise((resolve) => { started.child.on('exit', resolve); });
    for (;;) {
      const line = await started.lines.next();
      if (line.done) throw new Error(`${program} ended with ${await started.ended}`);
      const found = /listening on (\S+)/.exec(line.value);
      if (found) return Object.assign(started, { address: found[1] });
    }
  }

  /** The answer to a command. */
  async say(command) {
    this.child.stdin.write(`${command}\n`);
    return (await this.lines.next()).value;
  }

  async stop() {
    this.child.kill('SIGTERM');
    await this.ended;
  }
}

/** Runs to its end. */
export async function run(program, args) {
  const child = spawn(program, args, { stdio: ['ignore', 'ignore', 'inherit'] });
  const code = await new Promise((resolve) => { child.on('exit', resolve); });
  if (code !== 0) throw new Error(`${program} ${args.join(' ')} ended with ${code}`);
}

export const startStage = (...args) => Process.start(process.env.PAGE_TEST_STAGE, ['--web-root', process.env.PAGE_TEST_PAGE, ...args]);
