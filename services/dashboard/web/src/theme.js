// SPDX-License-Identifier: Apache-2.0
// Dark or light: as the system has it, until somebody says otherwise here.
import { byId } from './dom.js';

const KEY = 'overtone.theme';
const system = matchMedia('(prefers-color-scheme: dark)');

function chosen() {
  return localStorage.getItem(KEY) ?? (system.matches ? 'dark' : 'light');
}

export function addThemeButton(onChange) {
  const apply = () => {
    document.documentElement.dataset.theme = chosen();
    byId('theme').textContent = chosen() === 'dark' ? '☀' : '☾';
    onChange(chosen());
  };
  byId('theme').addEventListener('click', () => {
    localStorage.setItem(KEY, chosen() === 'dark' ? 'light' : 'dark');
    apply();
  });
  system.addEventListener('change', apply);
  apply();
}
