// SPDX-License-Identifier: Apache-2.0
// Everything that is drawn, from the model: one layer, and one draw call, for each kind of thing.
import { Group, Vector3 } from 'three';
import { Box, distanceToSegment, floorIndex, transformRows } from '../geometry.js';
import { placeComponents } from '../layout.js';
import { CONSTRAINT, GROUND, UNANCHORED, VERDICT_GROUPS, heatScale, mix, parseColour, robotColour, verdictColour, verdictGroup } from '../palette.js';
import { CloudLayer } from './cloud_layer.js';
import { GroundLayer } from './ground_layer.js';
import { MarkerLayer } from './marker_layer.js';
import { SegmentLayer } from './segment_layer.js';

const DIMMED = 0.78; // share of the ground in what is not selected
const PICK_PX = 9;
const MAX_USED_MARKERS = 200;

export class World {
  theme = 'dark';
  band = 'sum';
  heatMax = 1;
  selectedRobot = null;
  selectedClosure = null;
  layout = { offsets: new Map(), frames: [], map: new Box() };
  #shownClosures = [];

  constructor(stage, model) {
    this.stage = stage;
    this.model = model;
    const root = new Group();
    stage.scene.add(root);
    this.ground = new GroundLayer(root, stage);
    this.cloud = new CloudLayer(root);
    this.odometry = new SegmentLayer(root, { width: 1.2, opacity: 0.75, order: 1 });
    this.heat = new SegmentLayer(root, { width: 7, opacity: 0.95, order: 2 });
    this.paths = new SegmentLayer(root, { width: 2.4, order: 3 });
    this.apart = new SegmentLayer(root, { width: 2, dash: [5, 4], order: 3 });
    this.constraints = new SegmentLayer(root, { width: 1.6, dash: [3, 3], opacity: 0.9, order: 4 });
    this.closures = new Map(VERDICT_GROUPS.map((group) => [group.key, {
      lines: new SegmentLayer(root, { width: group.key === 'used' ? 1.4 : 1.8, dash: group.dash, opacity: group.key === 'used' ? 0.6 : 0.9, order: 5 }),
      markers: new MarkerLayer(root, group.shape, group.key === 'used' ? 5 : 12, 7),
    }]));
    this.chosen = new SegmentLayer(root, { width: 5, order: 6 });
    this.robots = new MarkerLayer(root, 'robot', 17, 8);
    this.dashed = [this.apart, this.constraints, ...[...this.closures.values()].map((layer) => layer.lines)];
    stage.onDraw(() => this.#scaleDashes());
    stage.onDetail((detail) => [this.paths, this.apart, this.odometry, this.heat].forEach((layer) => layer.setDetail(detail)));
  }

  // Dashes are pixels long, whatever the zoom; a step of two keeps them from crawling.
  #scaleDashes() {
    const scale = 2 ** Math.round(Math.log2(1 / this.stage.metresPerPixel()));
    for (const layer of this.dashed) layer.setDashScale(scale);
    this.ground.update();
  }

  get layers() {
    return { paths: this.paths, apart: this.apart, odometry: this.odometry, heat: this.heat, constraints: this.constraints };
  }

  setTheme(theme) {
    this.theme = theme;
    this.heatOf = heatScale(theme);
    this.stage.setGround(GROUND[theme]);
    this.ground.setTheme(theme);
    this.cloud.setTheme(theme);
    for (const { markers } of this.closures.values()) markers.setOutline(GROUND[theme]);
    this.robots.setOutline(theme === 'dark' ? '#ffffff' : '#1d2125');
    this.redraw();
  }

  setVisible(layer, visible) {
    if (this.closures.has(layer)) {
      const { lines, markers } = this.closures.get(layer);
      lines.setVisible(visible);
      markers.setVisible(visible);
    } else if (layer === 'cloud') this.cloud.setVisible(visible);
    else this.layers[layer].setVisible(visible);
    this.stage.invalidate();
  }

  robotOrdinal(robot) {
    return this.model.state?.robots.findIndex((row) => row.robot === robot) ?? 0;
  }

  colourOf(robot) {
    return parseColour(robotColour(this.theme, Math.max(0, this.robotOrdinal(robot))));
  }

  cssColour(robot) {
    return robotColour(this.theme, Math.max(0, this.robotOrdinal(robot)));
  }

