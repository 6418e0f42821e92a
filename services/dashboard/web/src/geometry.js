// SPDX-License-Identifier: Apache-2.0

/** Of a sorted array: the position of the last element that is not above `value`; 0 when all are. */
export function floorIndex(sorted, value) {
  let low = 0;
  let high = sorted.length - 1;
  while (low < high) {
    const middle = (low + high + 1) >> 1;
    if (sorted[middle] <= value) low = middle;
    else high = middle - 1;
  }
  return low;
}

/** pose.q * point + pose.p, for rows of three; into `out`. Quaternions are x y z w. */
export function transformRows(pose, rows, out = new Float32Array(rows.length)) {
  const [x, y, z, w] = pose.q;
  const [px, py, pz] = pose.p;
  for (let i = 0; i < rows.length; i += 3) {
    const [a, b, c] = [rows[i], rows[i + 1], rows[i + 2]];
    const tx = 2 * (y * c - z * b);
    const ty = 2 * (z * a - x * c);
    const tz = 2 * (x * b - y * a);
    out[i] = a + w * tx + y * tz - z * ty + px;
    out[i + 1] = b + w * ty + z * tx - x * tz + py;
    out[i + 2] = c + w * tz + x * ty - y * tx + pz;
  }
  return out;
}

export class Box {
  constructor() {
    this.min = [Infinity, Infinity, Infinity];
    this.max = [-Infinity, -Infinity, -Infinity];
  }

  get isEmpty() {
    return this.min[0] > this.max[0];
  }

  addRows(rows) {
    for (let i = 0; i < rows.length; i += 3) {
      for (let k = 0; k < 3; ++k) {
        const value = rows[i + k];
        if (value < this.min[k]) this.min[k] = value;
        if (value > this.max[k]) this.max[k] = value;
      }
    }
    return this;
  }

  addBox(box) {
    return box.isEmpty ? this : this.addRows([...box.min, ...box.max]);
  }

  size(axis) {
    return this.max[axis] - this.min[axis];
  }
}

/** Screen distance of a point to a segment, all two numbers. */
export function distanceToSegment(px, py, ax, ay, bx, by) {
  const length = (bx - ax) ** 2 + (by - ay) ** 2;
  const along = length > 0 ? Math.min(1, Math.max(0, ((px - ax) * (bx - ax) + (py - ay) * (by - ay)) / length)) : 0;
  return Math.hypot(px - ax - along * (bx - ax), py - ay - along * (by - ay));
}
