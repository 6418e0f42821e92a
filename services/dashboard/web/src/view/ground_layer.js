// SPDX-License-Identifier: Apache-2.0
// A grid whose squares are 1, 2 or 5 times a power of ten metres, and the places of what is not in the map.
import { BufferAttribute, BufferGeometry, Color, LineBasicMaterial, LineDashedMaterial, LineSegments, Sphere } from 'three';

const SQUARES = 40;
const PIECE = 4; // squares
const SQUARE_PX = 90;
const COLOURS = { light: ['#e1e6ea', '#9aa5af'], dark: ['#1f272e', '#5b6873'] };

export function roundStep(value) {
  const power = 10 ** Math.floor(Math.log10(value));
  return power * [1, 2, 5, 10].find((factor) => factor * power >= value);
}

function makeLines(parent, material) {
  const lines = new LineSegments(new BufferGeometry(), material);
  lines.frustumCulled = false;
  parent.add(lines);
  return lines;
}

function setLines(lines, positions) {
  lines.geometry.dispose();
  lines.geometry = new BufferGeometry();
  lines.geometry.setAttribute('position', new BufferAttribute(new Float32Array(positions), 3));
  lines.geometry.boundingSphere = new Sphere(undefined, Infinity);
}

export class GroundLayer {
  #key = '';
  #height = 0;

  constructor(parent, stage) {
    this.stage = stage;
    this.grid = makeLines(parent, new LineBasicMaterial({ depthWrite: false, transparent: true }));
    this.grid.renderOrder = -2;
    this.frames = makeLines(parent, new LineDashedMaterial({ depthWrite: false, dashSize: 1.2, gapSize: 0.8 }));
    this.frames.renderOrder = -1;
  }

  setTheme(theme) {
    this.grid.material.color = new Color(COLOURS[theme][0]);
    this.frames.material.color = new Color(COLOURS[theme][1]);
  }

  setHeight(height) {
    this.#height = height;
  }

  /** Metres of a square. */
  get step() {
    return roundStep(this.stage.metresPerPixel() * SQUARE_PX);
  }

  /** Around what is looked at, wherever that is. */
  update() {
    const step = this.step;
    const [x, y] = [this.stage.controls.target.x, this.stage.controls.target.y].map((v) => Math.round(v / step) * step);
    const key = `${step} ${x} ${y} ${this.#height}`;
    if (key === this.#key) return;
    this.#key = key;
    const reach = SQUARES * step;
    const positions = [];
    for (let i = -SQUARES; i <= SQUARES; ++i) {
      const at = i * step;
      // In pieces: lines that begin far behind the camera are not drawn everywhere.
      for (let from = -reach; from < reach; from += PIECE * step) {
        const to = from + PIECE * step;
        positions.push(x + at, y + from, this.#height, x + at, y + to, this.#height);
        positions.push(x + from, y + at, this.#height, x + to, y + at, this.#height);
      }
    }
    setLines(this.grid, positions);
  }

  setFrames(frames) {
    const positions = [];
    for (const { min: [x0, y0, z], max: [x1, y1] } of frames) {
      const corners = [[x0, y0], [x1, y0], [x1, y1], [x0, y1]];
      corners.forEach((corner, i) => positions.push(...corner, z, ...corners[(i + 1) % 4], z));
    }
    setLines(this.frames, positions);
    this.frames.computeLineDistances();
    this.frames.visible = positions.length > 0;
  }
}
