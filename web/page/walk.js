// Walking and looking around, by keys, mouse and touch; and dragging an object.
import { Euler, Plane, Raycaster, Vector2, Vector3 } from 'three';

const RADIANS_A_PIXEL = 0.004, RADIANS_A_SECOND = 1.4, TAP_SECONDS = 1 / 30;
const MOVES = { KeyW: [0, 0, -1], KeyS: [0, 0, 1], KeyA: [-1, 0, 0], KeyD: [1, 0, 0], KeyQ: [0, -1, 0], KeyE: [0, 1, 0] };
const TURNS = { ArrowLeft: [1, 0], ArrowRight: [-1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };

export class Walk {
  /** `speed` in metres a second; `changed` is called when the camera or the object has moved. */
  constructor(canvas, camera, speed, object, changed) {
    Object.assign(this, { canvas, camera, speed, object, changed, held: new Set(), fingers: new Map(), grab: null });
    this.home = { position: camera.position.clone(), quaternion: camera.quaternion.clone() };
    addEventListener('keydown', (event) => this.#key(event, true));
    addEventListener('keyup', (event) => this.#key(event, false));
    addEventListener('blur', () => this.held.clear());
    canvas.addEventListener('pointerdown', (event) => this.#down(event));
    canvas.addEventListener('pointermove', (event) => this.#move(event));
    for (const end of ['pointerup', 'pointercancel']) canvas.addEventListener(end, (event) => this.#up(event));
    canvas.addEventListener('wheel', (event) => this.#wheel(event), { passive: false });
  }

  reset() {
    this.camera.position.copy(this.home.position);
    this.camera.quaternion.copy(this.home.quaternion);
    this.changed();
  }

  // Applies the keys that are held for `seconds`.
  advance(seconds) {
    for (const code of this.held) this.#press(code, seconds);
  }

  #press(code, seconds) {
    if (MOVES[code]) this.#go(...MOVES[code].map((way) => way * this.speed * seconds * (this.fast ? 3 : 1)));
    if (TURNS[code]) this.#turn(...TURNS[code].map((way) => way * RADIANS_A_SECOND * seconds));
  }

  // Moves along the camera's axes, with `right` and `back` horizontal.
  #go(right, up, back) {
    const heading = new Euler().setFromQuaternion(this.camera.quaternion, 'YXZ').y;
    this.camera.position.add(new Vector3(right, up, back).applyAxisAngle(new Vector3(0, 1, 0), heading));
    this.changed();
  }

  #turn(left, up) {
    const turned = new Euler().setFromQuaternion(this.camera.quaternion, 'YXZ');
    turned.set(Math.max(-1.5, Math.min(1.5, turned.x + up)), turned.y + left, 0);
    this.camera.quaternion.setFromEuler(turned);
    this.changed();
  }

  #key(event, down) {
    this.fast = event.shiftKey;
    if (!down) this.held.delete(event.code); // also with a modifier, or with the focus elsewhere
    if (event.ctrlKey || event.metaKey || event.altKey || event.target.matches?.('input')) return;
    if (!MOVES[event.code] && !TURNS[event.code]) return;
    event.preventDefault();
    // Moves at least this far, even if the key is released before the next frame.
    if (down && !event.repeat) this.#press(event.code, TAP_SECONDS);
    if (down) this.held.add(event.code);
  }

  #ray(event) {
    const ray = new Raycaster(), box = this.canvas.getBoundingClientRect();
    ray.setFromCamera(new Vector2(((event.clientX - box.x) / box.width) * 2 - 1, 1 - ((event.clientY - box.y) / box.height) * 2), this.camera);
    return ray;
  }

  #down(event) {
    this.canvas.setPointerCapture(event.pointerId);
    this.fingers.set(event.pointerId, { x: event.clientX, y: event.clientY });
    const ray = this.#ray(event), [hit] = this.fingers.size === 1 ? ray.intersectObject(this.object) : [];
    const facing = this.camera.getWorldDirection(new Vector3());
    this.grab = hit ? { plane: new Plane().setFromNormalAndCoplanarPoint(facing, hit.point), offset: this.object.position.clone().sub(hit.point) } : null;
  }

  #move(event) {
    const finger = this.fingers.get(event.pointerId);
    if (!finger) return;
    const dx = event.clientX - finger.x, dy = event.clientY - finger.y, before = this.#spread();
    finger.x = event.clientX;
    finger.y = event.clientY;
    if (this.grab) this.#drag(event);
    else if (this.fingers.size === 1) this.#turn(dx * RADIANS_A_PIXEL, dy * RADIANS_A_PIXEL);
    else if (this.fingers.size === 2) {
      const metres = this.speed / 250;
      this.#go((-dx * metres) / 2, (dy * metres) / 2, (before - this.#spread()) * metres);
    }
  }

  #drag(event) {
    const place = this.#ray(event).ray.intersectPlane(this.grab.plane, new Vector3());
    if (place) this.object.position.copy(place.add(this.grab.offset));
    this.changed();
  }

  #spread() {
    const [a, b] = this.fingers.values();
    return b ? Math.hypot(a.x - b.x, a.y - b.y) : 0;
  }

  #up(event) {
    this.fingers.delete(event.pointerId);
    this.grab = null;
  }

  #wheel(event) {
    event.preventDefault();
    this.#go(0, 0, Math.sign(event.deltaY) * this.speed * 0.1);
  }
}
