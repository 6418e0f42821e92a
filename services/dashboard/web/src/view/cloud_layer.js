// SPDX-License-Identifier: Apache-2.0
// The merged cloud, coloured by height.
import { BufferAttribute, BufferGeometry, Points, PointsMaterial, Sphere } from 'three';
import { mix, parseColour } from '../palette.js';

const RAMPS = { light: ['#b9c2ca', '#5b6b7a'], dark: ['#2f3b45', '#8fa3b5'] };

// The heights between which nineteen of twenty points lie, so that a mast does not take all the shades.
function heightRange(points) {
  const sample = [];
  const stride = 3 * Math.max(1, Math.floor(points.length / 3 / 5000));
  for (let i = 2; i < points.length; i += stride) sample.push(points[i]);
  sample.sort((a, b) => a - b);
  return [sample[Math.floor(0.025 * sample.length)], sample[Math.floor(0.975 * (sample.length - 1))]];
}

export class CloudLayer {
  #theme = 'dark';
  #points = new Float32Array(0);

  constructor(parent) {
    this.points = new Points(new BufferGeometry(), new PointsMaterial({ size: 1.5, sizeAttenuation: false, vertexColors: true, depthWrite: false }));
    this.points.frustumCulled = false;
    this.points.renderOrder = 0;
    this.points.visible = false;
    parent.add(this.points);
  }

  get count() {
    return this.#points.length / 3;
  }

  setTheme(theme) {
    this.#theme = theme;
    this.set(this.#points);
  }

  setVisible(visible) {
    this.points.visible = visible && this.count > 0;
  }

  /** x y z rows, metres, less the origin. */
  set(points) {
    this.#points = points;
    this.points.geometry.dispose();
    const geometry = new BufferGeometry();
    const colours = new Uint8Array(points.length);
    const [low, high] = heightRange(points);
    const [from, to] = RAMPS[this.#theme].map(parseColour);
    for (let i = 0; i < points.length; i += 3) {
      const share = Math.min(1, Math.max(0, (points[i + 2] - low) / (high - low || 1)));
      colours.set(mix(from, to, share).map((value) => 255 * value), i);
    }
    geometry.setAttribute('position', new BufferAttribute(points, 3));
    geometry.setAttribute('color', new BufferAttribute(colours, 3, true));
    geometry.boundingSphere = new Sphere(undefined, Infinity);
    this.points.geometry = geometry;
  }
}
