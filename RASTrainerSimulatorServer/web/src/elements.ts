/** Short ways to the page's elements. */

export function byId(id: string): HTMLElement {
  return document.getElementById(id)!;
}

/** Return a new element with a text, and properties such as its class. */
export function element<Tag extends keyof HTMLElementTagNameMap>(
  tag: Tag,
  text = "",
  properties: Partial<HTMLElementTagNameMap[Tag]> = {},
): HTMLElementTagNameMap[Tag] {
  const made = document.createElement(tag);
  made.textContent = text;
  return Object.assign(made, properties);
}
