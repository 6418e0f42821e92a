// SPDX-License-Identifier: Apache-2.0
// The camera and what moves it. Draws when something changed and not otherwise.
import { Color, MOUSE, PerspectiveCamera, Scene, Vector2, Vector3, WebGLRenderer } from 'three';
import { OrbitControls } from 'three/addons/controls/OrbitControls.js';

const TURN_RAD = Math.PI / 24;
const MOVE = 0.08; // of the distance to what is looked at
const ZOOM = 0.82;
const GLIDE_MS = 350;

export class Stage {
  #dirty = true;
  #glide = null;
  #resized = [];
  #drawn = [];

  constructor(host) {
    this.host = host;
    this.scene = new Scene();
    this.camera = new PerspectiveCamera(45, 1, 0.1, 1e5);
    this.camera.up.set(0, 0, 1);
    this.camera.position.set(0, -60, 60);
    this.renderer = new WebGLRenderer({ antialias: true, powerPreference: 'high-performance' });
    this.renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
    host.append(this.renderer.domElement);
    this.controls = new OrbitControls(this.camera, this.renderer.domElement);
    this.controls.zoomToCursor = true;
    this.controls.maxPolarAngle = Math.PI * 0.495;
    this.controls.screenSpacePanning = false;
    this.controls.mouseButtons = { LEFT: MOUSE.ROTATE, MIDDLE: MOUSE.PAN, RIGHT: MOUSE.PAN };
    this.controls.addEventListener('change', () => this.invalidate());
    this.controls.addEventListener('start', () => { this.#glide = null; });
    new ResizeObserver(() => this.#resize()).observe(host);
    host.addEventListener('keydown', (event) => this.#key(event));
    this.renderer.domElement.addEventListener('webglcontextrestored', () => this.invalidate());
    this.#resize();
    this.#loop();
  }

  onResize(call) {
    this.#resized.push(call);
    call(...this.renderer.getSize(new Vector2()).toArray());
  }

  onDraw(call) {
    this.#drawn.push(call);
  }

  invalidate() {
    this.#dirty = true;
  }

  setGround(colour) {
    this.scene.background = new Color(colour);
    this.invalidate();
  }

  /** Metres that one pixel spans at what is looked at. */
  metresPerPixel() {
    const distance = this.camera.position.distanceTo(this.controls.target);
    return (2 * distance * Math.tan((this.camera.fov * Math.PI) / 360)) / Math.max(1, this.host.clientHeight);
  }

  /** Pixels of the view; null behind the camera. */
  project(x, y, z, out = new Vector3()) {
    out.set(x, y, z).project(this.camera);
    if (out.z > 1 || out.z < -1) return null;
    out.x = (0.5 + 0.5 * out.x) * this.host.clientWidth;
    out.y = (0.5 - 0.5 * out.y) * this.host.clientHeight;
    return out;
  }

  /** Looks at a box from where it looks now, or from above. */
  fit(box, { fromAbove = false, animate = true } = {}) {
    if (box.isEmpty) return;
    const centre = new Vector3(...box.min).add(new Vector3(...box.max)).multiplyScalar(0.5);
    const radius = Math.max(3, 0.5 * Math.hypot(...[0, 1, 2].map((k) => box.size(k))));
    const half = (this.camera.fov * Math.PI) / 360;
    const narrow = Math.min(1, this.camera.aspect);
    const direction = fromAbove ? new Vector3(0, -1e-3, 1)
      : new Vector3().subVectors(this.camera.position, this.controls.target);
    direction.normalize().multiplyScalar((1.05 * radius) / Math.sin(Math.atan(Math.tan(half) * narrow)));
    this.#glideTo(centre.clone().add(direction), centre, animate);
  }

  #glideTo(position, target, animate) {
    const still = !animate || matchMedia('(prefers-reduced-motion: reduce)').matches;
    if (still) {
      this.camera.position.copy(position);
      this.controls.target.copy(target);
      this.controls.update();
    } else {
      this.#glide = { start: performance.now(), from: [this.camera.position.clone(), this.controls.target.clone()], to: [position, target] };
    }
    this.invalidate();
  }

  #stepGlide(now) {
    const share = Math.min(1, (now - this.#glide.start) / GLIDE_MS);
    const smooth = share * share * (3 - 2 * share);
    this.camera.position.lerpVectors(this.#glide.from[0], this.#glide.to[0], smooth);
    this.controls.target.lerpVectors(this.#glide.from[1], this.#glide.to[1], smooth);
    this.controls.update();
    if (share === 1) this.#glide = null;
    this.invalidate();
  }

  #loop() {
    requestAnimationFrame((now) => {
      if (this.#glide) this.#stepGlide(now);
      if (this.#dirty) this.draw();
      this.#loop();
    });
  }

  draw() {
    this.#dirty = false;
    const distance = this.camera.position.distanceTo(this.controls.target);
    this.camera.near = Math.max(0.05, distance / 500);
    this.camera.far = Math.max(2000, distance * 50);
    this.camera.updateProjectionMatrix();
    for (const call of this.#drawn) call();
    this.renderer.render(this.scene, this.camera);
  }

  #resize() {
    const [width, height] = [Math.max(1, this.host.clientWidth), Math.max(1, this.host.clientHeight)];
    this.renderer.setSize(width, height);
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
    for (const call of this.#resized) call(width, height);
    this.invalidate();
  }

  #key(event) {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const step = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] }[event.key];
    if (step) {
      if (event.shiftKey) this.turn(-step[0] * TURN_RAD, -step[1] * TURN_RAD);
      else this.move(step[0], step[1]);
    } else if (event.key === '+' || event.key === '=') this.zoom(ZOOM);
    else if (event.key === '-') this.zoom(1 / ZOOM);
    else return;
    event.preventDefault();
  }

  turn(azimuth, polar) {
    const offset = new Vector3().subVectors(this.camera.position, this.controls.target);
    const radius = offset.length();
    const heading = Math.atan2(offset.y, offset.x) + azimuth;
    const tilt = Math.min(Math.max(Math.acos(offset.z / radius) + polar, 0.01), this.controls.maxPolarAngle);
    offset.set(Math.sin(tilt) * Math.cos(heading), Math.sin(tilt) * Math.sin(heading), Math.cos(tilt)).multiplyScalar(radius);
    this.camera.position.copy(this.controls.target).add(offset);
    this.controls.update();
    this.invalidate();
  }

  move(right, forward) {
    const ahead = new Vector3().subVectors(this.controls.target, this.camera.position).setZ(0).normalize();
    const side = new Vector3(ahead.y, -ahead.x, 0);
    const length = MOVE * this.camera.position.distanceTo(this.controls.target);
    const step = side.multiplyScalar(right * length).addScaledVector(ahead, forward * length);
    this.camera.position.add(step);
    this.controls.target.add(step);
    this.controls.update();
    this.invalidate();
  }

  zoom(factor) {
    this.camera.position.sub(this.controls.target).multiplyScalar(factor).add(this.controls.target);
    this.controls.update();
    this.invalidate();
  }
}
