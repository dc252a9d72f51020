/** The simulator's sounds; in the headset they come from where they belong. */

import { Vector3 } from "three";

const NAMES = [
  "touch", "proximity", "contact", "on-skin", "error", "finish", "undo", "focus", "accept",
] as const;
/** These come from the tool's tip, all others from everywhere. */
const AT_THE_TIP = new Set(["touch", "proximity", "contact", "on-skin", "undo", "error"]);

export class Sounds {
  private readonly context = new AudioContext({ latencyHint: "interactive" });
  private readonly buffers = new Map<string, AudioBuffer>();
  private isSpatial = false;
  private readonly place = new Vector3();

  constructor() {
    // Browsers are silent until the user does something.
    for (const kind of ["pointerdown", "keydown"]) {
      window.addEventListener(kind, () => this.unlock());
    }
  }

  async load(): Promise<void> {
    await Promise.all(NAMES.map((name) => this.loadOne(name)));
  }

  unlock(): void {
    if (this.context.state === "suspended") void this.context.resume();
  }

  /** Let sounds come from the tip of the tool, or from everywhere. */
  setSpatial(isSpatial: boolean): void {
    this.isSpatial = isSpatial;
  }

  /** Tell where the ears and the tool's tip are. */
  locate(ears: Vector3, forward: Vector3, up: Vector3, tip: Vector3): void {
    this.place.copy(tip);
    const { listener } = this.context;
    if (listener.positionX === undefined) {
      listener.setPosition(ears.x, ears.y, ears.z);
      listener.setOrientation(forward.x, forward.y, forward.z, up.x, up.y, up.z);
      return;
    }
    listener.positionX.value = ears.x;
    listener.positionY.value = ears.y;
    listener.positionZ.value = ears.z;
    listener.forwardX.value = forward.x;
    listener.forwardY.value = forward.y;
    listener.forwardZ.value = forward.z;
    listener.upX.value = up.x;
    listener.upY.value = up.y;
    listener.upZ.value = up.z;
  }

  play(name: string, volume: number): void {
    const buffer = this.buffers.get(name);
    if (buffer === undefined || volume <= 0) return;
    const source = new AudioBufferSourceNode(this.context, { buffer });
    const gain = new GainNode(this.context, { gain: volume });
    source.connect(gain);
    if (this.isSpatial && AT_THE_TIP.has(name)) gain.connect(this.atTip());
    else gain.connect(this.context.destination);
    source.start();
  }

  private atTip(): AudioNode {
    const panner = new PannerNode(this.context, {
      panningModel: "HRTF",
      positionX: this.place.x,
      positionY: this.place.y,
      positionZ: this.place.z,
      refDistance: 0.8,
      rolloffFactor: 0.6,
    });
    panner.connect(this.context.destination);
    return panner;
  }

  private async loadOne(name: string): Promise<void> {
    const answer = await fetch(`sounds/${name}.wav`);
    if (!answer.ok) return;
    this.buffers.set(name, await this.context.decodeAudioData(await answer.arrayBuffer()));
  }
}
