// SPDX-License-Identifier: Apache-2.0
// What the picture shows, how it is drawn, and the switches for it. Remembered by the browser.
import { byId, make, makeSvg, shapeIcon } from '../dom.js';
import * as format from '../format.js';
import { VERDICT_GROUPS, heatGradient } from '../palette.js';

const KEY = 'overtone.layers';
const BANDS = [['sum', 'all bands'], ['small', 'small: neighbours'], ['mid', 'mid: a few hops'], ['large', 'large: far apart']];
const DASHES = { apart: '5 4', constraints: '3 3', waiting: '6 4', refused: '2 4', vetoed: '9 3' };
const DEFAULTS = { paths: true, apart: true, odometry: true, heat: false, constraints: true, used: true, waiting: true, refused: false, vetoed: true, cloud: false };

function sample(key, width) {
  return makeSvg('svg', { viewBox: '0 0 26 12', width: 26, height: 12, class: `sample ${key}`, 'aria-hidden': 'true' },
    makeSvg('line', { x1: 1, x2: 25, y1: 6, y2: 6, 'stroke-width': width, 'stroke-dasharray': DASHES[key] ?? 'none' }));
}

export class Legend {
  #shown = { ...DEFAULTS };
  #counts = new Map();

  /** @param {{onToggle: Function, onBand: Function}} actions */
  constructor(actions) {
    this.actions = actions;
    try {
      Object.assign(this.#shown, JSON.parse(localStorage.getItem(KEY) ?? '{}'));
    } catch { /* nothing is remembered */ }
    this.scale = make('div', { class: 'heat-scale' });
    this.band = make('select', { 'aria-label': 'Band of the discrepancy', onchange: () => actions.onBand(this.band.value) },
      ...BANDS.map(([value, name]) => make('option', { value }, name)));
    this.heat = make('div', { class: 'heat-control' }, this.scale, this.band);
    this.note = make('small', { class: 'note', role: 'status' });
    const closures = VERDICT_GROUPS.map((group) => this.#entry(group.key, `closures ${group.name}`, 1.8, shapeIcon(group.shape, group.key)));
    byId('legend').append(make('details', { open: innerHeight > 620 && innerWidth > 860 }, make('summary', {}, 'Layers'), make('div', { class: 'entries' },
      this.#entry('paths', 'map: each robot its colour', 2.6),
      this.#entry('apart', 'not in the map', 2),
      this.#entry('odometry', 'odometry as uploaded', 1.2),
      ...closures,
      this.#entry('constraints', 'constraints sent to robots', 1.8),
      this.#entry('heat', 'discrepancy', 6), this.heat,
      this.#entry('cloud', 'point clouds', 0), this.note)));
  }

  isShown(key) {
    return this.#shown[key];
  }

  applyAll() {
    for (const key of Object.keys(DEFAULTS)) this.actions.onToggle(key, this.#shown[key]);
    this.heat.hidden = !this.#shown.heat;
  }

  setCount(key, text) {
    this.#counts.get(key).textContent = text;
  }

  setNote(text) {
    this.note.textContent = text;
  }

  setHeat(theme, largest, hasAny) {
    this.scale.replaceChildren(make('span', {}, '0'), make('i', { class: 'ramp' }),
      make('span', {}, hasAny ? format.metres(largest) : 'no report'));
    this.scale.querySelector('.ramp').style.background = `linear-gradient(to right, ${heatGradient(theme).join(', ')})`;
  }

  #entry(key, name, width, icon) {
    const box = make('input', { type: 'checkbox', 'data-layer': key, onchange: () => this.#toggle(key, box.checked) });
    box.checked = this.#shown[key];
    const number = make('b');
    this.#counts.set(key, number);
    return make('label', {}, box, width ? sample(key, width) : make('i', { class: 'dots', 'aria-hidden': 'true' }), icon ?? null, `${name} `, number);
  }

  #toggle(key, shown) {
    this.#shown[key] = shown;
    localStorage.setItem(KEY, JSON.stringify(this.#shown));
    if (key === 'heat') this.heat.hidden = !shown;
    this.actions.onToggle(key, shown);
  }
}
