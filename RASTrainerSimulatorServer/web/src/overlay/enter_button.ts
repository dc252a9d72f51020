/** The button that leads into the headset, where there is one. */

import { byId } from "../elements";
import { say } from "../texts";

export class EnterButton {
  private readonly button = byId("headset") as HTMLButtonElement;
  private isPossible = false;
  private isInside = false;

  constructor(private readonly entered: (session: XRSession) => void) {
    this.button.onclick = () => void this.enter();
    navigator.xr?.addEventListener("devicechange", () => void this.look());
    void this.look();
  }

  /** Write on the button in the present language. */
  label(): void {
    const why = window.isSecureContext ? say("noHeadset") : say("insecure");
    this.button.textContent = this.isPossible ? say("enter") : why;
    this.button.disabled = !this.isPossible;
    this.button.hidden = this.isInside;
  }

  setInside(isInside: boolean): void {
    this.isInside = isInside;
    this.label();
  }

  private async look(): Promise<void> {
    const possible = await navigator.xr?.isSessionSupported("immersive-vr").catch(() => false);
    this.isPossible = possible ?? false;
    this.label();
  }

  private async enter(): Promise<void> {
    const options = { requiredFeatures: ["local-floor"], optionalFeatures: ["bounded-floor", "hand-tracking"] };
    const session = await navigator.xr?.requestSession("immersive-vr", options);
    if (session !== undefined) this.entered(session);
  }
}
