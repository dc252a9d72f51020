/** The gamepads that the browser reads, in the W3C's standard layout. */

import type { Connection } from "../stream/connection";
import type { ControlNews, Feedback } from "../generated";

const AXES = 4;
const BUTTONS = 17;
const START = 9;
const AT_MIDDLE: readonly number[] = new Array<number>(AXES + BUTTONS).fill(0);
const CHANGE = 0.004;
/** As far as released sticks may rest from their middle. */
const AT_REST = 0.15;
/** A pad that is pushed this far replaces an idle pad. */
const PUSHED = 0.5;

export class Gamepads {
  /** Positions of axes and buttons. */
  private sent: readonly number[] = AT_MIDDLE;
  private control: ControlNews | null = null;
  private used = -1;
  isHolding = false;
  /** Whether there are only pads whose layout the browser does not know. */
  isUnknown = false;

  constructor(
    private readonly connection: Connection,
    private readonly onKnown: () => void,
  ) {}

  takeControl(control: ControlNews): void {
    this.control = control;
  }

  /** Read the pad, and report changes. */
  poll(): void {
    const pad = this.choose();
    if (pad === null) {
      this.release();
      return;
    }
    // A gamepad at this very computer is read by the simulator too: one of both is enough.
    const isReadThere = this.control?.holder === "gamepad" && !this.control.isYou;
    if (isReadThere && !this.isHolding && !(pad.buttons[START]?.pressed ?? false)) return;
    const positions = AT_MIDDLE.map((_, index) => (index < AXES ? pad.axes[index] : pad.buttons[index - AXES]?.value) ?? 0);
    this.isHolding = positions.some((value) => Math.abs(value) > AT_REST);
    if (positions.some((value, index) => Math.abs(value - this.sent[index]!) > CHANGE)) this.tell(positions);
  }

  /** Release everything: nobody sees what the pad does. */
  release(): void {
    if (!this.isHolding) return;
    this.isHolding = false;
    this.tell(AT_MIDDLE);
  }

  /** Vibrate, if this pad is what drives the arm. */
  feel(event: Feedback): void {
    const drives = this.control?.isYou && this.control.holder === "browser's gamepad";
    if (!drives || event.rumble <= 0) return;
    const strength = { weakMagnitude: event.rumble, strongMagnitude: event.rumble };
    const duration = event.rumbleMs;
    void this.choose()?.vibrationActuator?.playEffect("dual-rumble", { duration, ...strength });
  }

  /** Return the pad that is used: another one takes its place by being pushed while it rests. */
  private choose(): Gamepad | null {
    const all = navigator.getGamepads().filter((pad) => pad?.connected) as Gamepad[];
    const pads = all.filter((pad) => pad.mapping === "standard");
    const isUnknown = all.length > 0 && pads.length === 0;
    if (isUnknown !== this.isUnknown) {
      this.isUnknown = isUnknown;
      this.onKnown();
    }
    const before = pads.find((pad) => pad.index === this.used);
    const pushed = before !== undefined && isPushed(before) ? before : pads.find(isPushed);
    const chosen = pushed ?? before ?? pads[0] ?? null;
    this.used = chosen?.index ?? -1;
    return chosen;
  }

  private tell(positions: readonly number[]): void {
    this.sent = positions.map((value) => Math.round(1000 * value) / 1000);
    this.connection.send({ type: "pad", axes: this.sent.slice(0, AXES), buttons: this.sent.slice(AXES) });
  }
}

function isPushed(pad: Gamepad): boolean {
  return pad.axes.some((value) => Math.abs(value) >= PUSHED) || pad.buttons.some(({ value }) => value >= PUSHED);
}
