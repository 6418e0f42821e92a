// SPDX-License-Identifier: Apache-2.0
// The page in a browser, before a map of which everything is known.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { Browser, startStage } from './browser.mjs';

let stage;
let browser;
let page;

before(async () => {
  stage = await startStage('--robots', '6');
  browser = await Browser.start();
  page = browser.page;
  await page.goto(stage.address);
  await page.locator('#robots tbody tr').nth(5).waitFor();
  await page.waitForFunction(() => window.overtone.model.seen.length > 0);
});

after(async () => {
  await browser?.close();
  await stage?.stop();
});

const text = (selector) => page.locator(selector).first().innerText();

// Pixels that are not the ground's, of the picture as it is drawn now.
const drawn = () => page.evaluate(() => {
  const { stage: view } = window.overtone;
  view.draw();
  const gl = view.renderer.getContext();
  const [width, height] = [gl.drawingBufferWidth, gl.drawingBufferHeight];
  const pixels = new Uint8Array(4 * width * height);
  gl.readPixels(0, 0, width, height, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
  const ground = view.scene.background.toArray().map((value) => 255 * value);
  let count = 0;
  for (let i = 0; i < pixels.length; i += 4) {
    if (Math.max(...[0, 1, 2].map((k) => Math.abs(pixels[i + k] - ground[k]))) > 40) ++count;
  }
  return { count, calls: view.renderer.info.render.calls };
});

test('shows missions, robots and what they report', async () => {
  assert.equal(await text('#map-name'), 'default');
  assert.equal(await text('#link'), '● live');
  assert.match(await text('#facts'), /5 of 6/);
  const row = await text('#robots tbody tr:nth-child(4)');
  for (const part of ['robot04', 'away', '6.3 MB', '+3.2 ms', '8 new', '1.42 m → 6.1 cm']) assert.ok(row.includes(part), `${part} in ${row}`);
  const { count, calls } = await drawn();
  assert.ok(count > 3000, `${count} pixels`);
  assert.ok(calls <= 20, `${calls} draw calls`);
  await browser.shot('page_dark');
});

test('what is not in the map stands apart, dashed and said so', async () => {
  const label = page.locator('.label.apart');
  assert.match(await label.innerText(), /not in the map/);
  const places = await page.evaluate(() => {
    const { world } = window.overtone;
    return { apart: world.apart.segments, frames: world.layout.frames, map: world.layout.map.max[0], dashed: world.apart.isDashed };
  });
  assert.equal(places.apart, 599);
  assert.ok(places.dashed);
  assert.ok(places.frames[0].min[0] > places.map);
});

test('a closure is found, explained and vetoed with the keyboard alone', async () => {
  await page.keyboard.press('2');
  await page.locator('#tab-closures[aria-selected=true]').waitFor();
  await page.locator('#closures .list').focus();
  await page.keyboard.press('ArrowDown');
  await page.keyboard.press('ArrowDown');
  await page.keyboard.press('Home');
  const detail = page.locator('.detail');
  assert.match(await detail.innerText(), /quarantined[\s\S]*would tie two components[\s\S]*similarity[\s\S]*needs 0.60/);
  assert.equal(await page.locator('#closures [aria-selected=true]').count(), 1);
  await browser.shot('page_closure');
  await page.locator('#veto').focus();
  await page.keyboard.press('Enter');
  assert.equal(await page.evaluate(() => document.activeElement.id), 'veto-now');
  await page.keyboard.press('Enter');
  await page.locator('.detail h3', { hasText: 'vetoed by operator' }).waitFor();
  assert.equal(await page.locator('#veto').count(), 0);
  assert.equal(await text('.chips [data-group=vetoed] b'), '1');
});

test('a click on a closure in the picture shows why', async () => {
  await page.keyboard.press('Escape');
  await page.locator('.detail').waitFor({ state: 'hidden' });
  const target = await page.evaluate(() => {
    const { world, model, stage: view } = window.overtone;
    const box = view.renderer.domElement.getBoundingClientRect();
    for (const closure of model.closures) {
      const { min, max } = world.boxOfClosure(closure.id);
      const middle = view.project(...min.map((value, k) => (value + max[k]) / 2));
      const id = middle && world.pick(middle.x, middle.y, (key) => key === 'used');
      if (id) return { id, x: box.left + middle.x, y: box.top + middle.y };
    }
    return null;
  });
  await page.mouse.click(target.x, target.y);
  await page.locator('.detail').waitFor();
  const [from, to] = target.id.split('#')[0].split('>');
  assert.ok((await text('.detail .ends')).includes(from));
  assert.ok((await text('.detail .ends')).includes(to));
});

test('earlier revisions are shown, and the newest again', async () => {
  for (let i = 0; i < 4; ++i) {
    const before = await page.evaluate(() => window.overtone.model.seen.length);
    assert.equal(await stage.say('advance'), 'ok');
    await page.waitForFunction((count) => window.overtone.model.seen.length > count, before);
  }
  const last = () => page.evaluate(() => [...window.overtone.world.pointOf(window.overtone.model.missions[0], 599)]);
  const newest = await last();
  await page.keyboard.press(',');
  await page.keyboard.press(',');
  await page.waitForFunction(() => window.overtone.model.past !== null);
  assert.match(await text('#when'), /rev \d+/);
  assert.ok(await page.evaluate(() => document.body.classList.contains('past')));
  assert.notDeepEqual(await last(), newest);
  await page.keyboard.press('l');
  await page.waitForFunction(() => window.overtone.model.past === null);
  assert.deepEqual(await last(), newest);
  await page.keyboard.press('3');
  await page.locator('#revisions tbody button').last().click();
  await page.waitForFunction(() => window.overtone.model.past?.revision === 1);
  await browser.shot('page_past');
  await page.locator('#live').click();
});

test('discrepancy, odometry and clouds are switched on and off', async () => {
  const visible = (layer) => page.evaluate((key) => window.overtone.world[key].wide.visible || window.overtone.world[key].thin.visible, layer);
  assert.equal(await visible('heat'), false);
  await page.locator('[data-layer=heat]').check();
  assert.equal(await visible('heat'), true);
  assert.match(await text('.heat-scale'), /0[\s\S]* m/);
  const all = await page.evaluate(() => window.overtone.world.heatMax);
  await page.locator('.heat-control select').selectOption('small');
  assert.ok(await page.evaluate(() => window.overtone.world.heatMax) < all);
  await page.locator('[data-layer=odometry]').uncheck();
  assert.equal(await visible('odometry'), false);
  await page.locator('[data-layer=cloud]').check();
  await page.locator('#legend .note', { hasText: '20,000 points' }).waitFor();
  await browser.shot('page_layers');
});

test('a robot is picked out with the keyboard', async () => {
  await page.keyboard.press('1');
  await page.locator('#robots button.name', { hasText: 'robot03' }).focus();
  await page.keyboard.press('Enter');
  assert.equal(await page.locator('#robots tr.selected').innerText().then((row) => row.includes('robot03')), true);
  assert.match(await text('.missions'), /run1[\s\S]*600 nodes[\s\S]*in the map/);
  const outline = await page.evaluate(() => getComputedStyle(document.activeElement).outlineStyle);
  assert.notEqual(outline, 'none');
  await page.keyboard.press('Escape');
  assert.equal(await page.locator('#robots tr.selected').count(), 0);
});

test('the camera obeys keys, and nothing is drawn while nothing changes', async () => {
  const position = () => page.evaluate(() => window.overtone.stage.camera.position.toArray());
  await page.emulateMedia({ reducedMotion: 'reduce' });
  await page.locator('#view').focus();
  let last = await position();
  for (const key of ['ArrowRight', 'ArrowUp', 'Shift+ArrowLeft', '+', '-', 't', 'f']) {
    await page.keyboard.press(key);
    const next = await position();
    assert.notDeepEqual(next, last, key);
    last = next;
  }
  await page.keyboard.press('?');
  assert.ok(await page.locator('#keys').isVisible());
  await page.keyboard.press('Escape');
});

test('says so when the mapping server is away, keeps the picture, and goes on when it is back', async () => {
  await stage.say('refuse');
  await page.locator('#banner', { hasText: 'does not answer' }).waitFor();
  assert.match(await text('#banner'), /not today/);
  assert.equal(await text('#link'), '○ not connected');
  assert.equal(await page.locator('#robots tbody tr').count(), 6);
  await browser.shot('page_away');
  await stage.say('answer');
  await page.locator('#banner').waitFor({ state: 'hidden' });
  assert.equal(await text('#link'), '● live');
});

test('light, narrow and dark', async () => {
  await page.emulateMedia({ colorScheme: 'light', reducedMotion: 'reduce' });
  await page.waitForFunction(() => document.documentElement.dataset.theme === 'light');
  await browser.shot('page_light');
  await page.locator('#theme').click();
  assert.equal(await page.evaluate(() => document.documentElement.dataset.theme), 'dark');
  await page.setViewportSize({ width: 600, height: 900 });
  assert.ok(await page.evaluate(() => document.documentElement.scrollWidth <= innerWidth));
  await browser.shot('page_narrow');
  await page.setViewportSize({ width: 1500, height: 900 });
});

test('where nobody may veto there is no button for it', async () => {
  const readOnly = await startStage('--robots', '2', '--read-only');
  try {
    const other = await browser.context.newPage();
    await other.goto(readOnly.address);
    await other.locator('#tab-closures').click();
    await other.locator('#closures [role=option]').first().click();
    await other.locator('.detail .actions').waitFor();
    assert.equal(await other.locator('#veto').count(), 0);
    await other.close();
  } finally {
    await readOnly.stop();
  }
});

test('says so when the service itself is away', async () => {
  assert.deepEqual(browser.problems, []); // from here on the browser says that it cannot connect
  await stage.stop();
  await page.locator('#banner', { hasText: 'dashboard service does not answer' }).waitFor();
});
