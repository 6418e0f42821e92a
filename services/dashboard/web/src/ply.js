// SPDX-License-Identifier: Apache-2.0
// Reads binary little-endian PLY files with x, y, z and any other scalar properties.

const READERS = {
  char: [1, 'getInt8'], int8: [1, 'getInt8'], uchar: [1, 'getUint8'], uint8: [1, 'getUint8'],
  short: [2, 'getInt16'], int16: [2, 'getInt16'], ushort: [2, 'getUint16'], uint16: [2, 'getUint16'],
  int: [4, 'getInt32'], int32: [4, 'getInt32'], uint: [4, 'getUint32'], uint32: [4, 'getUint32'],
  float: [4, 'getFloat32'], float32: [4, 'getFloat32'], double: [8, 'getFloat64'], float64: [8, 'getFloat64'],
};
const MAX_HEADER_BYTES = 4096;

function readHeader(buffer) {
  const text = new TextDecoder('latin1').decode(new Uint8Array(buffer, 0, Math.min(buffer.byteLength, MAX_HEADER_BYTES)));
  const end = /end_header\r?\n/.exec(text);
  if (!text.startsWith('ply') || !end) throw new Error('cloud: not a PLY file');
  const header = { count: 0, stride: 0, offsets: {}, start: end.index + end[0].length };
  let element = '';
  for (const line of text.slice(0, end.index).split(/\r?\n/)) {
    const [word, a, b] = line.trim().split(/\s+/);
    if (word === 'format' && a !== 'binary_little_endian') throw new Error(`cloud: format ${a}`);
    if (word === 'element') {
      element = a;
      if (a === 'vertex') header.count = Number(b);
    }
    if (word === 'property' && element === 'vertex') {
      const reader = READERS[a];
      if (!reader) throw new Error(`cloud: property of type ${a}`);
      header.offsets[b] = { offset: header.stride, read: reader[1] };
      header.stride += reader[0];
    }
  }
  return header;
}

/** Points less `origin`, as floats. @returns {Float32Array} x y z, x y z, ... */
export function decodePly(buffer, origin = [0, 0, 0]) {
  const { count, stride, offsets, start } = readHeader(buffer);
  const axes = ['x', 'y', 'z'].map((axis) => offsets[axis]);
  if (axes.some((axis) => !axis)) throw new Error('cloud: x, y or z is missing');
  if (start + count * stride > buffer.byteLength) throw new Error('cloud: ends early');
  const view = new DataView(buffer, start);
  const points = new Float32Array(3 * count);
  for (let i = 0; i < count; ++i) {
    for (let k = 0; k < 3; ++k) {
      points[3 * i + k] = view[axes[k].read](i * stride + axes[k].offset, true) - origin[k];
    }
  }
  return points;
}
