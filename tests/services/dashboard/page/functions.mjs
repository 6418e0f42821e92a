// SPDX-License-Identifier: Apache-2.0
// What the page computes without a browser.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { test } from 'node:test';
import * as format from '../../../../services/dashboard/web/src/format.js';
import { decodeFrame } from '../../../../services/dashboard/web/src/frame.js';
import { Box, distanceToSegment, floorIndex, transformRows } from '../../../../services/dashboard/web/src/geometry.js';
import { placeComponents } from '../../../../services/dashboard/web/src/layout.js';
import { Model } from '../../../../services/dashboard/web/src/model.js';
import { CONSTRAINT, GROUND, UNANCHORED, VERDICT_GROUPS, heatColour, heatScale, parseColour, robotColour, verdictColour, verdictGroup } from '../../../../services/dashboard/web/src/palette.js';
import { decodePly } from '../../../../services/dashboard/web/src/ply.js';

const THEMES = ['light', 'dark'];

// As track_frame.h says, by hand.
function frameBytes() {
  const bytes = new ArrayBuffer(40 + 8 + 16 * 2 + 8);
  const view = new DataView(bytes);
  [...'OVT1'].forEach((letter, i) => view.setUint8(i, letter.charCodeAt(0)));
  view.setUint32(4, 2, true);
  view.setFloat64(8, 9_000_000_001, true);
  [1.5, -2.5, 1e6].forEach((value, i) => view.setFloat64(16 + 8 * i, value, true));
  view.setUint32(40, 7, true);
  view.setUint32(44, 2, true);
  [3, 9].forEach((value, i) => view.setInt32(48 + 4 * i, value, true));
  [1, 2, 3, 4, 5, 6].forEach((value, i) => view.setFloat32(56 + 4 * i, value, true));
  view.setUint32(80, 1, true);
  view.setUint32(84, 0, true);
  return bytes;
}

test('a frame is read as it was written', () => {
  const frame = decodeFrame(frameBytes());
  assert.equal(frame.version, 9_000_000_001);
  assert.deepEqual(frame.origin, [1.5, -2.5, 1e6]);
  assert.deepEqual(frame.tracks.map(({ mission, index, values }) => [mission, [...index], [...values]]), [[7, [3, 9], [1, 2, 3, 4, 5, 6]], [1, [], []]]);
});

test('a frame that was cut, lengthened or is none is refused at every length', () => {
  const whole = new Uint8Array(frameBytes());
  for (let size = 0; size < whole.length; ++size) assert.throws(() => decodeFrame(whole.slice(0, size).buffer), /frame/, `${size} bytes`);
  assert.throws(() => decodeFrame(new Uint8Array([...whole, 0, 0, 0, 0]).buffer), /longer/);
  whole[0] = 0;
  assert.throws(() => decodeFrame(whole.buffer), /not one/);
});

function ply(properties, rows, { format: kind = 'binary_little_endian', count = rows.length, before = '' } = {}) {
  const writers = { float: [4, 'setFloat32'], double: [8, 'setFloat64'], uchar: [1, 'setUint8'] };
  const header = `ply\nformat ${kind} 1.0\ncomment made by hand\n${before}element vertex ${count}\n${properties.map(([type, name]) => `property ${type} ${name}\n`).join('')}end_header\n`;
  const stride = properties.reduce((sum, [type]) => sum + writers[type][0], 0);
  const bytes = new Uint8Array(header.length + stride * rows.length);
  bytes.set(new TextEncoder().encode(header));
  const view = new DataView(bytes.buffer, header.length);
  rows.forEach((row, i) => {
    let offset = i * stride;
    row.forEach((value, k) => {
      const [size, write] = writers[properties[k][0]];
      view[write](offset, value, true);
      offset += size;
    });
  });
  return bytes.buffer;
}

test('clouds of floats, of doubles and with other properties in any order are read', () => {
  const xyzi = [['float', 'x'], ['float', 'y'], ['float', 'z'], ['float', 'intensity']];
  assert.deepEqual([...decodePly(ply(xyzi, [[1, 2, 3, 9], [4, 5, 6, 9]]))], [1, 2, 3, 4, 5, 6]);
  const mixed = [['uchar', 'red'], ['double', 'z'], ['double', 'x'], ['double', 'y']];
  // The origin is taken off before the number becomes a float.
  assert.deepEqual([...decodePly(ply(mixed, [[255, 3, 5_000_000.25, 2]]), [5_000_000, 0, 1])], [0.25, 2, 2]);
});

test('clouds that cannot be read are refused, saying why', () => {
  const xyz = [['float', 'x'], ['float', 'y'], ['float', 'z']];
  assert.throws(() => decodePly(ply(xyz, [[1, 2, 3]], { count: 2 })), /ends early/);
  assert.throws(() => decodePly(ply(xyz, [[1, 2, 3]], { format: 'ascii' })), /format ascii/);
  assert.throws(() => decodePly(ply(xyz.slice(0, 2), [[1, 2]])), /missing/);
  assert.throws(() => decodePly(new TextEncoder().encode('no such thing').buffer), /not a PLY/);
});

