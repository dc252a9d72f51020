/** Small pictures in menus, such as of a head that can be chosen; each is loaded once. */

import { served } from "../stream/served";

const loaded = new Map<string, HTMLImageElement>();

/** Return a picture once it is there, null before; `whenThere` is called when it has come. */
export function thumbnail(url: string, whenThere: () => void): HTMLImageElement | null {
  if (url === "") return null;
  let image = loaded.get(url);
  if (image === undefined) {
    image = new Image();
    loaded.set(url, image);
    image.onload = whenThere;
    image.src = served(url);
  }
  return image.complete && image.naturalWidth > 0 ? image : null;
}
