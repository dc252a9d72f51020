/** Parts of the simulator's screen as elements, for the flat page and for the headset's panels. */

import { element } from "../elements";
import type { Hint, ScreenMessage } from "../generated";

/** Return a message as a line of a list, or fill another element with it. */
export function message({ text, tone }: ScreenMessage, into: HTMLElement = element("li")): HTMLElement {
  into.textContent = text;
  into.dataset.tone = tone;
  return into;
}

/** Return a hint: a button if it does something when it is chosen. */
export function hintLine(hint: Hint, choose: (item: string) => void): HTMLElement {
  const line = element("li");
  const place = hint.item === "" ? line : line.appendChild(element("button"));
  place.append(element("kbd", hint.control));
  // Its own text is not repeated.
  if (hint.action !== hint.control) place.append(element("span", hint.action));
  if (hint.item === "") return line;
  place.dataset.item = hint.item;
  // At once, not when the button is let go: the tip is where it is now.
  place.onpointerdown = (event) => {
    if (event.button === 0) choose(hint.item);
  };
  place.onclick = (event) => {
    const isByKey = event.detail === 0;
    if (isByKey) choose(hint.item);
  };
  return line;
}

/** Return short facts as lines, and the legend of the paint on the skin if there is one. */
export function factLines(facts: readonly string[], coverage: string): HTMLElement[] {
  const lines = facts.map((fact) => element("li", fact));
  if (coverage === "") return lines;
  const legend = element("li", "", { className: "legend" });
  legend.append(element("i"), coverage);
  return [...lines, legend];
}
