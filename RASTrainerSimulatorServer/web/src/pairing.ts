/** Ask for the pairing code, and exchange it for the cookie that lets this browser in. */

import { say, type TextName } from "./texts";

/**
 * Return when the browser is paired. A code in the address, as `#code=123456`, is tried first.
 * `wasPaired`: whether it was until now.
 */
export async function pair(form: HTMLFormElement, wasPaired: boolean): Promise<void> {
  const given = /^#code=(\d{1,64})$/.exec(location.hash)?.[1];
  let wrong = wasPaired ? say("restarted") : "";
  if (given !== undefined) {
    history.replaceState(null, "", location.pathname);
    wrong = await send(given, "oldCode");
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
      complaint.value = await send(input.value.trim(), "wrongCode");
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
  form.querySelector("button")!.textContent = say("join");
}

/** Return what is wrong with a code, "" for nothing; `wrong` names the sentence about a wrong one. */
async function send(code: string, wrong: TextName): Promise<string> {
  try {
    const answer = await fetch("/pair", { method: "POST", body: JSON.stringify({ code }) });
    const seconds = answer.headers.get("Retry-After");
    if (answer.ok) return "";
    return seconds === null ? say(wrong) : say("newCode", { seconds });
  } catch {
    return say("lost");
  }
}