test('every verdict of the schema has a sign of its own group', () => {
  const schema = readFileSync(new URL('../../../../proto/overtone/v1/map_admin_service.proto', import.meta.url), 'utf8');
  const verdicts = [...schema.matchAll(/LOOP_CLOSURE_VERDICT_([A-Z_]+) = \d/g)].map((match) => match[1].toLowerCase());
  assert.ok(verdicts.length > 10);
  const listed = VERDICT_GROUPS.flatMap((group) => group.verdicts);
  assert.deepEqual([...verdicts].sort(), [...listed].sort());
  assert.equal(verdictGroup('what_a_newer_server_says'), 'waiting');
  for (const key of ['shape', 'name']) assert.equal(new Set(VERDICT_GROUPS.map((group) => group[key])).size, VERDICT_GROUPS.length);
});

const linear = (value) => (value <= 0.04045 ? value / 12.92 : ((value + 0.055) / 1.055) ** 2.4);
const luminance = (colour) => colour.map(linear).reduce((sum, value, i) => sum + value * [0.2126, 0.7152, 0.0722][i], 0);
const contrast = (a, b) => {
  const [low, high] = [luminance(a), luminance(b)].sort((x, y) => x - y);
  return (high + 0.05) / (low + 0.05);
};

test('lines of data stand out from the ground', () => {
  for (const theme of THEMES) {
    const ground = parseColour(GROUND[theme]);
    for (const { key } of VERDICT_GROUPS) {
      const ratio = contrast(parseColour(verdictColour(theme, key)), ground);
      assert.ok(ratio >= 3, `${theme} ${key}: ${ratio.toFixed(2)}`);
    }
    for (let i = 0; i < 8; ++i) {
      const ratio = contrast(parseColour(robotColour(theme, i)), ground);
      assert.ok(ratio >= 2.4, `${theme} robot ${i}: ${ratio.toFixed(2)}`);
    }
  }
});

// Machado et al., IEEE TVCG 15(6), 2009, severity 1, on linear RGB.
const BLINDNESS = {
  protanopia: [[0.152286, 1.052583, -0.204868], [0.114503, 0.786281, 0.099216], [-0.003882, -0.048116, 1.051998]],
  deuteranopia: [[0.367322, 0.860646, -0.227968], [0.280085, 0.672501, 0.047413], [-0.01182, 0.04294, 0.968881]],
  tritanopia: [[1.255528, -0.076749, -0.178779], [-0.078411, 0.930809, 0.147602], [0.004733, 0.691367, 0.3039]],
};

function lab(rgb) {
  const xyz = [[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]].map((row) => row.reduce((sum, value, i) => sum + value * rgb[i], 0));
  const [x, y, z] = xyz.map((value, i) => value / [0.9505, 1, 1.089][i]).map((value) => (value > 0.008856 ? Math.cbrt(value) : 7.787 * value + 16 / 116));
  return [116 * y - 16, 500 * (x - y), 200 * (y - z)];
}

test('verdicts are told apart with any kind of colour vision', () => {
  for (const theme of THEMES) {
    for (const [name, matrix] of Object.entries(BLINDNESS)) {
      const seen = VERDICT_GROUPS.map(({ key }) => {
        const rgb = parseColour(verdictColour(theme, key)).map(linear);
        return lab(matrix.map((row) => Math.min(1, Math.max(0, row.reduce((sum, value, i) => sum + value * rgb[i], 0)))));
      });
      for (let i = 0; i < seen.length; ++i) {
        for (let k = 0; k < i; ++k) {
          const distance = Math.hypot(...seen[i].map((value, axis) => value - seen[k][axis]));
          assert.ok(distance > 12, `${theme}, ${name}: ${VERDICT_GROUPS[i].key} and ${VERDICT_GROUPS[k].key} are ${distance.toFixed(1)} apart`);
        }
      }
    }
  }
});

