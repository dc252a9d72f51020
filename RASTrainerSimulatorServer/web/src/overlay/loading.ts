/** How far the scene has come, in megabytes. */

import { byId, element } from "../elements";
import { figure, say } from "../texts";

const MB = 1e6;

export class Loading {
  private readonly place = byId("loading");
  private readonly text = element("span");
  private readonly bar = element("progress");

  constructor() {
    this.place.append(this.text, this.bar);
  }

  /** Show the number of loaded bytes of `total`, which is 0 if unknown. */
  show(loaded: number, total: number): void {
    this.place.hidden = false;
    const known = { loaded: figure(loaded / MB), total: figure(total / MB) };
    this.text.textContent = total > 0 ? say("loading", known) : say("loadingSome", known);
    this.bar.setAttribute("aria-label", say("scene"));
    if (total > 0) {
      this.bar.max = total;
      this.bar.value = loaded;
    } else {
      this.bar.removeAttribute("value");
    }
  }

  hide(): void {
    this.place.hidden = true;
  }
}
