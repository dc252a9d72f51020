/** Set texts as a language's typography asks, so that their tables are written with plain keys. */

const NARROW_SPACE = "\u202f";

/** Return French texts with narrow no-break spaces beside signs of two parts. */
export function french<Texts extends Readonly<Record<string, string>>>(texts: Texts): Texts {
  const set = Object.entries(texts).map(([name, text]) => [
    name,
    text.replace(/ ([:;!?%»])/g, `${NARROW_SPACE}$1`).replace(/« /g, `«${NARROW_SPACE}`),
  ]);
  return Object.fromEntries(set);
}
