/** Where a line may end: at spaces, and between Chinese characters. */

const WIDE = "\\u2e80-\\u9fff\\uf900-\\ufaff\\uff00-\\uffef";
const BEGINS_NO_LINE = "\\s。，、；：？！）”」》…—%°,.;:?!)";
const ENDS_NO_LINE = "\\s（“「《(";
const AT_A_CHARACTER = `(?<=[${WIDE}])|(?=[${WIDE}])`;
const BEFORE_THE_LAST = `[${WIDE}][${BEGINS_NO_LINE}]*$`;
const BREAK = new RegExp(`(?<![${ENDS_NO_LINE}])(?:${AT_A_CHARACTER})(?![${BEGINS_NO_LINE}]|${BEFORE_THE_LAST})`);

export interface Piece {
  /** Between it and the piece before: a space, or nothing between Chinese characters. */
  readonly between: string;
  readonly text: string;
}

/** Return what no line may break; no Chinese character is left alone on the last line. */
export function pieces(text: string): Piece[] {
  return text.split(" ").flatMap((word) =>
    word.split(BREAK).filter((piece) => piece !== "").map((piece, index) => ({ between: index === 0 ? " " : "", text: piece })),
  );
}
