/** The page of somebody who only watches: the simulator takes nothing from it, and the page says so. */

import { byId } from "../elements";
import type { Hello, Screen } from "../generated";
import { isOnBoard } from "../stream/served";
import { say } from "../texts";

export const SPECTATOR: Hello = { type: "hello", kind: "spectator", device: "", refreshHz: 0 };
/** In the address, asks for the pairing form though this browser is paired. */
const AGAIN = "#pair";

/** Return a screen as it is read by somebody who cannot choose anything in it. */
export function onlyRead(screen: Screen): Screen {
  const { menu } = screen;
  return {
    ...screen,
    menu: menu && { ...menu, items: menu.items.map((item) => ({ ...item, isEnabled: false })) },
    hints: screen.hints.map((hint) => ({ ...hint, item: "" })),
    isSpoken: false,
    hasSticks: false,
  };
}

/** Whether the pairing form was asked for; it is asked for once. */
export function isPairedAgain(): boolean {
  const isAsked = location.hash === AGAIN;
  if (isAsked) history.replaceState(null, "", location.pathname);
  return isAsked;
}

/** Say that this page only watches, and offer to pair it anew. */
export function showWatching(isWatching: boolean): void {
  const button = byId("take-part") as HTMLButtonElement;
  document.body.toggleAttribute("data-watching", isWatching);
  button.hidden = !isWatching || isOnBoard();
  button.textContent = say("takePart");
  button.onclick = () => {
    history.replaceState(null, "", AGAIN);
    location.reload();
  };
}
