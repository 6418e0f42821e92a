// SPDX-License-Identifier: Apache-2.0
// Which revision is shown: one that the service has seen, or the newest as it comes.
import { byId } from '../dom.js';
import * as format from '../format.js';

const PLAY_MS = 250;

export class TimeSlider {
  #seen = [];
  #at = null; // position in #seen; null: live
  #timer = null;

  /** @param onShow called with {epoch, revision}, or with null for the newest */
  constructor(onShow) {
    this.onShow = onShow;
    this.slider = byId('slider');
    this.slider.addEventListener('input', () => this.#go(Number(this.slider.value)));
    byId('time').addEventListener('submit', (event) => event.preventDefault());
    byId('live').addEventListener('click', () => this.live());
    byId('play').addEventListener('click', () => this.#play());
  }

  get shown() {
    return this.#at === null ? null : this.#seen[this.#at];
  }

  setSeen(seen) {
    const shown = this.shown;
    this.#seen = seen;
    byId('time').hidden = seen.length < 2;
    this.slider.max = Math.max(0, seen.length - 1);
    if (shown) {
      const at = seen.findIndex(({ epoch, revision }) => epoch === shown.epoch && revision === shown.revision);
      if (at < 0) return this.live(); // no longer kept
      this.#at = at;
    }
    this.#render();
  }

  show(epoch, revision) {
    const at = this.#seen.findIndex((seen) => seen.epoch === epoch && seen.revision === revision);
    if (at >= 0) this.#go(at);
  }

  step(by) {
    const at = this.#at ?? this.#seen.length - 1;
    if (this.#seen.length > 0) this.#go(Math.min(Math.max(at + by, 0), this.#seen.length - 1));
  }

  live() {
    this.#stop();
    const was = this.#at;
    this.#at = null;
    this.#render();
    if (was !== null) this.onShow(null);
  }

  // The last one is the newest: it follows from there.
  #go(at) {
    if (at >= this.#seen.length - 1) return this.live();
    this.#at = at;
    this.#render();
    this.onShow(this.#seen[at]);
  }

  #play() {
    if (this.#timer) {
      this.#stop();
      return this.#render();
    }
    if (this.#at === null) this.#go(0);
    this.#timer = setInterval(() => this.step(1), PLAY_MS);
    this.#render();
  }

  #stop() {
    clearInterval(this.#timer);
    this.#timer = null;
  }

  #render() {
    const shown = this.shown ?? this.#seen.at(-1);
    this.slider.value = this.#at ?? this.#seen.length - 1;
    const text = shown ? `rev ${shown.revision}, ${format.clock(shown.published_ms)}` : '';
    byId('when').textContent = text;
    this.slider.setAttribute('aria-valuetext', text);
    byId('live').setAttribute('aria-pressed', this.#at === null);
    byId('play').textContent = this.#timer ? '❚❚' : '▶';
    byId('play').setAttribute('aria-label', this.#timer ? 'Stop' : 'Play the revisions');
    document.body.classList.toggle('past', this.#at !== null);
  }
}
