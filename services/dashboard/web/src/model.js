// SPDX-License-Identifier: Apache-2.0
// What the page knows, as the service last said it: the state, the tracks of every mission, closures and revisions.
import { Box, floorIndex } from './geometry.js';

const NONE = { index: new Int32Array(0), values: new Float32Array(0) };

export class Model {
  state = null;
  origin = [0, 0, 0];
  closures = [];
  closuresTotal = 0;
  revisions = [];
  seen = [];
  tracks = { positions: new Map(), odometry: new Map(), discrepancy: new Map() };
  past = null; // of an earlier revision that is shown in place of the newest: {epoch, revision, tracks}
  #boxes = new WeakMap();

  setState(state) {
    this.state = state;
    const known = new Set(state.missions.map((mission) => mission.number));
    for (const tracks of Object.values(this.tracks)) {
      for (const number of [...tracks.keys()]) if (!known.has(number)) tracks.delete(number);
    }
  }

  /** @returns {number[]} the missions that changed */
  setTracks(kind, frame) {
    if (kind === 'positions') this.origin = frame.origin;
    for (const track of frame.tracks) this.tracks[kind].set(track.mission, track);
    return frame.tracks.map((track) => track.mission);
  }

  clear() {
    for (const tracks of Object.values(this.tracks)) tracks.clear();
    this.past = null;
  }

  get missions() {
    return this.state?.missions ?? [];
  }

  missionsByRobot() {
    const robots = new Map();
    for (const mission of this.missions) {
      if (!robots.has(mission.robot)) robots.set(mission.robot, []);
      robots.get(mission.robot).push(mission);
    }
    return robots;
  }

  /** Positions as they are shown: of the past where one is looked at. */
  positions(number) {
    return (this.past ? this.past.tracks.get(number) : this.tracks.positions.get(number)) ?? NONE;
  }

  odometry(number) {
    return this.past ? NONE : this.tracks.odometry.get(number) ?? NONE;
  }

  discrepancy(number) {
    return this.past ? NONE : this.tracks.discrepancy.get(number) ?? NONE;
  }

  box(number) {
    const track = this.positions(number);
    if (!this.#boxes.has(track)) this.#boxes.set(track, new Box().addRows(track.values));
    return this.#boxes.get(track);
  }

  /** Where a keyframe is, or null; the last one before it where it was left out. */
  pointOf(number, index) {
    const track = this.positions(number);
    if (track.index.length === 0 || index > track.index[track.index.length - 1] || index < track.index[0]) return null;
    const row = 3 * floorIndex(track.index, index);
    return track.values.subarray(row, row + 3);
  }
}
