/** The board's forms: a new seat, a PIN, a sentence, and whether to remove a seat. */

import { byId, element } from "../elements";
import { say, type BoardText } from "./texts";

export interface Field {
  name: string;
  label: BoardText;
  help?: BoardText;
  type?: "text" | "password";
  value?: string;
  maxLength: number;
}

export interface Form {
  title: string;
  fields?: readonly Field[];
  /** Running text, and text that is to be compared. */
  text?: string;
  fingerprint?: string;
  accept: BoardText;
}

/**
 * Ask in a dialog; return the entries, null for Cancel. `submit` may return a sentence on a problem,
 * which is shown while the dialog stays; "" closes it.
 */
export async function ask(
  form: Form,
  submit: (values: Record<string, string>) => Promise<string> = async () => "",
): Promise<Record<string, string> | null> {
  const dialog = byId("dialog") as HTMLDialogElement;
  const shown = dialog.querySelector("form")!;
  const complaint = element("output");
  const title = element("h2", form.title, { id: "dialog-title" });
  const accept = element("button", say(form.accept), { type: "submit" });
  const cancel = element("button", say("cancel"), { type: "button", className: "second" });
  const doings = element("div", "", { className: "doings" });
  doings.append(cancel, accept);
  const parts = (form.fields ?? []).flatMap(rows);
  const fingerprint = element("output", form.fingerprint, { className: "fingerprint" });
  shown.replaceChildren(title, element("p", form.text ?? ""), ...(form.fingerprint ? [fingerprint] : []), ...parts, complaint, doings);
  dialog.showModal();
  shown.querySelector("input")?.focus();
  const entered = await new Promise<Record<string, string> | null>((done) => {
    cancel.onclick = () => done(null);
    // The event comes later: a form that was opened meanwhile must not take it for its own.
    dialog.onclose = () => {
      if (!dialog.open) done(null);
    };
    shown.onsubmit = async (event) => {
      event.preventDefault();
      const values = Object.fromEntries([...new FormData(shown)].map(([name, value]) => [name, String(value).trim()]));
      accept.disabled = true;
      complaint.value = await submit(values);
      accept.disabled = false;
      if (complaint.value === "") done(values);
      else shown.querySelector("input")?.select();
    };
  });
  dialog.close();
  return entered;
}

function rows({ name, label, help, type, value, maxLength }: Field): HTMLElement[] {
  const id = `field-${name}`;
  const input = element("input", "", { id, name, type: type ?? "text", value: value ?? "", maxLength, autocomplete: "off", required: true });
  const shown = element("label", say(label), { htmlFor: id });
  if (help === undefined) return [shown, input];
  const words = element("p", say(help), { id: `${id}-help` });
  input.setAttribute("aria-describedby", words.id);
  return [shown, input, words];
}
