// SPDX-License-Identifier: Apache-2.0
// The wide form of a layer's segments: each of them four times over, as ribbon_material.js needs it.
import { BufferGeometry, DoubleSide, InterleavedBuffer, InterleavedBufferAttribute, BufferAttribute, Mesh, Sphere } from 'three';
import { makeRibbonMaterial } from './ribbon_material.js';

const FLOATS = 11; // start, end, shade, along
const PARTS = [['start', 3, 0], ['end', 3, 3], ['shade', 3, 6], ['along', 2, 9]];

function quads(capacity) {
  const index = new Uint32Array(6 * capacity);
  for (let i = 0; i < capacity; ++i) index.set([0, 1, 2, 2, 1, 3].map((corner) => 4 * i + corner), 6 * i);
  return index;
}

export class Ribbon {
  #capacity = 0;
  #buffer = null;

  constructor(width, opacity, dash) {
    this.width = width;
    this.mesh = new Mesh(new BufferGeometry(), makeRibbonMaterial(width, opacity, dash));
    this.mesh.material.side = DoubleSide;
    this.mesh.frustumCulled = false;
    this.mesh.onBeforeRender = (renderer) => {
      renderer.getDrawingBufferSize(this.mesh.material.uniforms.resolution.value);
      this.mesh.material.uniforms.width.value = this.width * renderer.getPixelRatio();
    };
  }

  get visible() {
    return this.mesh.visible;
  }

  set visible(visible) {
    this.mesh.visible = visible;
  }

  setScale(scale) {
    this.mesh.material.uniforms.scale.value = scale;
  }

  setCount(segments) {
    this.mesh.geometry.setDrawRange(0, 6 * segments);
  }

  /** Takes over segments of the layer's arrays. */
  write(layer, start, count) {
    if (start + count > this.#capacity) return this.#allocate(layer, start + count);
    this.#copy(layer, start, count);
    this.#buffer.addUpdateRange(4 * FLOATS * start, 4 * FLOATS * count);
    this.#buffer.needsUpdate = true;
  }

  #allocate(layer, needed) {
    const { drawRange } = this.mesh.geometry;
    this.#capacity = Math.ceil(1.5 * needed);
    this.#buffer = new InterleavedBuffer(new Float32Array(4 * FLOATS * this.#capacity), FLOATS);
    this.mesh.geometry.dispose();
    this.mesh.geometry = new BufferGeometry();
    this.mesh.geometry.setIndex(new BufferAttribute(quads(this.#capacity), 1));
    for (const [name, size, offset] of PARTS) this.mesh.geometry.setAttribute(name, new InterleavedBufferAttribute(this.#buffer, size, offset));
    this.mesh.geometry.boundingSphere = new Sphere(undefined, Infinity);
    this.mesh.geometry.setDrawRange(drawRange.start, drawRange.count);
    this.#copy(layer, 0, needed);
  }

  #copy({ positions, colours, distances }, start, count) {
    const out = this.#buffer.array;
    for (let i = start; i < start + count; ++i) {
      for (let corner = 0; corner < 4; ++corner) {
        const to = FLOATS * (4 * i + corner);
        for (let k = 0; k < 6; ++k) out[to + k] = positions[6 * i + k];
        for (let k = 0; k < 3; ++k) out[to + 6 + k] = colours[6 * i + k];
        if (distances) [out[to + 9], out[to + 10]] = [distances[2 * i], distances[2 * i + 1]];
      }
    }
  }
}
