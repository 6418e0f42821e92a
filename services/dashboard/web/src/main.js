// SPDX-License-Identifier: Apache-2.0
// Puts the page together: what the service says goes to the model, from there to the picture and the tables.
import { showEmpty, showFacts, showLink } from './banner.js';
import { Clouds } from './clouds.js';
import { byId } from './dom.js';
import { Feed, getBytes, getJson, postVeto } from './feed.js';
import { decodeFrame } from './frame.js';
import * as format from './format.js';
import { addKeys } from './keys.js';
import { Model } from './model.js';
import { ClosuresPanel } from './panel/closures.js';
import { Legend } from './panel/legend.js';
import { RevisionsPanel } from './panel/revisions.js';
import { RobotsPanel } from './panel/robots.js';
import { Tabs } from './panel/tabs.js';
import { TimeSlider } from './panel/time_slider.js';
import { addThemeButton } from './theme.js';
import { Labels } from './view/labels.js';
import { Stage } from './view/stage.js';
import { World } from './view/world.js';

class Page {
  #config = null;
  #size = 0; // of what is looked at, metres
  #past = 0; // counts requests, so that a late answer is not shown

  constructor() {
    this.model = new Model();
    this.stage = new Stage(byId('view'));
    this.world = new World(this.stage, this.model);
    this.labels = new Labels(byId('labels'), this.stage);
    this.tabs = new Tabs();
    this.clouds = new Clouds(this.world, this.model, (text) => this.legend.setNote(text));
    this.legend = new Legend({ onToggle: (key, shown) => this.toggle(key, shown), onBand: (band) => this.showBand(band) });
    this.robots = new RobotsPanel((robot) => this.selectRobot(robot));
    this.closures = new ClosuresPanel({ onSelect: (id) => this.selectClosure(id), onShow: (id) => this.lookAtClosure(id), onVeto: postVeto });
    this.revisions = new RevisionsPanel((epoch, revision) => this.time.show(epoch, revision));
    this.time = new TimeSlider((seen) => this.showPast(seen));
    addThemeButton((theme) => this.setTheme(theme));
    addKeys(this);
    this.#addPointer();
    this.stage.onDraw(() => this.#showScale());
    this.legend.applyAll();
    this.#keepClearOfLegend();
    this.#listen();
  }

  #listen() {
    this.feed = new Feed();
    const on = (name, call) => this.feed.addEventListener(name, (event) => call(event.detail));
    on('state', (state) => this.#takeState(state));
    on('positions', (frame) => this.#takePositions(frame));
    on('odometry', (frame) => this.world.update(this.model.setTracks('odometry', frame)));
    on('discrepancy', (frame) => this.#takeDiscrepancy(frame));
    on('closures', (list) => this.#takeClosures(list));
    on('revisions', (list) => this.#takeRevisions(list));
    on('restart', () => this.#restart());
    on('down', (error) => {
      showLink(this.model.state, error, this.#config);
    });
    this.feed.start();
  }

  async #takeConfig() {
    if (this.#config) return;
    this.#config = await getJson('./api/config');
    byId('map-name').textContent = this.#config.map;
    document.title = `${this.#config.map} – Overtone`;
    this.closures.readOnly = this.#config.read_only;
    showLink(this.model.state, null, this.#config);
    showEmpty(this.model.state, this.#config);
  }

  #takeState(state) {
    const poses = JSON.stringify(this.model.missions.map(({ number, anchored, component, map_tform_mission: pose, comparison }) => [number, anchored, component, pose, comparison?.time_ms]));
    this.model.setState(state);
    this.#takeConfig().catch(() => { /* asked for again with the next state */ });
    showLink(state, null, this.#config);
    if (this.#config) showEmpty(state, this.#config);
    showFacts(state);
    this.robots.update(this.model, this.world, this.world.selectedRobot);
    this.tabs.setCount('robots', format.count(state.robots.length));
    this.clouds.follow();
    const now = JSON.stringify(this.model.missions.map(({ number, anchored, component, map_tform_mission: pose, comparison }) => [number, anchored, component, pose, comparison?.time_ms]));
    if (poses !== now) this.#redrawAll();
  }

  #takePositions(frame) {
    const changed = this.model.setTracks('positions', frame);
    if (this.model.past) return;
    if (this.world.place()) this.#redrawAll();
    else this.#redraw(changed);
    if (changed.length > 0) this.#followGrowth();
  }

  // Keeps all of a growing map in view until somebody looks elsewhere.
  #followGrowth() {
    const box = this.world.box();
    const size = box.isEmpty ? 0 : Math.hypot(...[0, 1, 2].map((axis) => box.size(axis)));
    if (this.stage.touched || size < 1.1 * this.#size) return;
    const isFirst = this.#size === 0;
    this.#size = size;
    this.lookAtAll({ animate: !isFirst });
  }

  #takeDiscrepancy(frame) {
    const changed = this.model.setTracks('discrepancy', frame);
    if (this.world.rescaleHeat()) this.world.update(this.model.missions.map(({ number }) => number));
    else this.world.update(changed);
    this.#showHeatScale();
  }

  #takeClosures(list) {
    this.model.closures = list.closures;
    this.world.updateClosures();
    this.closures.setClosures(list.closures, list.total);
    this.tabs.setCount('closures', format.count(list.total));
    for (const [group, number] of Object.entries(this.closures.counts())) this.legend.setCount(group, format.count(number));
  }

  #takeRevisions(list) {
    this.model.revisions = list.revisions;
    this.model.seen = list.seen;
    this.time.setSeen(list.seen);
    this.tabs.setCount('revisions', list.revisions.length > 0 ? format.count(list.revisions[0].revision) : '');
    this.#showRevisions();
  }

  #showRevisions() {
    const { past } = this.model;
    this.revisions.update(this.model.revisions, this.model.seen, past && `${past.epoch}/${past.revision}`);
  }

  #restart() {
    this.model.clear();
    this.time.live();
    this.#config = null;
  }

  #redraw(numbers) {
    this.world.update(numbers);
    this.world.updateClosures();
    this.world.updateRobots();
    this.#label();
  }

  #redrawAll() {
    this.world.redraw();
    this.#label();
  }

  #label() {
    const robots = this.world.lastPositions().map(({ robot, point }) => ({ text: robot, point, kind: 'robot' }));
    const selected = (label) => (label.text === this.world.selectedRobot ? 0 : 1);
    robots.sort((a, b) => selected(a) - selected(b));
    const apart = this.world.layout.frames.map(({ component, min, max }) => ({ text: `not in the map · component ${component}`, point: [min[0], max[1], max[2]], kind: 'apart' }));
    this.labels.set([...apart, ...robots]);
  }

  toggle(key, shown) {
    this.world.setVisible(key, shown);
    if (key === 'cloud') this.clouds.setShown(shown);
    if (key === 'heat') this.#showHeatScale();
  }

  showBand(band) {
    this.world.band = band;
    this.world.rescaleHeat();
    this.world.update(this.model.missions.map(({ number }) => number));
    this.#showHeatScale();
  }

  #showHeatScale() {
    this.legend.setHeat(this.world.theme, this.world.heatMax, this.model.tracks.discrepancy.size > 0);
  }

