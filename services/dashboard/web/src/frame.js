// SPDX-License-Identifier: Apache-2.0
// Reads the service's binary frames (track_frame.h): tracks of three numbers a node.

const MAGIC = 0x3154564f; // "OVT1", little-endian
const HEADER_BYTES = 40;

/** @returns {{version: number, origin: number[], tracks: {mission: number, index: Int32Array, values: Float32Array}[]}} */
export function decodeFrame(buffer) {
  if (buffer.byteLength < HEADER_BYTES) throw new Error('frame: too short');
  const header = new DataView(buffer, 0, HEADER_BYTES);
  if (header.getUint32(0, true) !== MAGIC) throw new Error('frame: not one');
  const count = header.getUint32(4, true);
  const origin = [16, 24, 32].map((offset) => header.getFloat64(offset, true));
  const tracks = [];
  let offset = HEADER_BYTES;
  for (let i = 0; i < count; ++i) {
    if (offset + 8 > buffer.byteLength) throw new Error('frame: ends early');
    const [mission, size] = new Uint32Array(buffer, offset, 2);
    offset += 8;
    if (offset + 16 * size > buffer.byteLength) throw new Error('frame: ends early');
    const index = new Int32Array(buffer, offset, size);
    const values = new Float32Array(buffer, offset + 4 * size, 3 * size);
    offset += 16 * size;
    tracks.push({ mission, index, values });
  }
  if (offset !== buffer.byteLength) throw new Error('frame: longer than it says');
  return { version: header.getFloat64(8, true), origin, tracks };
}