test('the style sheet has the colours of the picture', () => {
  const css = readFileSync(new URL('../../../../services/dashboard/web/src/style.css', import.meta.url), 'utf8');
  const [light, dark] = css.split(':root[data-theme=dark]').map((part) => new Map([...part.split('}')[0].matchAll(/--([\w-]+): (#[0-9a-f]{6})/g)].map(([, name, colour]) => [name, colour])));
  for (const [theme, variables] of [['light', light], ['dark', dark]]) {
    assert.equal(variables.get('ground'), GROUND[theme]);
    assert.equal(variables.get('apart'), UNANCHORED[theme]);
    assert.equal(variables.get('constraint'), CONSTRAINT[theme]);
    for (const { key } of VERDICT_GROUPS) assert.equal(variables.get(key), verdictColour(theme, key), `${theme} ${key}`);
  }
});

test('heat grows away from the ground without turning back, whatever the hue', () => {
  for (const theme of THEMES) {
    const shades = Array.from({ length: 50 }, (_, i) => luminance(heatColour(theme, i / 49)));
    const sign = theme === 'dark' ? 1 : -1;
    for (let i = 1; i < shades.length; ++i) assert.ok(sign * (shades[i] - shades[i - 1]) > 0, `${theme} at ${i}`);
    const quick = heatScale(theme);
    for (const share of [0, 0.3, 1, 7, -1, NaN]) {
      quick(share).forEach((value, k) => assert.ok(Math.abs(value - heatColour(theme, share)[k]) < 0.02, `${theme} ${share}`));
    }
  }
});

test('floorIndex agrees with a search from the start', () => {
  const sorted = Int32Array.from([2, 3, 5, 8, 13]);
  for (let value = 0; value < 16; ++value) {
    let expected = 0;
    sorted.forEach((element, i) => { if (element <= value) expected = i; });
    assert.equal(floorIndex(sorted, value), expected, `${value}`);
  }
});

test('a quarter turn about z takes x to y, then the position is added', () => {
  const half = Math.SQRT1_2;
  const [x, y, z] = transformRows({ p: [10, 20, 30], q: [0, 0, half, half] }, Float32Array.from([1, 0, 0]));
  assert.ok(Math.hypot(x - 10, y - 21, z - 30) < 1e-5);
});

test('the distance to a segment is to its ends beyond them', () => {
  assert.equal(distanceToSegment(5, 3, 0, 0, 10, 0), 3);
  assert.equal(distanceToSegment(13, 4, 0, 0, 10, 0), 5);
  assert.equal(distanceToSegment(3, 4, 0, 0, 0, 0), 5);
});

test('what is not in the map stands beside it and beside each other', () => {
  const box = (x, y, width, height) => new Box().addRows([x, y, 0, x + width, y + height, 2]);
  const { offsets, frames, map } = placeComponents([
    { component: 0, anchored: true, box: box(-50, -50, 100, 100) },
    { component: 1, anchored: false, box: box(0, 0, 40, 30) },
    { component: 1, anchored: false, box: box(40, 30, 5, 5) },
    { component: 2, anchored: false, box: box(-500, 900, 10, 80) },
    { component: 3, anchored: false, box: new Box() },
  ]);
  assert.deepEqual([...offsets.keys()], [1, 2]);
  const overlap = (a, b) => a.min[0] < b.max[0] && b.min[0] < a.max[0] && a.min[1] < b.max[1] && b.min[1] < a.max[1];
  frames.forEach((frame, i) => {
    assert.ok(!overlap(frame, map));
    frames.slice(0, i).forEach((other) => assert.ok(!overlap(frame, other)));
  });
  const shifted = [0, 0].map((value, k) => value + offsets.get(1)[k]);
  assert.ok(shifted[0] >= frames[0].min[0] && shifted[1] >= frames[0].min[1]);
});

test('a keyframe that was left out is where the last one before it is; beyond the ends nowhere', () => {
  const model = new Model();
  model.setState({ missions: [{ number: 4 }], robots: [] });
  model.setTracks('positions', { origin: [0, 0, 0], tracks: [{ mission: 4, index: Int32Array.from([0, 10, 20]), values: Float32Array.from([0, 0, 0, 1, 1, 1, 2, 2, 2]) }] });
  assert.deepEqual([...model.pointOf(4, 14)], [1, 1, 1]);
  assert.deepEqual([...model.pointOf(4, 20)], [2, 2, 2]);
  assert.equal(model.pointOf(4, 21), null);
  assert.equal(model.pointOf(5, 0), null);
  model.setState({ missions: [], robots: [] });
  assert.equal(model.pointOf(4, 14), null);
});

test('figures are short and carry their unit', () => {
  assert.equal(format.bytes(0), '0 B');
  assert.equal(format.bytes(6_300_000), '6.3 MB');
  assert.equal(format.rate(0.4), '0 B/s');
  assert.equal(format.rate(35_700), '35.7 kB/s');
  assert.equal(format.metres(0.0612), '6.1 cm');
  assert.equal(format.metres(0.0042), '4.2 mm');
  assert.equal(format.metres(100), '100 m');
  assert.equal(format.metres(12_345), '12.3 km');
  assert.equal(format.metres(null), '–');
  assert.equal(format.seconds(0.00321), '3.21 ms');
  assert.equal(format.seconds(-0.0032), '-3.2 ms');
  assert.equal(format.seconds(75), '1 min 15 s');
  assert.equal(format.ago(1000, 40_000), '39 s ago');
  assert.equal(format.ago(null), '–');
});
