// SPDX-License-Identifier: Apache-2.0
// Closures by verdict; of the selected one the reason, the figures behind it, and the operator's veto.
import { byId, make, shapeIcon } from '../dom.js';
import * as format from '../format.js';
import { VERDICT_GROUPS, verdictGroup } from '../palette.js';

const STEP = 200; // rows at once

export function endName(end) {
  return `${end.robot}/${end.mission}:${end.index}`;
}

function figure(name, value, limit) {
  return make('div', {}, make('dt', {}, name), make('dd', {}, value, limit ? make('small', {}, ` ${limit}`) : null));
}

function figures(closure) {
  const list = [];
  if (closure.score || closure.score_threshold) {
    list.push(figure('similarity', closure.score.toFixed(3), closure.score_threshold ? `needs ${closure.score_threshold.toFixed(2)}` : ''));
  }
  const found = closure.registration;
  if (found) {
    list.push(figure('overlap', `${(100 * found.overlap).toFixed(0)} %`, `needs ${(100 * found.overlap_threshold).toFixed(0)} %`));
    list.push(figure('residual', format.metres(found.residual_m), `at most ${format.metres(found.residual_limit_m)}`));
    list.push(figure('open directions', found.open_directions));
    list.push(figure('registration', found.converged ? 'converged' : 'did not converge'));
  }
  list.push(figure('weight', closure.weight.toFixed(2), 'of 1'));
  list.push(figure('χ²', closure.chi_square.toFixed(1), '6 degrees of freedom'));
  list.push(figure('proposed by', format.words(closure.proposer)));
  list.push(figure('since revision', closure.since_revision));
  return list;
}

export class ClosuresPanel {
  #filter = new Set(VERDICT_GROUPS.map((group) => group.key));
  #limit = STEP;
  #closures = [];
  #shown = [];
  #selected = null;
  #confirming = false;
  #message = '';

