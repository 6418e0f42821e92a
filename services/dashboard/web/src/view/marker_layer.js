// SPDX-License-Identifier: Apache-2.0
// Many small signs of one shape and of constant size on the screen, in one draw call.
import { BufferAttribute, BufferGeometry, CanvasTexture, DynamicDrawUsage, Points, PointsMaterial, Sphere } from 'three';

const SIZE = 64;
const DRAW = {
  circle: (c) => c.arc(32, 32, 20, 0, 2 * Math.PI),
  triangle: (c) => { c.moveTo(32, 8); c.lineTo(58, 54); c.lineTo(6, 54); c.closePath(); },
  square: (c) => c.rect(12, 12, 40, 40),
  cross: (c) => {
    for (const [x, y] of [[14, 8], [32, 26], [50, 8], [56, 14], [38, 32], [56, 50], [50, 56], [32, 38], [14, 56], [8, 50], [26, 32], [8, 14]]) c.lineTo(x, y);
    c.closePath();
  },
  robot: (c) => { c.arc(32, 32, 18, 0, 2 * Math.PI); },
};

function texture(shape, outline) {
  const canvas = document.createElement('canvas');
  canvas.width = canvas.height = SIZE;
  const context = canvas.getContext('2d');
  context.beginPath();
  DRAW[shape](context);
  context.lineWidth = shape === 'robot' ? 10 : 8;
  context.strokeStyle = outline;
  context.lineJoin = 'round';
  context.stroke();
  context.fillStyle = '#fff';
  context.fill();
  return new CanvasTexture(canvas);
}

export class MarkerLayer {
  #shape;

  constructor(parent, shape, size, order) {
    this.#shape = shape;
    this.points = new Points(new BufferGeometry(), new PointsMaterial({
      size, sizeAttenuation: false, vertexColors: true, transparent: true, alphaTest: 0.3, depthTest: false,
    }));
    this.points.frustumCulled = false;
    this.points.renderOrder = order;
    this.points.visible = false;
    parent.add(this.points);
  }

  /** The outline parts the sign from what lies below it, so it has the ground's colour. */
  setOutline(colour) {
    this.points.material.map?.dispose();
    this.points.material.map = texture(this.#shape, colour);
    this.points.material.needsUpdate = true;
  }

  set(positions, colours) {
    const geometry = this.points.geometry;
    const old = geometry.getAttribute('position');
    if (old && old.array.length >= positions.length) {
      old.array.set(positions);
      geometry.getAttribute('color').array.set(colours);
      old.needsUpdate = geometry.getAttribute('color').needsUpdate = true;
    } else {
      geometry.dispose();
      for (const [name, values] of [['position', positions], ['color', colours]]) {
        geometry.setAttribute(name, new BufferAttribute(new Float32Array(values), 3).setUsage(DynamicDrawUsage));
      }
      geometry.boundingSphere = new Sphere(undefined, Infinity);
    }
    geometry.setDrawRange(0, positions.length / 3);
    this.count = positions.length / 3;
    this.points.visible = this.count > 0 && this.shown !== false;
  }

  setVisible(visible) {
    this.shown = visible;
    this.points.visible = visible && this.count > 0;
  }
}
