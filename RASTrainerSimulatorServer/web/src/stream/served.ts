/** Addresses of the simulator's files, next to the page, which a teacher's board serves in a folder of each seat. */

/** Return the address of a file that the simulator names by its path, such as "/scene/….glb". */
export function served(path: string): string {
  return new URL(path.replace(/^\//, ""), document.baseURI).href;
}

/** Return the address of a stream next to the page. */
export function streamUrl(name: string): string {
  return served(name).replace(/^http/, "ws");
}

/** Whether the page is a board's view of a seat: there, nobody can take part. */
export function isOnBoard(): boolean {
  return location.pathname.startsWith("/seat/");
}
