/** Ask for the pairing code, and exchange it for the cookie that lets this browser in. */

import { say } from "./texts";

/** Return when the browser is paired. A code in the address, as `#code=123456`, is tried first. */
export async function pair(form: HTMLFormElement): Promise<void> {
  const given = /^#code=(\d{1,64})$/.exec(location.hash)?.[1];
  if (given !== undefined) {
    history.replaceState(null, "", location.pathname);
    if ((await send(given)) === "") return;
  }
  const input = form.querySelector("input")!;
  const complaint = form.querySelector("output")!;
  label(form);
  form.hidden = false;
  input.focus();
  await new Promise<void>((done) => {
    form.onsubmit = async (event) => {
      event.preventDefault();
      const wrong = await send(input.value.trim());
      complaint.value = wrong;
      if (wrong === "") done();
      else input.select();
    };
  });
  form.hidden = true;
}

function label(form: HTMLFormElement): void {
  form.querySelector("h1")!.textContent = say("pair");
  form.querySelector("label")!.textContent = say("code");
  form.querySelector("p")!.textContent = say("codeHelp");
  form.querySelector("button")!.textContent = say("join");
}

/** Return what is wrong with a code, "" for nothing. */
async function send(code: string): Promise<string> {
  try {
    const answer = await fetch("/pair", { method: "POST", body: JSON.stringify({ code }) });
    return answer.ok ? "" : await answer.text();
  } catch {
    return say("lost");
  }
}
