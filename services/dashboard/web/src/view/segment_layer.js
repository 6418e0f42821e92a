// SPDX-License-Identifier: Apache-2.0
// Many polylines in one draw call. Every line has a slot of the layer's arrays, so one that changed is written alone. Drawn as ribbons,
// or as lines of one pixel where there are so many segments that ribbons would cost the frame rate.
import { BufferAttribute, BufferGeometry, LineBasicMaterial, LineDashedMaterial, LineSegments, Sphere } from 'three';
import { Ribbon } from './ribbon.js';

const MAX_WIDE_SEGMENTS = 40_000;
const COARSE_SEGMENTS = 8_000; // about as many while the camera moves, where it must
const FOREVER = new Sphere(undefined, Infinity); // nothing is culled: one object holds everything

export class SegmentLayer {
  #slots = new Map(); // key -> {start, capacity, used}, in segments
  #capacity = 0;
  #used = 0;
  #dash;
  #drawn = null; // this.wide, this.thin or neither
  #detail = true;
  #coarseIsOld = true;

  /** @param {{width: number, dash?: number[], opacity?: number, order?: number}} style in pixels */
  constructor(parent, style) {
    this.#dash = style.dash ?? null;
    const common = { vertexColors: true, transparent: true, opacity: style.opacity ?? 1, depthWrite: false };
    const dashes = this.#dash ? { dashSize: this.#dash[0], gapSize: this.#dash[1] } : {};
    this.wide = new Ribbon(style.width, style.opacity ?? 1, this.#dash);
    this.thin = new LineSegments(new BufferGeometry(),
      this.#dash ? new LineDashedMaterial({ ...common, ...dashes }) : new LineBasicMaterial(common));
    this.coarse = new LineSegments(new BufferGeometry(), this.thin.material);
    this.thin.frustumCulled = this.coarse.frustumCulled = false;
    for (const object of [this.wide.mesh, this.thin, this.coarse]) {
      object.renderOrder = style.order ?? 0;
      parent.add(object);
    }
    this.visible = true;
    this.#allocate(64);
    this.#choose();
  }

  get segments() {
    return this.#used;
  }

  setVisible(visible) {
    this.visible = visible;
    this.#choose();
  }

  /** False: a layer of very many segments is drawn with every n-th node alone. */
  setDetail(detail) {
    this.#detail = detail;
    this.#choose();
  }

  setDashScale(scale) {
    if (!this.#dash) return;
    this.wide.setScale(scale);
    this.thin.material.scale = scale;
  }

  get isDashed() {
    return this.#dash !== null;
  }

  /** @param rows polyline of x y z rows @param colours r g b rows, or one r g b for all */
  setLine(key, rows, colours) {
    this.#write(key, Math.max(0, rows.length / 3 - 1), (start) => this.#fillLine(start, rows, colours));
  }

  /** Separate segments: six numbers each; `colours` three numbers for each segment. */
  setSegments(key, ends, colours) {
    this.#write(key, ends.length / 6, (start) => {
      this.positions.set(ends, 6 * start);
      for (let i = 0; i < ends.length / 6; ++i) {
        for (let k = 0; k < 6; ++k) this.colours[6 * (start + i) + k] = colours[3 * i + (k % 3)];
      }
      if (this.#dash) this.#measure(start, ends.length / 6, false);
    });
  }

  remove(key) {
    const slot = this.#slots.get(key);
    if (!slot) return;
    this.#clear(slot, 0);
    this.#used -= slot.used;
    this.#slots.delete(key);
    this.#upload(slot.start, slot.capacity);
    this.#choose();
  }

  keepOnly(keys) {
    for (const key of [...this.#slots.keys()]) if (!keys.has(key)) this.remove(key);
  }

  #write(key, segments, fill) {
    let slot = this.#slots.get(key);
    if (!slot || slot.capacity < segments) slot = this.#reserve(key, segments);
    fill(slot.start);
    this.#clear(slot, segments);
    this.#used += segments - slot.used;
    slot.used = segments;
    this.#upload(slot.start, slot.capacity);
    this.#choose();
  }

  #fillLine(start, rows, colours) {
    const single = colours.length === 3 && rows.length !== 3;
    const segments = rows.length / 3 - 1;
    for (let i = 0; i < segments; ++i) {
      const to = 6 * (start + i);
      for (let k = 0; k < 6; ++k) {
        this.positions[to + k] = rows[3 * i + k];
        this.colours[to + k] = single ? colours[k % 3] : colours[3 * i + k];
      }
    }
    if (this.#dash) this.#measure(start, segments, true);
  }

  // Dashes need the distance along the line at both ends of a segment.
  #measure(start, segments, goesOn) {
    let along = 0;
    for (let i = start; i < start + segments; ++i) {
      const p = this.positions.subarray(6 * i, 6 * i + 6);
      this.distances[2 * i] = goesOn ? along : 0;
      along = this.distances[2 * i] + Math.hypot(p[3] - p[0], p[4] - p[1], p[5] - p[2]);
      this.distances[2 * i + 1] = along;
    }
  }

  // What a slot does not use are segments without length.
  #clear(slot, from) {
    this.positions.fill(0, 6 * (slot.start + from), 6 * (slot.start + slot.capacity));
  }

  #reserve(key, segments) {
    const old = this.#slots.get(key);
    if (old) this.remove(key);
    const capacity = Math.ceil(segments * 1.5) + 16;
    let end = 0;
    for (const slot of this.#slots.values()) end = Math.max(end, slot.start + slot.capacity);
    if (end + capacity > this.#capacity) end = this.#grow(capacity);
    const slot = { start: end, capacity, used: 0 };
    this.#slots.set(key, slot);
    return slot;
  }

  // Moves all slots together, into arrays twice as large as needed.
  #grow(capacity) {
    const old = { positions: this.positions, colours: this.colours, distances: this.distances };
    const needed = [...this.#slots.values()].reduce((sum, slot) => sum + slot.capacity, capacity);
    this.#allocate(2 * needed);
    let end = 0;
    for (const slot of this.#slots.values()) {
      const [from, to] = [slot.start, slot.start + slot.used];
      this.positions.set(old.positions.subarray(6 * from, 6 * to), 6 * end);
      this.colours.set(old.colours.subarray(6 * from, 6 * to), 6 * end);
      if (this.#dash) this.distances.set(old.distances.subarray(2 * from, 2 * to), 2 * end);
      slot.start = end;
      end += slot.capacity;
    }
    return end;
  }

  #allocate(capacity) {
    this.#capacity = capacity;
    this.positions = new Float32Array(6 * capacity);
    this.colours = new Float32Array(6 * capacity);
    this.distances = this.#dash ? new Float32Array(2 * capacity) : null;
    this.#drawn = null; // whichever it will be takes over all of it
    this.#allocateThin();
  }

  #allocateThin() {
    this.thin.geometry.dispose();
    const geometry = new BufferGeometry();
    const attribute = (name, array, size) => {
      const made = new BufferAttribute(array, size);
      geometry.setAttribute(name, made);
      return made;
    };
    this.thinBuffers = [attribute('position', this.positions, 3), attribute('color', this.colours, 3)];
    if (this.#dash) this.thinBuffers.push(attribute('lineDistance', this.distances, 1));
    geometry.boundingSphere = FOREVER;
    this.thin.geometry = geometry;
    this.coarse.geometry.dispose();
    this.coarse.geometry = new BufferGeometry();
    for (const [name, made] of Object.entries(geometry.attributes)) this.coarse.geometry.setAttribute(name, made);
    this.coarse.geometry.boundingSphere = FOREVER;
  }

  // Only what changed goes to the graphics card, and only for what is drawn: the renderer forgets ranges when it has sent them.
  #upload(start, count) {
    this.#coarseIsOld = true;
    if (this.#drawn === this.wide) this.wide.write(this, start, count);
    if (this.#drawn !== this.thin) return;
    this.thinBuffers.forEach((buffer, i) => {
      const size = i === 2 ? 2 : 6;
      buffer.addUpdateRange(size * start, size * count);
      buffer.needsUpdate = true;
    });
  }

  #choose() {
    let end = 0;
    for (const slot of this.#slots.values()) end = Math.max(end, slot.start + slot.capacity);
    const shown = this.visible && this.#used > 0;
    const drawn = shown ? (this.#used <= MAX_WIDE_SEGMENTS ? this.wide : this.thin) : null;
    if (drawn !== this.#drawn) {
      this.#drawn = drawn;
      if (drawn === this.thin) this.thinBuffers.forEach((buffer) => buffer.clearUpdateRanges());
      this.#upload(0, end);
    }
    this.wide.setCount(end);
    this.thin.geometry.setDrawRange(0, 2 * end);
    const coarse = drawn === this.thin && !this.#detail;
    if (coarse && this.#coarseIsOld) this.#makeCoarse();
    this.wide.visible = drawn === this.wide;
    this.thin.visible = drawn === this.thin && !coarse;
    this.coarse.visible = coarse;
  }

  // From the start of a segment to the end of the n-th after it, in the same arrays.
  #makeCoarse() {
    const every = Math.max(1, Math.ceil(this.#used / COARSE_SEGMENTS));
    const index = [];
    for (const { start, used } of this.#slots.values()) {
      for (let i = 0; i < used; i += every) index.push(2 * (start + i), 2 * (start + Math.min(i + every, used)) - 1);
    }
    this.coarse.geometry.setIndex(index);
    this.#coarseIsOld = false;
  }
}
