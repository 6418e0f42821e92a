// SPDX-License-Identifier: Apache-2.0
// The table of robots. Rows are made once and then only their text changes, so that focus and selection stay.
import { byId, make } from '../dom.js';
import * as format from '../format.js';

const COLUMNS = [
  ['Robot', 'its missions: in the map, and not'],
  ['Link', 'streams that are open to the server'],
  ['Backlog', 'handed over on the robot and not acknowledged yet'],
  ['Up / down', 'bytes a second over the last seconds, as the server counts them'],
  ['Clock', "the robot's minus the server's, and what it is certainly within"],
  ['Last correction', 'constraints handed to the onboard estimator; root mean square to the map before, and predicted after'],
];

function linkState(robot) {
  if (robot.uploading && robot.watching) return { text: 'connected', sign: '●', kind: 'good', more: '' };
  if (robot.uploading) return { text: 'uploads', sign: '▲', kind: 'good', more: 'watches nothing' };
  if (robot.watching) return { text: 'watches', sign: '▼', kind: 'good', more: format.ago(robot.last_upload_ms) };
  return { text: 'away', sign: '○', kind: 'bad', more: format.ago(robot.last_upload_ms) };
}

function backlog(robot) {
  const { link } = robot;
  if (!link) return ['–', ''];
  const waiting = link.submaps_waiting + link.blobs_waiting;
  const dropped = link.clouds_dropped ? `${format.count(link.clouds_dropped)} lost` : '';
  if (waiting === 0) return ['none', dropped];
  return [format.bytes(link.bytes_waiting), dropped || `${format.count(waiting)} waiting`];
}

function clock(robot) {
  const offset = robot.link?.clock_offset_s;
  if (offset === null || offset === undefined) return ['–', ''];
  const sign = offset > 0 ? '+' : '';
  return [sign + format.seconds(offset), `± ${format.seconds(robot.link.clock_offset_uncertainty_s)}`];
}

function correction(robot) {
  const comparison = robot.comparison;
  if (!comparison) return ['–', ''];
  if (comparison.held_back) return ['held back', comparison.held_back];
  const added = Object.values(comparison.constraints).reduce((sum, value) => sum + value, 0);
  const what = added + comparison.updated + comparison.retracted === 0 ? 'nothing to do'
    : [`${added} new`, comparison.updated && `${comparison.updated} upd.`, comparison.retracted && `${comparison.retracted} off`].filter(Boolean).join(', ');
  const before = comparison.rmse_before_m;
  if (before === null) return [what, `rev ${comparison.revision}`];
  const after = comparison.predicted_rmse_m === null ? '' : ` → ${format.metres(comparison.predicted_rmse_m)}`;
  return [what, `${format.metres(before)}${after}`];
}

class Row {
  constructor(robot, onSelect) {
    this.swatch = make('i', { class: 'swatch' });
    this.name = make('button', { type: 'button', class: 'name', onclick: () => onSelect(robot) }, this.swatch, robot);
    this.cells = COLUMNS.map(() => [make('span'), make('small')]);
    this.cells[0][0].append(this.name);
    this.element = make('tr', {}, ...this.cells.map(([text, more], i) => make(i === 0 ? 'th' : 'td', i === 0 ? { scope: 'row' } : {}, text, more)));
  }

  update(robot, missions, colour, selected) {
    const apart = missions.filter((mission) => !mission.anchored).length;
    this.swatch.style.background = colour;
    this.name.setAttribute('aria-pressed', selected);
    this.element.classList.toggle('selected', selected);
    this.cells[0][1].textContent = apart === 0 ? `${format.count(robot.keyframes)} nodes` : apart === missions.length ? 'not in the map' : `${apart} of ${missions.length} not in the map`;
    const state = linkState(robot);
    this.#set(1, `${state.sign} ${state.text}`, state.more);
    this.cells[1][0].className = state.kind;
    this.#set(2, ...backlog(robot));
    this.#set(3, `↑ ${format.rate(robot.received_bytes_per_s)}`, `↓ ${format.rate(robot.sent_bytes_per_s)}`);
    this.#set(4, ...clock(robot));
    this.#set(5, ...correction(robot));
  }

  #set(column, text, more) {
    const [first, second] = this.cells[column];
    if (first.textContent !== text) first.textContent = text;
    if (second.textContent !== more) second.textContent = second.title = more;
  }
}

export class RobotsPanel {
  #rows = new Map();

  constructor(onSelect) {
    this.onSelect = onSelect;
    this.body = make('tbody');
    this.missions = make('div', { class: 'missions' });
    this.none = make('p', { class: 'none' }, 'No robot has uploaded to this map yet.');
    this.table = make('table', { class: 'robots' },
      make('thead', {}, make('tr', {}, ...COLUMNS.map(([name, title]) => make('th', { scope: 'col', title }, name)))), this.body);
    byId('robots').append(this.none, this.table, this.missions);
  }

  update(model, world, selected) {
    const robots = model.state.robots;
    this.none.hidden = robots.length > 0;
    this.table.hidden = robots.length === 0;
    const known = new Set(robots.map((robot) => robot.robot));
    for (const [name, row] of this.#rows) {
      if (known.has(name)) continue;
      row.element.remove();
      this.#rows.delete(name);
    }
    const byRobot = model.missionsByRobot();
    robots.forEach((robot, i) => {
      if (!this.#rows.has(robot.robot)) this.#rows.set(robot.robot, new Row(robot.robot, this.onSelect));
      const row = this.#rows.get(robot.robot);
      if (this.body.children[i] !== row.element) this.body.insertBefore(row.element, this.body.children[i] ?? null);
      row.update(robot, byRobot.get(robot.robot) ?? [], world.cssColour(robot.robot), robot.robot === selected);
    });
    this.#showMissions(byRobot.get(selected) ?? []);
  }

  #showMissions(missions) {
    this.missions.hidden = missions.length === 0;
    if (missions.length === 0) return;
    this.missions.replaceChildren(
      make('h3', {}, `Missions of ${missions[0].robot}`),
      make('ul', {}, ...missions.map((mission) => make('li', { class: mission.anchored ? '' : 'apart' },
        make('b', {}, mission.mission),
        ` ${format.count(mission.keyframes)} nodes, ${format.metres(mission.path_m)} in ${format.seconds(mission.duration_s)} · `,
        mission.anchored ? 'in the map' : `not in the map (component ${mission.component})`,
        mission.problem ? make('em', {}, ` ${mission.problem}`) : null))));
  }
}
