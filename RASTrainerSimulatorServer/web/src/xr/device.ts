/** Names of headsets. */

import { MAX_DEVICE_TEXT } from "../generated";

/** Profiles of the controllers, where the browser itself does not say. */
const BY_PROFILE: Readonly<Record<string, string>> = {
  "meta-quest-touch-plus": "Meta Quest 3",
  "meta-quest-touch-pro": "Meta Quest Pro",
  "oculus-touch-v3": "Meta Quest 2",
  "oculus-touch-v2": "Oculus Quest or Rift S",
  "valve-index": "Valve Index",
  "htc-vive": "HTC Vive",
  "pico-4": "Pico 4",
};

export function headsetModel(session: XRSession, userAgent: string): string {
  const quest = /Quest (\d\w*|Pro)/.exec(userAgent);
  if (quest !== null) return `Meta ${quest[0]}`;
  const pico = /Pico [\w ]{1,20}/i.exec(userAgent);
  if (pico !== null) return pico[0].slice(0, MAX_DEVICE_TEXT);
  for (const source of session.inputSources) {
    for (const profile of source.profiles) {
      const known = BY_PROFILE[profile];
      if (known !== undefined) return known;
    }
  }
  return session.inputSources[0]?.profiles[0]?.slice(0, MAX_DEVICE_TEXT) ?? "";
}
