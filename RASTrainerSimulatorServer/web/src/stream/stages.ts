/** A state's touch and procedure. */

import { TOUCH_ERRORS, type StateNews, type TouchStage } from "../generated";

/** Whether a touch goes wrong. */
export function isTouchError(stage: TouchStage): boolean {
  return (TOUCH_ERRORS as readonly TouchStage[]).includes(stage);
}

/** Whether a procedure is at one of its lines: the guide is aligned, or something is fed through it. */
export function hasGuide({ procedure }: StateNews): boolean {
  return procedure !== null && procedure.tool !== "pointer";
}
