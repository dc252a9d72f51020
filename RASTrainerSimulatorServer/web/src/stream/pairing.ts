/** Ask for the pairing code, and exchange it for the cookie that lets this browser in. */

import type { ViewRole } from "../generated";
import { say, type TextName } from "../texts";

/**
 * Return when the browser is paired. A code in the address, as `#code=123456`, is tried first; with
 * `&role=spectator` after it, to watch only. `wasPaired`: whether it was until now.
 */
export async function pair(form: HTMLFormElement, wasPaired: boolean): Promise<void> {
  const [, given, role] = /^#code=(\d{1,64})(?:&role=(spectator))?$/.exec(location.hash) ?? [];
  let wrong = wasPaired ? say("restarted") : "";
  if (given !== undefined) {
    history.replaceState(null, "", location.pathname + location.search);
    wrong = await send(given, (role ?? "view") as ViewRole, "oldCode");
    if (wrong === "") return;
  }
  const input = form.querySelector("input")!;
  const complaint = form.querySelector("output")!;
  label(form);
  form.hidden = false;
  complaint.value = wrong;
  input.value = "";
  input.focus();
  await new Promise<void>((done) => {
    form.onsubmit = async (event) => {
      event.preventDefault();
      const role = (event.submitter as HTMLButtonElement | null)?.value === "spectator" ? "spectator" : "view";
      complaint.value = await send(input.value.trim(), role, "wrongCode");
      if (complaint.value === "") done();
      else input.select();
    };
  });
  form.hidden = true;
}

function label(form: HTMLFormElement): void {
  form.querySelector("h2")!.textContent = say("pair");
  form.querySelector("label")!.textContent = say("code");
  form.querySelector("p")!.textContent = say("codeHelp");
  const [join, watch] = form.querySelectorAll("button");
  join!.textContent = say("join");
  watch!.textContent = say("watch");
}

/** Return what is wrong with a code, "" for nothing; `wrong` names the sentence about a wrong one. */
async function send(code: string, role: ViewRole, wrong: TextName): Promise<string> {
  const refusal = await exchangeCode(code, role);
  if (refusal === null) return "";
  const { problem, seconds } = refusal;
  return problem === "wrong" ? say(wrong) : say(problem === "away" ? "lost" : "newCode", { seconds });
}

/** Why a code was not taken; `seconds` until the next may be tried, "" where there is no pause. */
export interface CodeRefusal {
  problem: "wrong" | "tooMany" | "away";
  seconds: string;
}

/** Exchange a code for the cookie; null where that has worked. */
export async function exchangeCode(code: string, role: ViewRole): Promise<CodeRefusal | null> {
  try {
    const answer = await fetch("pair", { method: "POST", body: JSON.stringify({ code, role }) });
    if (answer.ok) return null;
    const seconds = answer.headers.get("Retry-After");
    return { problem: seconds === null ? "wrong" : "tooMany", seconds: seconds ?? "" };
  } catch {
    return { problem: "away", seconds: "" };
  }
}
