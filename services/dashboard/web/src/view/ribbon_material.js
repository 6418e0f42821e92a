// SPDX-License-Identifier: Apache-2.0
// Lines of a width in pixels: every segment is a quad of four vertices, which the vertex shader spreads on the screen. No instances:
// where graphics run on the processor, each instance would cost as much as a draw call of its own.
import { ShaderMaterial, Vector2 } from 'three';

const VERTEX = /* glsl */ `
  attribute vec3 start;
  attribute vec3 end;
  attribute vec3 shade;
  attribute vec2 along;
  uniform vec2 resolution;
  uniform float width;
  varying vec3 vShade;
  varying float vAlong;

  // Ends behind the camera move to where the segment enters the view.
  vec4 inView(vec4 point, vec4 other) {
    float depth = point.z + point.w;
    return depth >= 0.0 ? point : mix(point, other, depth / (depth - other.z - other.w));
  }

  void main() {
    int corner = gl_VertexID & 3; // two at the start, two at the end
    vec4 first = projectionMatrix * modelViewMatrix * vec4(start, 1.0);
    vec4 last = projectionMatrix * modelViewMatrix * vec4(end, 1.0);
    vShade = shade;
    vAlong = corner < 2 ? along.x : along.y;
    bool hidden = first.z + first.w < 0.0 && last.z + last.w < 0.0;
    if (hidden || start == end) {
      gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
      return;
    }
    vec4 a = inView(first, last);
    vec4 b = inView(last, first);
    vec2 way = (b.xy / b.w - a.xy / a.w) * resolution;
    vec2 direction = length(way) > 1e-4 ? normalize(way) : vec2(1.0, 0.0);
    vec2 aside = vec2(-direction.y, direction.x) * (corner == 0 || corner == 2 ? 1.0 : -1.0);
    vec2 beyond = direction * (corner < 2 ? -0.5 : 0.5); // so that bends have no gaps
    vec4 at = corner < 2 ? a : b;
    at.xy += (aside + beyond) * width / resolution * at.w;
    gl_Position = at;
  }`;

const FRAGMENT = /* glsl */ `
  uniform float opacity;
  uniform float dash;
  uniform float period;
  uniform float scale;
  varying vec3 vShade;
  varying float vAlong;

  void main() {
    if (dash > 0.0 && mod(vAlong * scale, period) > dash) discard;
    gl_FragColor = vec4(vShade, opacity);
  }`;

export function makeRibbonMaterial(width, opacity, dash) {
  return new ShaderMaterial({
    vertexShader: VERTEX,
    fragmentShader: FRAGMENT,
    uniforms: {
      resolution: { value: new Vector2(1, 1) }, width: { value: width }, opacity: { value: opacity },
      dash: { value: dash ? dash[0] : 0 }, period: { value: dash ? dash[0] + dash[1] : 1 }, scale: { value: 1 },
    },
    transparent: true,
    depthWrite: false,
  });
}
