// SPDX-License-Identifier: Apache-2.0
// The installed programs together: a mapping server, a simulated team that is played into it, the dashboard before it.
import assert from 'node:assert/strict';
import { mkdtempSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { Browser, Process, run } from './browser.mjs';

const { PAGE_TEST_SERVER: server, PAGE_TEST_DASHBOARD: dashboard, PAGE_TEST_PROGRAM: program, PAGE_TEST_PAGE: root } = process.env;
const folder = mkdtempSync(join(tmpdir(), 'overtone-live-'));
const started = [];
let browser;
let mapping;

before(async () => {
  mapping = await Process.start(server, ['--listen', 'localhost:0', '--data-dir', ':memory:']);
  started.push(mapping);
  const page = await Process.start(dashboard, ['--server', mapping.address, '--listen', 'localhost:0', '--web-root', root, '--interval', '0.2']);
  started.push(page);
  browser = await Browser.start();
  await browser.page.goto(page.address);
});

after(async () => {
  await browser?.close();
  for (const process of started.reverse()) await process.stop();
  rmSync(folder, { recursive: true, force: true });
});

test('an empty map says what to do next', async () => {
  await browser.page.locator('#empty', { hasText: 'overtone replay' }).waitFor();
  assert.match(await browser.page.locator('#empty').innerText(), new RegExp(`--server ${mapping.address}`));
  await browser.shot('live_empty');
});

test('a team that drives appears, with its closures and revisions', async () => {
  const { page } = browser;
  await run(program, ['simulate', '--scenario', 'tunnel', '--robots', '2', '--length', '60', '--rings', '8', '--columns', '180', '--out', join(folder, 'team')]);
  await run(program, ['replay', '--dataset', 'pcd', join(folder, 'team'), '--out', join(folder, 'run'), '--server', mapping.address, '--map', 'default']);
  await page.locator('#robots tbody tr').nth(1).waitFor();
  assert.ok(await page.locator('#empty').isHidden());
  await page.waitForFunction(() => window.overtone.world.paths.segments + window.overtone.world.apart.segments > 20);
  await page.waitForFunction(() => window.overtone.model.closures.length > 0);
  await page.waitForFunction(() => window.overtone.model.seen.length > 1);
  await page.locator('#tab-closures').click();
  await page.locator('#closures [role=option]').first().click();
  assert.ok((await page.locator('.detail .reason').innerText()).length > 10);
  await browser.shot('live_team');
});

test('an operator vetoes, and the server rebuilds its map', async () => {
  const { page } = browser;
  const before = await page.evaluate(() => window.overtone.model.state.summary.revision);
  await page.locator('#veto').click();
  await page.locator('#veto-now').click();
  await page.locator('.detail h3', { hasText: 'vetoed by operator' }).waitFor();
  assert.ok(await page.evaluate(() => window.overtone.model.state.summary.revision) > before);
  assert.deepEqual(browser.problems, []);
});
