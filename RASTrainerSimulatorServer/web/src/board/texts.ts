/** Texts and times on the teacher's board, in the language of the browser. */

import { useLanguage } from "../texts";

export { figure, holderName, sayOnBoard as say, type BoardText } from "../texts";

useLanguage(navigator.language.slice(0, 2));

/** Return a day, such as "Nov 26, 2026". */
export function date(when: Date): string {
  return when.toLocaleDateString(document.documentElement.lang, { dateStyle: "medium" });
}

/** Return a day with its time. */
export function moment(when: Date): string {
  return when.toLocaleString(document.documentElement.lang, { dateStyle: "medium", timeStyle: "medium" });
}

/** Return how long ago something was, such as "3 minutes ago". */
export function age(when: Date): string {
  const seconds = Math.max(0, Math.round((Date.now() - when.getTime()) / 1000));
  const [unit, length] = seconds < 60 ? (["second", 1] as const) : seconds < 3600 ? (["minute", 60] as const) : (["hour", 3600] as const);
  return new Intl.RelativeTimeFormat(document.documentElement.lang).format(-Math.floor(seconds / length), unit);
}
