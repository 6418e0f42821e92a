// SPDX-License-Identifier: Apache-2.0
// The merged cloud: fetched when somebody wants to see it, and again when the map has changed and some time has passed, since the
// server merges all clouds for it.
import { getBytes } from './feed.js';
import * as format from './format.js';
import { decodePly } from './ply.js';

const AGAIN_MS = 20_000;
const VOXEL_M = 0.2;

export class Clouds {
  #shown = false;
  #busy = false;
  #loaded = ''; // epoch and revision
  #asked = 0;
  #refused = false;

  constructor(world, model, say) {
    this.world = world;
    this.model = model;
    this.say = say;
  }

  setShown(shown) {
    this.#shown = shown;
    this.#refused = false;
    this.#asked = 0;
    this.say('');
    this.follow();
  }

  /** Called with every state. */
  follow() {
    const summary = this.model.state?.summary;
    if (!this.#shown || this.#busy || this.#refused || !summary?.exists) return;
    if (summary.clouds === 0) return this.say('no clouds in this map');
    if (this.#loaded === `${summary.epoch}/${summary.revision}` || Date.now() - this.#asked < AGAIN_MS) return;
    this.#load(`${summary.epoch}/${summary.revision}`);
  }

  async #load(revision) {
    this.#busy = true;
    this.#asked = Date.now();
    if (!this.#loaded) this.say('merging clouds …');
    try {
      const points = decodePly(await getBytes(`./api/cloud?voxel_m=${VOXEL_M}`), this.model.origin);
      this.#loaded = revision;
      this.world.cloud.set(points);
      this.world.setVisible('cloud', this.#shown);
      this.say(`${format.count(points.length / 3)} points`);
    } catch (error) {
      // A server that cannot do it is not asked again.
      this.#refused = error.code === 'UNIMPLEMENTED' || error.code === 'INVALID_ARGUMENT';
      this.say(this.#refused ? 'this server does not export clouds' : `no cloud: ${error.message}`);
    }
    this.#busy = false;
  }
}
