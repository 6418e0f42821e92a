// SPDX-License-Identifier: Apache-2.0
// Where the missions that are not in the map are drawn: nobody knows where they are, so each of their components stands in a place of
// its own beside the map, in a column.
import { Box } from './geometry.js';

const STEP_M = 10; // places move by whole steps, so that a growing mission does not make its neighbours tremble

function roundUp(value) {
  return Math.ceil(value / STEP_M) * STEP_M;
}

/**
 * @param {{component: number, anchored: boolean, box: Box}[]} missions with positions
 * @returns {{offsets: Map<number, number[]>, frames: {component: number, min: number[], max: number[]}[], map: Box}}
 *     what to add to positions of a component, and the ground that it then stands on
 */
export function placeComponents(missions) {
  const map = new Box();
  const boxes = new Map();
  for (const { component, anchored, box } of missions) {
    if (box.isEmpty) continue;
    if (anchored) map.addBox(box);
    else boxes.set(component, (boxes.get(component) ?? new Box()).addBox(box));
  }
  const offsets = new Map();
  const frames = [];
  const gap = Math.max(2 * STEP_M, map.isEmpty ? 0 : roundUp(0.08 * Math.max(map.size(0), map.size(1))));
  const left = map.isEmpty ? 0 : roundUp(map.max[0]) + gap;
  let top = map.isEmpty ? 0 : roundUp(map.max[1]);
  const ground = map.isEmpty ? 0 : map.min[2];
  for (const component of [...boxes.keys()].sort((a, b) => a - b)) {
    const box = boxes.get(component);
    const [width, height] = [roundUp(box.size(0)) + STEP_M, roundUp(box.size(1)) + STEP_M];
    offsets.set(component, [
      left + (width - box.size(0)) / 2 - box.min[0],
      top - (height - box.size(1)) / 2 - box.max[1],
      ground - box.min[2],
    ]);
    frames.push({ component, min: [left, top - height, ground], max: [left + width, top, ground + box.size(2)] });
    top -= height + gap / 2;
  }
  return { offsets, frames, map };
}
