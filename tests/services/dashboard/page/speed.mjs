// SPDX-License-Identifier: Apache-2.0
// 100 missions of 1,000 nodes each. Prints how fast they are drawn and updated; here that is on the processor (SwiftShader), not on a
// graphics card, so only what does not depend on the machine is asserted.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { Browser, startStage } from './browser.mjs';

const TURN_FRAMES = 20;
let stage;
let browser;
let page;

before(async () => {
  stage = await startStage('--robots', '100', '--nodes', '1000');
  browser = await Browser.start();
  page = browser.page;
  page.setDefaultTimeout(200_000);
  await page.goto(stage.address);
  await page.waitForFunction(() => window.overtone.model.tracks.positions.size === 100 && window.overtone.model.tracks.odometry.size === 100
    && window.overtone.model.closures.length > 0 && window.overtone.model.tracks.discrepancy.size === 100);
});

after(async () => {
  await browser?.close();
  await stage?.stop();
});

test('100,000 nodes are drawn in a few calls, and turned', async () => {
  const result = await page.evaluate(async (frames) => {
    const { stage: view, world } = window.overtone;
    const gl = view.renderer.getContext();
    const timed = (call) => {
      const start = performance.now();
      call();
      gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(4)); // until it is on the screen
      return performance.now() - start;
    };
    timed(() => view.draw()); // compiles
    const full = timed(() => view.draw());
    const { calls } = view.renderer.info.render;
    const moving = [];
    for (let i = 0; i < frames; ++i) {
      await new Promise(requestAnimationFrame);
      view.turn(0.05, 0);
      const time = timed(() => view.draw());
      if (!view.hasDetail) moving.push(time);
    }
    moving.sort((a, b) => a - b);
    return { full, moving: moving[moving.length >> 1] ?? null, calls, segments: [world.paths, world.apart, world.odometry].map((layer) => layer.segments) };
  }, TURN_FRAMES);
  console.log(`speed: frame in full ${result.full.toFixed(0)} ms, while it turns ${result.moving === null ? 'the same' : `${result.moving.toFixed(0)} ms (in fewer lines)`}, ${result.calls} draw calls, segments ${result.segments}; software GL`);
  await browser.shot('speed');
  assert.equal(result.segments[0] + result.segments[1], 100 * 999);
  assert.equal(result.segments[2], 100 * 999);
  assert.ok(result.calls <= 20);
  await page.waitForFunction(() => window.overtone.stage.hasDetail);
  assert.ok(await page.evaluate(() => window.overtone.world.paths.thin.visible));
});

test('a revision that moves everything is taken over', async () => {
  await page.evaluate(() => {
    const { world } = window.overtone;
    window.updates = [];
    for (const name of ['update', 'updateClosures', 'updateRobots']) {
      const call = world[name].bind(world);
      world[name] = (...args) => {
        const start = performance.now();
        call(...args);
        window.updates.push([name, performance.now() - start]);
      };
    }
  });
  const seen = await page.evaluate(() => window.overtone.model.state.summary.revision);
  await stage.say('advance');
  await page.waitForFunction((revision) => window.overtone.model.revisions[0]?.revision > revision, seen);
  const updates = await page.evaluate(() => window.updates);
  console.log(`speed: update ${updates.map(([name, time]) => `${name} ${time.toFixed(1)} ms`).join(', ')}`);
  assert.ok(updates.some(([name]) => name === 'update'));
});

test('a frame without change is not drawn', async () => {
  const draws = await page.evaluate(async () => {
    const { stage: view } = window.overtone;
    let count = 0;
    const draw = view.renderer.render.bind(view.renderer);
    await new Promise(requestAnimationFrame);
    await new Promise(requestAnimationFrame);
    view.renderer.render = (...args) => { ++count; draw(...args); };
    for (let i = 0; i < 10; ++i) await new Promise(requestAnimationFrame);
    return count;
  });
  assert.ok(draws <= 2, `${draws} of 10`);
});
