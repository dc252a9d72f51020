/** Ask for the pairing code, and exchange it for the cookie that lets this browser in. */

import type { ViewRole } from "../generated";

/** Sentences that page and board have each for themselves. */
type Sentence = "pair" | "code" | "codeHelp" | "join" | "oldCode" | "wrongCode" | "newCode" | "lost";
type Say = (name: Sentence, values?: Readonly<Record<string, string>>) => string;

const GIVEN = /^#code=(\d{1,64})(?:&role=(spectator))?$/;

/** Whether a code is in the address, such as `#code=123456`, or with `&role=spectator`, to watch only. */
export function isCodeGiven(): boolean {
  return GIVEN.test(location.hash);
}

/**
 * Return when the browser is paired: by the code in the address, which is tried first, or by a typed
 * code. `complaint` is shown until then; `watch` labels the button of people who only watch.
 */
export async function pair(form: HTMLFormElement, say: Say, complaint = "", watch = ""): Promise<void> {
  const [, given, role] = GIVEN.exec(location.hash) ?? [];
  let wrong = complaint;
  if (given !== undefined) {
    history.replaceState(null, "", location.pathname + location.search);
    wrong = await send(say, given, (role ?? "view") as ViewRole, "oldCode");
    if (wrong === "") return;
  }
  const input = form.querySelector("input")!;
  const output = form.querySelector("output")!;
  const texts = { h2: say("pair"), label: say("code"), p: say("codeHelp"), button: say("join"), "button.second": watch };
  for (const [selector, text] of Object.entries(texts)) {
    const part = form.querySelector(selector);
    if (part !== null) part.textContent = text;
  }
  form.hidden = false;
  output.value = wrong;
  input.value = "";
  input.focus();
  await new Promise<void>((done) => {
    form.onsubmit = async (event) => {
      event.preventDefault();
      const role = (event.submitter as HTMLButtonElement | null)?.value === "spectator" ? "spectator" : "view";
      output.value = await send(say, input.value.trim(), role, "wrongCode");
      if (output.value === "") done();
      else input.select();
    };
  });
  form.hidden = true;
}

/** Return the fault of a code, or ""; `wrong` is the key of the sentence about a wrong code. */
async function send(say: Say, code: string, role: ViewRole, wrong: Sentence): Promise<string> {
  try {
    const answer = await fetch("pair", { method: "POST", body: JSON.stringify({ code, role }) });
    if (answer.ok) return "";
    const seconds = answer.headers.get("Retry-After");
    return seconds === null ? say(wrong) : say("newCode", { seconds });
  } catch {
    return say("lost");
  }
}
