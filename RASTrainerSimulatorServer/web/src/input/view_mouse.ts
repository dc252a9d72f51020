/** Mouse, touch pad and fingers turn the view: right drag, wheel, pinch and a drag of two fingers. */

import type { Connection } from "../stream/connection";

const RIGHT_BUTTON = 2;
/** A drag over the whole height of the page turns the view by so much. */
const DEG_PER_HEIGHT = 180;
const ZOOM_PER_PIXEL = 0.001;
/** Pixels of a line of the wheel, where a browser counts lines. */
const LINE_PIXELS = 16;
/** A pinch on a touch pad comes as a wheel whose steps are small. */
const PINCH = 8;
const ZOOM_LIMIT = 4;
/** A pointer that rests for so long is hidden. */
const HIDDEN_MS = 3000;

export class ViewMouse {
  private around = 0;
  private higher = 0;
  private zoom = 1;
  private readonly fingers = new Map<number, { x: number; y: number }>();
  private dragged = -1;
  private hiding: ReturnType<typeof setTimeout> | undefined;

  constructor(
    canvas: HTMLElement,
    private readonly connection: Connection,
  ) {
    canvas.style.touchAction = "none";
    canvas.addEventListener("contextmenu", (event) => event.preventDefault());
    canvas.addEventListener("pointerdown", (event) => this.press(canvas, event));
    canvas.addEventListener("pointermove", (event) => this.move(event));
    for (const end of ["pointerup", "pointercancel"] as const) {
      canvas.addEventListener(end, (event) => this.release(event.pointerId));
    }
    canvas.addEventListener("wheel", (event) => this.wheel(event), { passive: false });
    canvas.addEventListener("pointermove", () => this.showPointer(canvas));
  }

  private showPointer(canvas: HTMLElement): void {
    canvas.style.cursor = "";
    clearTimeout(this.hiding);
    this.hiding = setTimeout(() => (canvas.style.cursor = "none"), HIDDEN_MS);
  }

  /** Send the movement since the last picture. */
  tell(): void {
    const { around, higher, zoom } = this;
    if (around === 0 && higher === 0 && zoom === 1) return;
    this.around = this.higher = 0;
    this.zoom = 1;
    this.connection.send({
      type: "orbit",
      aroundDeg: Math.min(180, Math.max(-180, around)),
      higherDeg: Math.min(180, Math.max(-180, higher)),
      zoom: Math.min(ZOOM_LIMIT, Math.max(1 / ZOOM_LIMIT, zoom)),
    });
  }

  private press(canvas: HTMLElement, event: PointerEvent): void {
    if (event.pointerType === "touch") {
      this.fingers.set(event.pointerId, { x: event.clientX, y: event.clientY });
    } else if (event.button === RIGHT_BUTTON) {
      this.dragged = event.pointerId;
    } else {
      return;
    }
    canvas.setPointerCapture(event.pointerId);
  }

  private release(pointer: number): void {
    this.fingers.delete(pointer);
    if (pointer === this.dragged) this.dragged = -1;
  }

  private move(event: PointerEvent): void {
    if (event.pointerId === this.dragged) this.drag(event.movementX, event.movementY);
    const finger = this.fingers.get(event.pointerId);
    if (finger === undefined) return;
    const before = this.spread();
    const right = event.clientX - finger.x;
    const down = event.clientY - finger.y;
    finger.x = event.clientX;
    finger.y = event.clientY;
    const count = this.fingers.size;
    this.drag(right / count, down / count);
    if (count === 2 && before > 0) this.zoom *= before / Math.max(1, this.spread());
  }

  /** The picture follows the hand, so the eye moves the other way. */
  private drag(right: number, down: number): void {
    this.around -= (DEG_PER_HEIGHT * right) / window.innerHeight;
    this.higher += (DEG_PER_HEIGHT * down) / window.innerHeight;
  }

  private wheel(event: WheelEvent): void {
    event.preventDefault();
    const pixels = event.deltaY * (event.deltaMode === WheelEvent.DOM_DELTA_LINE ? LINE_PIXELS : 1);
    this.zoom *= Math.exp(ZOOM_PER_PIXEL * pixels * (event.ctrlKey ? PINCH : 1));
  }

  /** Return how far apart two fingers are. */
  private spread(): number {
    const [one, other] = [...this.fingers.values()];
    if (one === undefined || other === undefined) return 0;
    return Math.hypot(one.x - other.x, one.y - other.y);
  }
}
