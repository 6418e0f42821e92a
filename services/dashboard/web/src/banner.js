// SPDX-License-Identifier: Apache-2.0
// What is wrong with the link, and what to do where there is nothing to see yet.
import { byId, make } from './dom.js';
import * as format from './format.js';

export function showLink(state, error, config) {
  const chip = byId('link');
  const banner = byId('banner');
  const ok = !error && state?.link.ok;
  chip.className = `chip ${ok ? 'good' : 'bad'}`;
  chip.textContent = ok ? '● live' : '○ not connected';
  chip.title = ok ? `mapping server ${state.link.server_version} at ${config?.server ?? ''}` : '';
  banner.hidden = ok;
  if (!ok) banner.replaceChildren(...problem(state, error, config));
}

function problem(state, error, config) {
  if (error) {
    return [make('b', {}, 'The dashboard service does not answer. '), 'What is shown is what it last said; the page asks again every few seconds.'];
  }
  const { link } = state;
  const old = link.refreshed_ms ? ` What is shown is from ${format.clock(link.refreshed_ms)}.` : '';
  if (link.code === 'PERMISSION_DENIED' || link.code === 'UNAUTHENTICATED') {
    return [make('b', {}, `The mapping server ${config?.server ?? ''} does not let the dashboard in. `),
      `${link.error}. Start it with an operator's certificate (--tls-cert, --tls-key) that the server's access file grants this map.${old}`];
  }
  return [make('b', {}, `The mapping server ${config?.server ?? ''} does not answer. `), `${link.error}. The dashboard goes on asking.${old}`];
}

export function showEmpty(state, config) {
  const empty = byId('empty');
  const isEmpty = Boolean(state?.link.ok && state.missions.length === 0);
  if (empty.hidden !== isEmpty) return;
  empty.hidden = !isEmpty;
  if (!isEmpty) return;
  const others = state.maps.filter((map) => map !== config.map);
  empty.replaceChildren(
    make('h2', {}, `Nothing in map “${config.map}” yet`),
    make('p', {}, 'A map comes into being with the first submap that a robot uploads. Point a robot’s client at the server, or play a recording:'),
    make('pre', {}, `overtone simulate --scenario subterranean --out team\novertone replay --dataset pcd team --out run \\\n    --server ${config.server} --map ${config.map}`),
    others.length > 0 ? make('p', {}, `This server also has: ${others.join(', ')}. Start the dashboard with --map to see one of them.`) : make('p', {}, 'This page shows it as soon as it is there.'));
}

function fact(name, value, title) {
  return make('div', title ? { title } : {}, make('dt', {}, name), make('dd', {}, value));
}

export function showFacts(state) {
  const { summary, missions, robots } = state;
  const anchored = missions.filter((mission) => mission.anchored).length;
  byId('facts').replaceChildren(
    fact('revision', summary.revision ? `${summary.revision}` : '–', summary.published_ms ? `of ${format.clock(summary.published_ms)}` : ''),
    fact('age', format.ago(summary.published_ms)),
    fact('robots', format.count(robots.length)),
    fact('missions in the map', `${anchored} of ${missions.length}`),
    fact('nodes', format.count(summary.keyframes)),
    fact('optimisation', format.seconds(summary.optimisation_s), 'seconds that the last one took'),
    fact('backlog', format.count(summary.backlog), 'clouds and candidates that the server has not worked off yet'));
}
