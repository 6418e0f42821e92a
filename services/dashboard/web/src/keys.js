// SPDX-License-Identifier: Apache-2.0
// Keys that work wherever the focus is, except where text or a choice is entered.
import { byId } from './dom.js';

export function addKeys(page) {
  const keys = {
    Home: () => page.lookAtAll(),
    f: () => page.lookAtAll(),
    t: () => page.lookAtAll({ fromAbove: true }),
    1: () => page.tabs.show('robots', { focus: true }),
    2: () => page.tabs.show('closures', { focus: true }),
    3: () => page.tabs.show('revisions', { focus: true }),
    ',': () => page.time.step(-1),
    '.': () => page.time.step(1),
    l: () => page.time.live(),
    Escape: () => page.selectNothing(),
    '?': () => byId('keys').showModal(),
  };
  byId('help').addEventListener('click', keys['?']);
  document.addEventListener('keydown', (event) => {
    const call = keys[event.key.length === 1 ? event.key.toLowerCase() : event.key];
    const elsewhere = event.target.closest('select, [role=listbox], [role=tablist], dialog, input[type=range]');
    if (!call || event.ctrlKey || event.metaKey || event.altKey) return;
    if (elsewhere && (event.key.length > 1 || elsewhere.matches('select, dialog')) && event.key !== 'Escape') return;
    if (byId('keys').open) return;
    event.preventDefault();
    call();
  });
}