  setTheme(theme) {
    this.world.setTheme(theme);
    this.#showHeatScale();
    if (this.model.state) this.robots.update(this.model, this.world, this.world.selectedRobot);
  }

  selectRobot(robot) {
    this.world.selectedRobot = this.world.selectedRobot === robot ? null : robot;
    this.#redrawAll();
    if (this.model.state) this.robots.update(this.model, this.world, this.world.selectedRobot);
  }

  selectClosure(id) {
    this.world.showClosure(id);
    this.closures.select(id);
    if (id) this.tabs.show('closures');
  }

  selectNothing() {
    this.selectClosure(null);
    if (this.world.selectedRobot !== null) this.selectRobot(this.world.selectedRobot);
  }

  lookAtAll(options) {
    if (this.world.selectedRobot !== null) this.stage.touched = true;
    this.stage.fit(this.world.box(this.world.selectedRobot), options);
  }

  lookAtClosure(id) {
    this.stage.touched = true;
    this.stage.fit(this.world.boxOfClosure(id));
  }

  async showPast(seen) {
    const asked = ++this.#past;
    let past = null;
    if (seen) {
      try {
        const frame = decodeFrame(await getBytes(`./api/revisions/${seen.epoch}/${seen.revision}`));
        past = { ...seen, tracks: new Map(frame.tracks.map((track) => [track.mission, track])) };
      } catch {
        return this.time.live(); // it went while we asked
      }
    }
    if (asked !== this.#past) return;
    this.model.past = past;
    this.#redrawAll();
    this.#showRevisions();
  }

  #addPointer() {
    const canvas = this.stage.renderer.domElement;
    let down = null;
    canvas.addEventListener('pointerdown', (event) => { down = [event.clientX, event.clientY]; });
    canvas.addEventListener('pointerup', (event) => {
      if (!down || Math.hypot(event.clientX - down[0], event.clientY - down[1]) > 4) return;
      const box = canvas.getBoundingClientRect();
      const id = this.world.pick(event.clientX - box.left, event.clientY - box.top, (key) => this.legend.isShown(key));
      this.selectClosure(id);
    });
  }

  #keepClearOfLegend() {
    const details = byId('legend').querySelector('details');
    const apply = () => {
      const view = byId('view').clientWidth;
      const width = details.open ? byId('legend').offsetWidth : 0;
      this.stage.setInset(width < view / 2 ? width : 0);
    };
    details.addEventListener('toggle', apply);
    addEventListener('resize', apply);
    apply();
  }

  #showScale() {
    const step = this.world.ground.step;
    byId('scale').querySelector('span').textContent = format.metres(step);
    byId('scale').querySelector('i').style.width = `${(step / this.stage.metresPerPixel()).toFixed(0)}px`;
  }
}

// Tests and the curious look at it.
window.overtone = new Page();
