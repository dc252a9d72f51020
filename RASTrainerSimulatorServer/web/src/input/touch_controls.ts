/** Two sticks, and the buttons of a trial: on a touch screen from the first touch on, by mouse on request. */

import type { Connection } from "../stream/connection";
import { byId, element } from "../elements";
import type { ControlNews, Screen, StateNews } from "../generated";
import { say } from "../texts";
import { TouchStick } from "./touch_stick";

/** Control that a button presses, by the simulator's name. */
const CONTROLS = ["menu", "best_view", "camera", "undo", "touch"] as const;
type TouchControl = (typeof CONTROLS)[number];

export class TouchControls {
  private readonly parent = byId("touch-controls");
  private readonly left = new TouchStick(() => this.tell());
  private readonly right = new TouchStick(() => this.tell());
  private readonly fine = this.toggle();
  /** Has the right stick tilt the guide in place of lifting and lowering it. */
  private readonly tilt = this.toggle();
  private readonly buttons = new Map<TouchControl, HTMLButtonElement>();
  private isUsed = matchMedia("(pointer: coarse)").matches;
  private isWorking = false;
  /** Whether the sticks alone are wanted: what a mouse clicks is among the hints. */
  private isForMouse = false;
  private hasControl = false;

  constructor(private readonly connection: Connection) {
    const row = element("div");
    for (const control of CONTROLS) this.buttons.set(control, this.button(control));
    const touch = this.buttons.get("touch")!;
    row.append(...[...this.buttons.values()].filter((button) => button !== touch), this.fine, this.tilt);
    this.tilt.dataset.toggle = "tilt";
    this.tilt.hidden = true;
    this.parent.append(row, this.left.place, touch, this.right.place);
    window.addEventListener("pointerdown", (event) => {
      if (event.pointerType === "touch") this.use();
    }, true);
    window.addEventListener("blur", () => this.release());
    if (this.isUsed) document.body.dataset.touch = "";
  }

  get isHolding(): boolean {
    return this.left.x !== 0 || this.left.y !== 0 || this.right.x !== 0 || this.right.y !== 0;
  }

  show(screen: Screen): void {
    // A screen that can be left, such as a replay, is only watched: its buttons are among the hints.
    this.isWorking = screen.menu === null && !screen.hints.some((hint) => hint.item === "back");
    this.isForMouse = screen.hasSticks;
    if (!this.isWorking) this.release();
    for (const [control, button] of this.buttons) button.textContent = say(`touch.${control}`);
    this.fine.textContent = say("touch.fine");
    this.tilt.textContent = say("touch.tilt");
    this.left.label(say("touch.left"));
    this.labelRight();
    this.place();
  }

  /** Offer to tilt the guide where one is aligned. */
  takeState({ procedure }: StateNews): void {
    const isOffered = procedure?.aim != null;
    if (isOffered !== this.tilt.hidden) return;
    this.tilt.hidden = !isOffered;
    if (!isOffered) this.tilt.ariaPressed = "false";
    this.labelRight();
  }

  takeControl(control: ControlNews): void {
    this.hasControl = control.isYou;
    this.place();
  }

  release(): void {
    this.left.release();
    this.right.release();
  }

  /** Return a button that is switched on and off. */
  private toggle(): HTMLButtonElement {
    const button = element("button", "", { type: "button", ariaPressed: "false" });
    button.onclick = () => {
      button.ariaPressed = String(!isOn(button));
      this.labelRight();
      this.tell();
    };
    return button;
  }

  private labelRight(): void {
    this.right.label(say(isOn(this.tilt) ? "touch.tilting" : "touch.right"));
  }

  /** Report the use of a touch screen, before the touch itself is sent. */
  private use(): void {
    if (!this.isHolding) this.tell();
    if (this.isUsed) return;
    this.isUsed = true;
    document.body.dataset.touch = "";
    this.place();
  }

  private place(): void {
    const isAsked = this.isUsed || (this.isForMouse && this.hasControl);
    if (!isAsked) this.release();
    this.parent.hidden = !isAsked || !this.isWorking;
  }

  private button(control: TouchControl): HTMLButtonElement {
    const button = element("button", "", { type: "button" });
    button.dataset.control = control;
    // At once, not when the finger leaves: the tip is where it is now.
    button.onpointerdown = () => this.connection.send({ type: "press", control });
    button.onclick = (event) => {
      const isByKey = event.detail === 0;
      if (isByKey) this.connection.send({ type: "press", control });
    };
    return button;
  }

  private tell(): void {
    const [up, tilt] = isOn(this.tilt) ? [0, this.right.y] : [this.right.y, 0];
    const translation = [this.left.x, this.left.y, up] as const;
    const fine = isOn(this.fine) && this.isHolding;
    this.connection.send({ type: "sticks", translation, rotation: [this.right.x, tilt], fine, yawDeg: 0 });
  }
}

function isOn(button: HTMLButtonElement): boolean {
  return button.ariaPressed === "true";
}
