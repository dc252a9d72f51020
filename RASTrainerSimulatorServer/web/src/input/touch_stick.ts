/** A stick on a touch screen: a thumb pushes it, and it comes back when the thumb is lifted. */

import { element } from "../elements";

export class TouchStick {
  readonly place = element("div", "", { className: "stick", role: "img" });
  /** Right and up, −1 to 1 each. */
  x = 0;
  y = 0;
  private readonly knob = element("i");
  private pointer: number | null = null;

  constructor(private readonly onChanged: () => void) {
    this.place.append(this.knob);
    this.place.onpointerdown = (event) => this.begin(event);
    this.place.onpointermove = (event) => this.move(event);
    for (const end of ["pointerup", "pointercancel", "lostpointercapture"] as const) {
      this.place.addEventListener(end, (event) => this.end(event));
    }
  }

  label(text: string): void {
    this.place.ariaLabel = text;
    this.place.dataset.says = text;
  }

  /** Release the stick, even under the thumb. */
  release(): void {
    this.pointer = null;
    this.put(0, 0);
  }

  private begin(event: PointerEvent): void {
    if (this.pointer !== null) return;
    this.pointer = event.pointerId;
    this.place.setPointerCapture(event.pointerId);
    this.move(event);
  }

  private move(event: PointerEvent): void {
    if (event.pointerId !== this.pointer) return;
    const box = this.place.getBoundingClientRect();
    const radius = box.width / 2;
    const x = (event.clientX - box.left - radius) / radius;
    const y = (box.top + radius - event.clientY) / radius;
    const far = Math.max(1, Math.hypot(x, y));
    this.put(x / far, y / far);
  }

  private end(event: PointerEvent): void {
    if (event.pointerId === this.pointer) this.release();
  }

  private put(x: number, y: number): void {
    if (x === this.x && y === this.y) return;
    this.x = x;
    this.y = y;
    this.knob.style.translate = `${50 * x}% ${-50 * y}%`;
    this.onChanged();
  }
}
