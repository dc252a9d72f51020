/** Set texts as a language's typography asks, so that their tables are written with plain keys. */

const NARROW_SPACE = "\u202f";
const NO_BREAK_SPACE = "\u00a0";

type Texts = Readonly<Record<string, string>>;

/** Return the texts of each language as its typography asks. */
export function typeset<Table extends Texts>(tables: Record<"fr" | "zh", Table> & Record<string, Table>): Readonly<Record<string, Table>> {
  return { ...tables, fr: french(tables.fr), zh: chinese(tables.zh) };
}

/** Return French texts with narrow no-break spaces before and after signs of two parts. */
function french<Table extends Texts>(texts: Table): Table {
  return eachSet(texts, (text) => text.replace(/ ([:;!?%»])/g, `${NARROW_SPACE}$1`).replace(/« /g, `«${NARROW_SPACE}`));
}

/** Return Chinese texts with no-break spaces around numbers and inserted values. */
function chinese<Table extends Texts>(texts: Table): Table {
  return eachSet(texts, (text) => text.replace(/ (?=[\d{/])|(?<=[\d}/]) /g, NO_BREAK_SPACE));
}

/** Return a text in which no unit is on another line than its number: the simulator's texts come like this. */
export function withUnits(text: string): string {
  return text.replace(/(?<=\d) (?=[%/]|(?:mm|cm|s|min|MB)(?![\p{L}’']))|(?<=\d \/) (?=\d)/gu, NO_BREAK_SPACE);
}

/** Return the tag of the written language: Chinese of every region in simplified characters. */
export function writtenLanguage(tag: string): string {
  return /^zh\b/.test(tag) ? "zh-Hans" : tag;
}

function eachSet<Table extends Texts>(texts: Table, set: (text: string) => string): Table {
  return Object.fromEntries(Object.entries(texts).map(([name, text]) => [name, set(text)])) as Table;
}
