// SPDX-License-Identifier: Apache-2.0
// What each revision changed, and where the time of the server's cycles went.
import { byId, make, makeSvg } from '../dom.js';
import * as format from '../format.js';

const ROWS = 100;
const BARS = 60;
const STAGES = ['intake', 'optimise', 'snapshot', 'store', 'publish'];
const [WIDTH, HEIGHT] = [420, 88];

/** Seconds of each stage; of a server that tells none, the optimisation alone. */
export function stageTimes(revision) {
  const times = new Map(revision.stages.map(({ stage, seconds }) => [stage, seconds]));
  if (times.size === 0) times.set('optimise', revision.optimisation_s);
  return times;
}

function stageClass(stage) {
  const at = STAGES.indexOf(stage);
  return `stage-${at < 0 ? STAGES.length : at}`;
}

function cycleChart(revisions) {
  const shown = revisions.slice(0, BARS).reverse();
  const totals = shown.map((revision) => [...stageTimes(revision).values()].reduce((a, b) => a + b, 0));
  const largest = Math.max(...totals, 1e-6);
  const step = WIDTH / BARS;
  const bars = shown.flatMap((revision, i) => {
    let below = 0;
    return [...stageTimes(revision)].map(([stage, seconds]) => {
      const height = (seconds / largest) * (HEIGHT - 14);
      below += height;
      return makeSvg('rect', { x: (WIDTH - (shown.length - i) * step).toFixed(1), y: (HEIGHT - below).toFixed(1), width: Math.max(1, step - 1.5).toFixed(1), height: Math.max(0.4, height).toFixed(1), class: stageClass(stage) });
    });
  });
  const top = makeSvg('text', { x: 0, y: 10 });
  top.textContent = `up to ${format.seconds(largest)}`;
  return makeSvg('svg', { viewBox: `0 0 ${WIDTH} ${HEIGHT}`, class: 'cycles', role: 'img', 'aria-label': `Cycle times of the last ${shown.length} revisions, up to ${format.seconds(largest)}` },
    makeSvg('line', { x1: 0, x2: WIDTH, y1: HEIGHT - 0.5, y2: HEIGHT - 0.5 }), ...bars, top);
}

export class RevisionsPanel {
  /** @param onShow called with epoch and revision */
  constructor(onShow) {
    this.onShow = onShow;
    this.cycles = make('figure', { class: 'cycle-figure' });
    this.body = make('tbody');
    this.none = make('p', { class: 'none' }, 'No revision yet: the first one follows the first submap.');
    this.table = make('table', { class: 'revisions' }, make('thead', {}, make('tr', {},
      ...[['Revision', ''], ['Nodes', ''], ['Closures', 'that came into use, and that went out of use'], ['Moved', 'keyframes of the revision before: mean and largest'], ['Cycle', 'time of the mapping cycle']]
        .map(([name, title]) => make('th', { scope: 'col', title }, name)))), this.body);
    byId('revisions').append(this.none, this.cycles, this.table);
  }

  update(revisions, seen, shown) {
    this.none.hidden = revisions.length > 0;
    this.table.hidden = this.cycles.hidden = revisions.length === 0;
    if (revisions.length === 0) return;
    const newest = stageTimes(revisions[0]);
    this.cycles.replaceChildren(make('figcaption', {}, 'Cycle times ', make('small', {}, 'newest on the right')), cycleChart(revisions),
      make('p', { class: 'stages' }, ...[...newest].map(([stage, seconds]) => make('span', {}, make('i', { class: stageClass(stage) }), `${stage} ${format.seconds(seconds)}`))));
    const kept = new Set(seen.map(({ epoch, revision }) => `${epoch}/${revision}`));
    this.body.replaceChildren(...revisions.slice(0, ROWS).map((revision) => this.#row(revision, kept, shown)));
  }

  #row(revision, kept, shown) {
    const key = `${revision.epoch}/${revision.revision}`;
    const name = kept.has(key)
      ? make('button', { type: 'button', class: 'name', onclick: () => this.onShow(revision.epoch, revision.revision) }, revision.revision)
      : make('span', {}, revision.revision);
    const total = [...stageTimes(revision).values()].reduce((a, b) => a + b, 0);
    const cells = [
      [make('span', {}, `${format.count(revision.keyframes)}`), `${revision.anchored_missions} of ${revision.missions} missions in`],
      [`+${revision.accepted.length} −${revision.dropped.length}`, ''],
      [format.metres(revision.mean_move_m), `largest ${format.metres(revision.largest_move_m)}`],
      [format.seconds(total), ''],
    ];
    return make('tr', { class: key === shown ? 'selected' : '' },
      make('th', { scope: 'row' }, name, make('small', {}, format.clock(revision.published_ms))),
      ...cells.map(([text, more]) => make('td', {}, make('span', {}, text), make('small', {}, more))));
  }
}
