/** Signs of a trainee's standing in an assignment; the word next to each says the same. */

import type { AssignmentState } from "../generated";

const SVG = "http://www.w3.org/2000/svg";

/** Return a ring that fills up, a disk with a tick, or a padlock; `share` is of an open one, 0 to 1. */
export function standingMark(state: AssignmentState, share = 0): SVGSVGElement {
  const mark = part("svg", { viewBox: "0 0 16 16", "aria-hidden": "true" });
  mark.append(...PARTS[state](share));
  return mark as SVGSVGElement;
}

const line = { fill: "none", stroke: "currentColor", "stroke-width": "2" };

const PARTS: Readonly<Record<AssignmentState, (share: number) => SVGElement[]>> = {
  reached: () => [
    part("circle", { cx: "8", cy: "8", r: "7.5", fill: "currentColor" }),
    part("path", { ...line, d: "M4.5 8.5 7 11l4.5-5.5", class: "tick" }),
  ],
  open: (share) => [
    part("circle", { ...line, cx: "8", cy: "8", r: "6.5", opacity: "0.45" }),
    part("circle", {
      ...line,
      "stroke-width": "3",
      cx: "8",
      cy: "8",
      r: "6.5",
      pathLength: "100",
      "stroke-dasharray": `${100 * share} 100`,
      transform: "rotate(-90 8 8)",
    }),
  ],
  locked: () => [
    part("rect", { x: "2.5", y: "7", width: "11", height: "8", rx: "1.5", fill: "currentColor" }),
    part("path", { ...line, d: "M5 7V5a3 3 0 0 1 6 0v2" }),
  ],
};

function part(name: string, attributes: Readonly<Record<string, string>>): SVGElement {
  const made = document.createElementNS(SVG, name) as SVGElement;
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  return made;
}