  /** @param {{onSelect: Function, onVeto: Function}} actions */
  constructor(actions) {
    this.actions = actions;
    this.readOnly = true;
    this.chips = make('div', { class: 'chips', role: 'group', 'aria-label': 'Verdicts listed' },
      ...VERDICT_GROUPS.map((group) => make('button', { type: 'button', 'aria-pressed': true, 'data-group': group.key, onclick: () => this.#toggle(group.key) },
        shapeIcon(group.shape, group.key), `${group.name} `, make('b'))));
    this.detail = make('article', { class: 'detail', hidden: true, 'aria-live': 'polite' });
    this.list = make('ul', { class: 'list', role: 'listbox', 'aria-label': 'Closures', tabindex: 0, onkeydown: (event) => this.#key(event) });
    this.more = make('button', { type: 'button', class: 'quiet', onclick: () => this.#showMore() }, 'Show more');
    this.none = make('p', { class: 'none' }, 'No closure was proposed yet. A robot finds its own, or the server searches among the clouds it is sent.');
    byId('closures').append(this.chips, this.detail, this.none, this.list, this.more);
  }

  setClosures(closures, total) {
    // Newest verdicts first; within a revision what somebody may want to look into first.
    const rank = { waiting: 0, refused: 1, vetoed: 2, used: 3 };
    this.#closures = [...closures].sort((a, b) => b.since_revision - a.since_revision || rank[verdictGroup(a.verdict)] - rank[verdictGroup(b.verdict)]);
    this.total = total;
    this.#render();
  }

  counts() {
    const counts = Object.fromEntries(VERDICT_GROUPS.map((group) => [group.key, 0]));
    for (const closure of this.#closures) ++counts[verdictGroup(closure.verdict)];
    return counts;
  }

  select(id, { scroll = true } = {}) {
    this.#confirming = false;
    this.#message = '';
    this.#selected = id;
    const group = id && verdictGroup(this.#closures.find((closure) => closure.id === id)?.verdict);
    if (group && !this.#filter.has(group)) this.#filter.add(group);
    this.#render();
    if (scroll && id) byId(this.#rowId(id))?.scrollIntoView({ block: 'nearest' });
  }

  #toggle(key) {
    if (!this.#filter.delete(key)) this.#filter.add(key);
    this.#render();
  }

  #showMore() {
    this.#limit += 5 * STEP;
    this.#render();
  }

  #rowId(id) {
    return `closure ${id}`;
  }

  #render() {
    const counts = this.counts();
    for (const chip of this.chips.children) {
      chip.querySelector('b').textContent = format.count(counts[chip.dataset.group]);
      chip.setAttribute('aria-pressed', this.#filter.has(chip.dataset.group));
    }
    this.none.hidden = this.#closures.length > 0;
    const wanted = this.#closures.filter((closure) => this.#filter.has(verdictGroup(closure.verdict)));
    this.#shown = wanted.slice(0, Math.max(this.#limit, wanted.findIndex((closure) => closure.id === this.#selected) + 1));
    this.more.hidden = this.#shown.length === wanted.length;
    this.list.hidden = this.#shown.length === 0;
    this.list.replaceChildren(...this.#shown.map((closure) => this.#row(closure)));
    if (this.#selected) this.list.setAttribute('aria-activedescendant', this.#rowId(this.#selected));
    else this.list.removeAttribute('aria-activedescendant');
    this.#renderDetail();
  }

  #row(closure) {
    const group = VERDICT_GROUPS.find(({ key }) => key === verdictGroup(closure.verdict));
    const selected = closure.id === this.#selected;
    return make('li', { role: 'option', id: this.#rowId(closure.id), 'aria-selected': selected, onclick: () => this.actions.onSelect(closure.id) },
      shapeIcon(group.shape, group.key),
      make('span', { class: 'ends' }, endName(closure.from), make('i', {}, ' → '), endName(closure.to)),
      make('small', {}, format.words(closure.verdict)));
  }

  #renderDetail() {
    const closure = this.#closures.find(({ id }) => id === this.#selected);
    this.detail.hidden = !closure;
    if (!closure) return;
    const group = VERDICT_GROUPS.find(({ key }) => key === verdictGroup(closure.verdict));
    this.detail.replaceChildren(
      make('h3', {}, shapeIcon(group.shape, group.key), ` ${format.words(closure.verdict)}`),
      make('p', { class: 'ends' }, endName(closure.from), make('i', {}, ' → '), endName(closure.to)),
      make('p', { class: 'reason' }, closure.reason || 'The server gives no reason.'),
      make('dl', { class: 'figures' }, ...figures(closure)),
      this.#vetoForm(closure, group));
  }

  #vetoForm(closure, group) {
    const row = make('p', { class: 'actions' },
      make('button', { type: 'button', onclick: () => this.actions.onShow(closure.id) }, 'Show'));
    if (this.#message) row.append(make('span', { role: 'status' }, this.#message));
    else if (!this.readOnly && group.key !== 'vetoed') this.#appendVeto(row, closure);
    return row;
  }

  #appendVeto(row, closure) {
    if (!this.#confirming) {
      row.append(make('button', { type: 'button', class: 'danger', id: 'veto', onclick: () => this.#confirm(true) }, 'Veto…'));
      return;
    }
    row.append(make('span', {}, 'The map is rebuilt without it.'),
      make('button', { type: 'button', class: 'danger', id: 'veto-now', onclick: () => this.#veto(closure.id) }, 'Veto'),
      make('button', { type: 'button', onclick: () => this.#confirm(false) }, 'Cancel'));
  }

  #confirm(confirming) {
    this.#confirming = confirming;
    this.#renderDetail();
    byId(confirming ? 'veto-now' : 'veto')?.focus();
  }

  async #veto(id) {
    this.#confirming = false;
    this.#message = 'Asking the server …';
    this.#renderDetail();
    try {
      await this.actions.onVeto(id);
      this.#message = 'Vetoed; the next revision is without it.';
    } catch (error) {
      this.#message = `Not vetoed: ${error.message}`;
    }
    this.#renderDetail();
    this.list.focus();
  }

  #key(event) {
    const at = this.#shown.findIndex((closure) => closure.id === this.#selected);
    const last = this.#shown.length - 1;
    const to = { ArrowDown: Math.min(at + 1, last), ArrowUp: Math.max(at - 1, 0), Home: 0, End: last, PageDown: Math.min(at + 10, last), PageUp: Math.max(at - 10, 0) }[event.key];
    if (event.key === 'Enter' && at >= 0) this.actions.onShow(this.#selected);
    else if (to !== undefined) this.actions.onSelect(this.#shown[to].id);
    else return;
    event.preventDefault();
  }
}
