// SPDX-License-Identifier: Apache-2.0
// The camera and what moves it. Draws when something changed and not otherwise.
import { Color, ColorManagement, LinearSRGBColorSpace, MOUSE, PerspectiveCamera, Scene, Vector2, Vector3, WebGLRenderer } from 'three';
import { OrbitControls } from 'three/addons/controls/OrbitControls.js';

const TURN_RAD = Math.PI / 24;
const MOVE = 0.08; // of the distance to what is looked at
const ZOOM = 0.82;
const GLIDE_MS = 350;
const SETTLED_MS = 250;
const SLOW_MS = 45; // between two frames: below it nobody minds
const LATE_FRAMES = 3;
const FREE_SHARE = 0.8; // of the view: labels and the slider need some

ColorManagement.enabled = false; // colours are those of the page's palette, as written

export class Stage {
  #dirty = true;
  #glide = null;
  #resized = [];
  #drawn = [];
  #inset = 0;
  #detail = [];
  #lastMove = 0;
  #lastFrame = null;
  #lateFrames = 0;

  touched = false; // somebody looks where they want to
  isMoving = false;
  hasDetail = true;

  constructor(host) {
    this.host = host;
    this.scene = new Scene();
    this.camera = new PerspectiveCamera(45, 1, 0.1, 1e5);
    this.camera.up.set(0, 0, 1);
    this.camera.position.set(0, -50, 65);
    this.renderer = new WebGLRenderer({ antialias: true, powerPreference: 'high-performance' });
    this.renderer.outputColorSpace = LinearSRGBColorSpace;
    this.renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
    host.append(this.renderer.domElement);
    this.controls = new OrbitControls(this.camera, this.renderer.domElement);
    this.controls.zoomToCursor = true;
    this.controls.maxPolarAngle = Math.PI * 0.495;
    this.controls.screenSpacePanning = false;
    this.controls.mouseButtons = { LEFT: MOUSE.ROTATE, MIDDLE: MOUSE.PAN, RIGHT: MOUSE.PAN };
    this.controls.addEventListener('change', () => this.#moved());
    this.controls.addEventListener('start', () => this.#touch());
    new ResizeObserver(() => this.#resize()).observe(host);
    host.addEventListener('keydown', (event) => this.#key(event));
    this.renderer.domElement.addEventListener('webglcontextrestored', () => this.invalidate());
    this.#resize();
    this.#loop();
  }

  #touch() {
    this.touched = true;
    this.#glide = null;
  }

  onResize(call) {
    this.#resized.push(call);
    call(...this.renderer.getSize(new Vector2()).toArray());
  }

  onDraw(call) {
    this.#drawn.push(call);
  }

  /** Pixels at the left that something covers: what is looked at stands in the middle of the rest. */
  setInset(pixels) {
    this.#inset = pixels;
    this.#resize();
  }

  /** Called with false while the camera moves where frames take too long, and with true when it stands again. */
  onDetail(call) {
    this.#detail.push(call);
  }

  #moved() {
    this.#lastMove = performance.now();
    this.isMoving = true;
    if (this.#lateFrames >= LATE_FRAMES) this.#setDetail(false);
    this.invalidate();
  }

  // A graphics card draws everything always. Where frames of a moving camera were late, motion is shown in fewer lines from then on.
  #watchPace(now) {
    const gap = this.#lastFrame === null ? 0 : now - this.#lastFrame;
    this.#lastFrame = this.isMoving ? now : null;
    if (!this.isMoving) return;
    if (gap > SLOW_MS) {
      this.#lastMove = now; // what happened during the frame is still to come
      if (this.hasDetail) this.#lateFrames += gap > 4 * SLOW_MS ? LATE_FRAMES : 1;
      if (this.#lateFrames >= LATE_FRAMES) this.#setDetail(false);
    }
    if (now - this.#lastMove < SETTLED_MS) return;
    this.isMoving = false;
    this.#setDetail(true);
  }

  #setDetail(full) {
    if (this.hasDetail === full) return;
    this.hasDetail = full;
    for (const call of this.#detail) call(full);
    this.invalidate();
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
    const direction = fromAbove ? new Vector3(0, -1e-3, 1)
      : new Vector3().subVectors(this.camera.position, this.controls.target);
    direction.normalize().multiplyScalar(this.#distanceToSee(box, centre, direction));
    this.#glideTo(centre.clone().add(direction), centre, animate);
  }

  // From `centre` along `direction`, so that every corner of the box is within the free part of the view.
  #distanceToSee(box, centre, direction) {
    const right = new Vector3().crossVectors(this.camera.up, direction).normalize();
    const up = new Vector3().crossVectors(direction, right);
    const tall = FREE_SHARE * Math.tan((this.camera.fov * Math.PI) / 360);
    const wide = (tall * (this.host.clientWidth - this.#inset)) / this.host.clientHeight;
    let distance = 5;
    for (let corner = 0; corner < 8; ++corner) {
      const point = new Vector3(...[0, 1, 2].map((k) => ((corner >> k) & 1 ? box.max : box.min)[k])).sub(centre);
      const spread = Math.max(Math.abs(point.dot(right)) / wide, Math.abs(point.dot(up)) / tall);
      distance = Math.max(distance, spread + point.dot(direction));
    }
    return distance;
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
      this.#watchPace(now);
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
    this.camera.setViewOffset(width, height, -this.#inset / 2, 0, width, height);
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
    this.#touch();
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
