/** The gamepads that the browser reads, in the W3C's standard layout. */

import type { Connection } from "../stream/connection";
import type { ControlNews, Feedback } from "../generated";

const AXES = 4;
const BUTTONS = 17;
const START = 9;
const CHANGE = 0.004;
/** As far as released sticks may rest from their middle. */
const AT_REST = 0.15;
/** A pad that is pushed this far replaces an idle pad. */
const PUSHED = 0.5;

export class Gamepads {
  private readonly axes = new Array<number>(AXES).fill(0);
  private readonly buttons = new Array<number>(BUTTONS).fill(0);
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
      if (this.isHolding) this.tellRest();
      return;
    }
    // A gamepad at this very computer is read by the simulator too: one of both is enough.
    const isReadThere = this.control?.holder === "gamepad" && !this.control.isYou;
    if (isReadThere && !this.isHolding && !(pad.buttons[START]?.pressed ?? false)) return;
    if (!this.take(pad)) return;
    this.connection.send({ type: "pad", axes: this.axes, buttons: this.buttons });
  }

  /** Release everything: nobody sees what the pad does. */
  release(): void {
    if (this.isHolding) this.tellRest();
  }

  /** Vibrate, if this pad is what drives the arm. */
  feel(event: Feedback): void {
    const drives = this.control?.isYou && this.control.holder === "browser's gamepad";
    if (!drives || event.rumble <= 0) return;
    const strength = { weakMagnitude: event.rumble, strongMagnitude: event.rumble };
    const duration = event.rumbleMs;
    void this.choose()?.vibrationActuator?.playEffect("dual-rumble", { duration, ...strength });
  }

  /** Take the positions; return whether they differ from those that were sent. */
  private take(pad: Gamepad): boolean {
    let differs = false;
    this.isHolding = false;
    for (let index = 0; index < AXES; index++) {
      const value = pad.axes[index] ?? 0;
      differs = differs || Math.abs(value - this.axes[index]!) > CHANGE;
      this.isHolding = this.isHolding || Math.abs(value) > AT_REST;
    }
    for (let index = 0; index < BUTTONS; index++) {
      const value = pad.buttons[index]?.value ?? 0;
      differs = differs || Math.abs(value - this.buttons[index]!) > CHANGE;
      this.isHolding = this.isHolding || value > AT_REST;
    }
    if (!differs) return false;
    for (let index = 0; index < AXES; index++) this.axes[index] = rounded(pad.axes[index] ?? 0);
    for (let index = 0; index < BUTTONS; index++) {
      this.buttons[index] = rounded(pad.buttons[index]?.value ?? 0);
    }
    return true;
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

  private tellRest(): void {
    this.axes.fill(0);
    this.buttons.fill(0);
    this.isHolding = false;
    this.connection.send({ type: "pad", axes: this.axes, buttons: this.buttons });
  }
}

function isPushed(pad: Gamepad): boolean {
  return pad.axes.some((value) => Math.abs(value) >= PUSHED) || pad.buttons.some(({ value }) => value >= PUSHED);
}

function rounded(value: number): number {
  return Math.round(1000 * value) / 1000;
}
