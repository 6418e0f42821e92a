// SPDX-License-Identifier: Apache-2.0
// Tabs after the WAI-ARIA pattern: one of them is in the tab order, arrow keys change.
import { byId } from '../dom.js';

export class Tabs {
  #tabs = [...document.querySelectorAll('[role=tab]')];

  constructor() {
    for (const tab of this.#tabs) {
      tab.addEventListener('click', () => this.show(tab.getAttribute('aria-controls')));
      tab.addEventListener('keydown', (event) => this.#key(event));
    }
  }

  get shown() {
    return this.#tabs.find((tab) => tab.getAttribute('aria-selected') === 'true').getAttribute('aria-controls');
  }

  show(panel, { focus = false } = {}) {
    for (const tab of this.#tabs) {
      const selected = tab.getAttribute('aria-controls') === panel;
      tab.setAttribute('aria-selected', selected);
      tab.tabIndex = selected ? 0 : -1;
      byId(tab.getAttribute('aria-controls')).hidden = !selected;
      if (selected && focus) tab.focus();
    }
  }

  setCount(panel, text) {
    const tab = this.#tabs.find((candidate) => candidate.getAttribute('aria-controls') === panel);
    tab.querySelector('b').textContent = text;
  }

  #key(event) {
    const at = this.#tabs.indexOf(event.currentTarget);
    const to = { ArrowRight: at + 1, ArrowLeft: at - 1, Home: 0, End: this.#tabs.length - 1 }[event.key];
    if (to === undefined) return;
    event.preventDefault();
    this.show(this.#tabs.at(to % this.#tabs.length).getAttribute('aria-controls'), { focus: true });
  }
}