  #dim(colour, robot) {
    const selected = this.selectedRobot === null || this.selectedRobot === robot;
    return selected ? colour : mix(colour, parseColour(GROUND[this.theme]), DIMMED);
  }

  offsetOf(mission) {
    return mission.anchored ? [0, 0, 0] : this.layout.offsets.get(mission.component) ?? [0, 0, 0];
  }

  #shifted(mission, rows) {
    const offset = this.offsetOf(mission);
    if (mission.anchored) return rows;
    return transformRows({ p: offset, q: [0, 0, 0, 1] }, rows);
  }

  /** A keyframe in the picture, or null. */
  pointOf(mission, index) {
    const point = mission && this.model.pointOf(mission.number, index);
    return point ? this.#shifted(mission, point) : null;
  }

  redraw() {
    this.place();
    this.update(this.model.missions.map((mission) => mission.number));
    this.updateClosures();
    this.updateRobots();
  }

  /** Where components stand. @returns true when one of them moved: then all must be drawn anew */
  place() {
    const before = JSON.stringify(this.layout.frames);
    this.layout = placeComponents(this.model.missions.map((mission) => ({
      component: mission.component, anchored: mission.anchored, box: this.model.box(mission.number),
    })));
    this.ground.setFrames(this.layout.frames);
    if (!this.layout.map.isEmpty) this.ground.setHeight(this.layout.map.min[2]);
    return before !== JSON.stringify(this.layout.frames);
  }

  /** Draws some missions anew: their paths, odometry, heat and constraints. */
  update(numbers) {
    const changed = new Set(numbers);
    for (const mission of this.model.missions) {
      if (changed.has(mission.number)) this.#updateMission(mission);
    }
    const known = new Set(this.model.missions.map((mission) => mission.number));
    for (const layer of Object.values(this.layers)) layer.keepOnly(known);
    this.stage.invalidate();
  }

  #updateMission(mission) {
    const { number } = mission;
    const rows = this.#shifted(mission, this.model.positions(number).values);
    const colour = this.#dim(mission.anchored ? this.colourOf(mission.robot) : parseColour(UNANCHORED[this.theme]), mission.robot);
    const [there, gone] = mission.anchored ? [this.paths, this.apart] : [this.apart, this.paths];
    gone.remove(number);
    if (rows.length > 3) there.setLine(number, rows, colour);
    else there.remove(number);
    this.#updateOdometry(mission);
    this.#updateHeat(mission, rows);
    this.#updateConstraints(mission);
  }

  #updateOdometry(mission) {
    const track = this.model.odometry(mission.number);
    if (track.values.length <= 3) return this.odometry.remove(mission.number);
    const pose = mission.map_tform_mission;
    const offset = this.offsetOf(mission);
    const p = pose.p.map((value, k) => value - this.model.origin[k] + offset[k]);
    const ground = parseColour(GROUND[this.theme]);
    const colour = this.#dim(mix(this.colourOf(mission.robot), ground, 0.45), mission.robot);
    this.odometry.setLine(mission.number, transformRows({ p, q: pose.q }, track.values), colour);
  }

  // Each stretch of the path has the discrepancy of the compared node before it.
  #updateHeat(mission, rows) {
    const { index, values } = this.model.discrepancy(mission.number);
    const positions = this.model.positions(mission.number);
    if (index.length === 0 || rows.length <= 3) return this.heat.remove(mission.number);
    const colours = new Float32Array(rows.length);
    for (let i = 0; i < positions.index.length; ++i) {
      const value = this.#bandValue(values, floorIndex(index, positions.index[i]));
      colours.set(this.#dim(this.heatOf(value / this.heatMax), mission.robot), 3 * i);
    }
    this.heat.setLine(mission.number, rows, colours);
  }

  #bandValue(values, row) {
    const [small, mid, large] = values.subarray(3 * row, 3 * row + 3);
    return { small, mid, large, sum: small + mid + large }[this.band];
  }

  /** The scale's end: the largest value there is, so that colours mean the same on all missions. */
  rescaleHeat() {
    let largest = 0;
    for (const { values } of this.model.tracks.discrepancy.values()) {
      for (let row = 0; row < values.length / 3; ++row) largest = Math.max(largest, this.#bandValue(values, row));
    }
    const before = this.heatMax;
    this.heatMax = largest > 0 ? largest : 1;
    return before !== this.heatMax;
  }

  #updateConstraints(mission) {
    const ends = [];
    for (const { from, to } of this.model.past ? [] : mission.comparison?.largest ?? []) {
      const [a, b] = [this.pointOf(mission, from), this.pointOf(mission, to)];
      if (a && b) ends.push(...a, ...b);
    }
    if (ends.length === 0) return this.constraints.remove(mission.number);
    const colour = this.#dim(parseColour(CONSTRAINT[this.theme]), mission.robot);
    this.constraints.setSegments(mission.number, new Float32Array(ends), Array(ends.length / 6).fill(colour).flat());
  }

  updateClosures() {
    const missions = new Map(this.model.missions.map((mission) => [`${mission.robot}/${mission.mission}`, mission]));
    const groups = new Map(VERDICT_GROUPS.map(({ key }) => [key, { ends: [], colours: [], middles: [] }]));
    this.#shownClosures = [];
    for (const closure of this.model.closures) {
      const [a, b] = [closure.from, closure.to].map((end) => this.pointOf(missions.get(`${end.robot}/${end.mission}`), end.index));
      if (!a || !b) continue;
      const key = verdictGroup(closure.verdict);
      const group = groups.get(key);
      const dimmed = this.selectedRobot !== null && closure.from.robot !== this.selectedRobot && closure.to.robot !== this.selectedRobot;
      const colour = parseColour(verdictColour(this.theme, key));
      group.ends.push(...a, ...b);
      group.colours.push(...(dimmed ? mix(colour, parseColour(GROUND[this.theme]), DIMMED) : colour));
      group.middles.push((a[0] + b[0]) / 2, (a[1] + b[1]) / 2, (a[2] + b[2]) / 2);
      this.#shownClosures.push({ id: closure.id, key, ends: [...a, ...b] });
    }
    for (const [key, { ends, colours, middles }] of groups) {
      const layer = this.closures.get(key);
      if (ends.length === 0) layer.lines.remove('all');
      else layer.lines.setSegments('all', new Float32Array(ends), colours);
      const crowded = key === 'used' && middles.length > 3 * MAX_USED_MARKERS;
      layer.markers.set(crowded ? [] : middles, crowded ? [] : colours);
    }
    this.showClosure(this.selectedClosure);
  }

  showClosure(id) {
    this.selectedClosure = id;
    const shown = this.#shownClosures.find((closure) => closure.id === id);
    if (!shown) this.chosen.remove('one');
    else this.chosen.setSegments('one', new Float32Array(shown.ends), parseColour(this.theme === 'dark' ? '#ffffff' : '#000000'));
    this.stage.invalidate();
  }

  boxOfClosure(id) {
    const shown = this.#shownClosures.find((closure) => closure.id === id);
    return shown ? new Box().addRows(shown.ends) : new Box();
  }

  /** The closure below a point of the view, or null. */
  pick(x, y, isShown) {
    const [a, b] = [new Vector3(), new Vector3()];
    let best = { id: null, distance: PICK_PX };
    for (const { id, key, ends } of this.#shownClosures) {
      if (!isShown(key)) continue;
      const [from, to] = [this.stage.project(ends[0], ends[1], ends[2], a), this.stage.project(ends[3], ends[4], ends[5], b)];
      if (!from || !to) continue;
      const distance = distanceToSegment(x, y, from.x, from.y, to.x, to.y);
      if (distance < best.distance) best = { id, distance };
    }
    return best.id;
  }

  /** The last position of each robot's newest mission. */
  lastPositions() {
    const newest = new Map();
    for (const mission of this.model.missions) {
      const track = this.model.positions(mission.number);
      if (track.index.length > 0) newest.set(mission.robot, mission); // the server sorts by mission
    }
    return [...newest].map(([robot, mission]) => {
      const rows = this.model.positions(mission.number).values;
      return { robot, mission, point: this.#shifted(mission, rows.subarray(rows.length - 3)) };
    });
  }

  updateRobots() {
    const last = this.lastPositions();
    this.robots.set(last.flatMap(({ point }) => [...point]),
      last.flatMap(({ robot, mission }) => this.#dim(mission.anchored ? this.colourOf(robot) : parseColour(UNANCHORED[this.theme]), robot)));
    this.stage.invalidate();
  }

  /** All that is drawn, or one robot. */
  box(robot = null) {
    const box = new Box();
    for (const mission of this.model.missions) {
      if (robot !== null && mission.robot !== robot) continue;
      const own = this.model.box(mission.number);
      const offset = this.offsetOf(mission);
      if (!own.isEmpty) box.addRows([...own.min.map((v, k) => v + offset[k]), ...own.max.map((v, k) => v + offset[k])]);
    }
    return box;
  }
}
