// SPDX-License-Identifier: Apache-2.0
// Keeps the page's copy of what the service knows: listens for "there is something newer", then fetches what changed. One round at a
// time, so a slow link skips versions instead of queueing them.
import { decodeFrame } from './frame.js';

const RETRY_MS = 2000;
const POLL_MS = 5000;

async function get(path) {
  const response = await fetch(path, { cache: 'no-store' });
  if (response.ok) return response;
  const detail = await response.json().catch(() => ({}));
  throw Object.assign(new Error(detail.error ?? `${response.status} ${response.statusText}`), { code: detail.code });
}

export const getJson = async (path) => (await get(path)).json();
export const getBytes = async (path) => (await get(path)).arrayBuffer();

export async function postVeto(id) {
  const response = await fetch('./api/closures/veto', {
    method: 'POST',
    headers: { 'Content-Type': 'application/json', 'X-Overtone-Dashboard': '1' },
    body: JSON.stringify({ id }),
  });
  if (response.ok) return;
  const detail = await response.json().catch(() => ({}));
  throw new Error(detail.error ?? `${response.status} ${response.statusText}`);
}

const TRACKS = ['positions', 'odometry', 'discrepancy'];
const LISTS = ['closures', 'revisions'];

/** Events: state, positions, odometry, discrepancy, closures, revisions (detail: what came) and down (detail: the error). */
export class Feed extends EventTarget {
  #versions = Object.fromEntries([...TRACKS, ...LISTS].map((kind) => [kind, 0]));
  #events = null;
  #busy = false;
  #again = false;
  #missed = 0;
  #instance = null;

  start() {
    this.#listen();
    // Where the service has no room for another listener, and after a lost one.
    setInterval(() => {
      if (++this.#missed > 1 || this.#events.readyState === EventSource.CLOSED) this.refresh();
    }, POLL_MS);
    this.refresh();
  }

  #listen() {
    this.#events = new EventSource('./api/events');
    this.#events.onmessage = () => this.refresh();
    this.#events.onerror = () => {
      if (this.#events.readyState !== EventSource.CLOSED) return; // it tries again by itself
      setTimeout(() => this.#listen(), POLL_MS);
    };
  }

  async refresh() {
    this.#missed = 0;
    if (this.#busy || document.hidden) {
      this.#again = true;
      return;
    }
    this.#busy = true;
    try {
      await this.#round();
    } catch (error) {
      this.#emit('down', error);
      setTimeout(() => this.refresh(), RETRY_MS);
    }
    this.#busy = false;
    if (this.#again && !document.hidden) {
      this.#again = false;
      this.refresh();
    }
  }

  async #round() {
    const state = await getJson('./api/state');
    this.#forgetIfRestarted(state);
    this.#emit('state', state);
    const changed = (kind) => state.versions[kind] > this.#versions[kind];
    for (const kind of TRACKS.filter(changed)) {
      const frame = decodeFrame(await getBytes(`./api/${kind}?since=${this.#versions[kind]}`));
      this.#versions[kind] = frame.version;
      this.#emit(kind, frame);
    }
    for (const kind of LISTS.filter(changed)) {
      const list = await getJson(`./api/${kind}`);
      this.#versions[kind] = list.version;
      this.#emit(kind, list);
    }
  }

  // A new process counts versions from 0, and numbers missions anew.
  #forgetIfRestarted(state) {
    if (this.#instance && state.instance !== this.#instance) {
      for (const kind of Object.keys(this.#versions)) this.#versions[kind] = 0;
      this.#emit('restart', null);
    }
    this.#instance = state.instance;
  }

  #emit(name, detail) {
    this.dispatchEvent(new CustomEvent(name, { detail }));
  }
}
