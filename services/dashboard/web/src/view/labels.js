// SPDX-License-Identifier: Apache-2.0
// Names in the picture, as elements above it: sharp at any size, and in the page's own font. Those that would cover another stay away.
import { Vector3 } from 'three';
import { make } from '../dom.js';

const MAX_LABELS = 40;

export class Labels {
  #entries = [];
  #place = new Vector3();

  constructor(host, stage) {
    this.host = host;
    this.stage = stage;
    stage.onDraw(() => this.#move());
  }

  /** @param {{text: string, point: number[], kind: string, important?: boolean}[]} labels the first come first */
  set(labels) {
    const wanted = labels.slice(0, MAX_LABELS);
    while (this.#entries.length < wanted.length) {
      const element = make('span', { class: 'label' });
      this.host.append(element);
      this.#entries.push({ element });
    }
    this.#entries.forEach((entry, i) => {
      const label = wanted[i];
      entry.label = label;
      entry.element.hidden = !label;
      if (!label) return;
      entry.element.textContent = label.text;
      entry.element.className = `label ${label.kind}`;
      entry.width = 0;
    });
    this.stage.invalidate();
  }

  #move() {
    const taken = [];
    for (const entry of this.#entries) {
      if (!entry.label) continue;
      const at = this.stage.project(...entry.label.point, this.#place);
      entry.width ||= entry.element.offsetWidth;
      const box = at && { x: at.x + 10, y: at.y - 9, w: entry.width, h: 18 };
      const free = box && !taken.some((other) => box.x < other.x + other.w && other.x < box.x + box.w && box.y < other.y + other.h && other.y < box.y + box.h);
      entry.element.style.visibility = free ? 'visible' : 'hidden';
      if (!free) continue;
      taken.push(box);
      entry.element.style.transform = `translate(${box.x.toFixed(1)}px, ${box.y.toFixed(1)}px)`;
    }
  }
}
