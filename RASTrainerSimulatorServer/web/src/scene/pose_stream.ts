/** The bodies' poses between two messages, a little behind the simulator so that nothing jumps. */

import { Quaternion, type Object3D } from "three";

const SLOTS = 8;
const NUMBERS = 7;
/** Shown behind the newest state, in periods of the stream: late messages then do not show. */
const BEHIND = 1.5;
const FIRST_PERIOD_S = 1 / 60;
/** Simulated seconds beyond which the picture jumps instead of hurrying. */
const JUMP_PERIODS = 12;
const SMOOTHING = 0.05;
const CATCH_UP_PER_S = 4;

/**
 * Keeps the last states and plays them by a clock that follows the stream's. No
 * memory is allocated after the first state.
 */
export class PoseStream {
  private readonly times = new Float64Array(SLOTS);
  private readonly slots: Float32Array[];
  private count = 0;
  private period = FIRST_PERIOD_S;
  private speed = 1;
  private arrived = 0;
  private shown = 0;
  private looked = 0;

  constructor(private readonly bodies: number) {
    this.slots = Array.from({ length: SLOTS }, () => new Float32Array(NUMBERS * bodies));
  }

  /** Take the poses of a simulated time (s) that arrived at `now` (s). */
  put(time: number, poses: readonly (readonly number[])[], now: number): void {
    const newest = this.newest;
    if (this.count > 0 && time <= newest) {
      if (time === newest) return;
      this.count = 0;
    }
    if (this.count > 0) {
      const passed = Math.max(1e-3, now - this.arrived);
      this.period += SMOOTHING * (time - newest - this.period);
      this.speed += SMOOTHING * ((time - newest) / passed - this.speed);
    }
    const slot = this.count % SLOTS;
    const target = this.slots[slot]!;
    for (let body = 0; body < this.bodies; body++) {
      const pose = poses[body]!;
      for (let index = 0; index < NUMBERS; index++) target[NUMBERS * body + index] = pose[index]!;
    }
    this.times[slot] = time;
    if (this.count === 0) {
      this.shown = time;
      this.looked = now;
    }
    this.count++;
    this.arrived = now;
  }

  /** Place each body's object as it is to be seen at `now` (s). */
  place(objects: readonly (Object3D | undefined)[], now: number): void {
    if (this.count === 0) return;
    const time = this.play(now);
    let later = this.count - 1;
    const oldest = Math.max(0, this.count - SLOTS);
    while (later > oldest && this.times[(later - 1) % SLOTS]! >= time) later--;
    const earlier = Math.max(oldest, later - 1);
    const begin = this.times[earlier % SLOTS]!;
    const end = this.times[later % SLOTS]!;
    const share = end > begin ? Math.min(1, Math.max(0, (time - begin) / (end - begin))) : 1;
    this.blend(objects, this.slots[earlier % SLOTS]!, this.slots[later % SLOTS]!, share);
  }

  private get newest(): number {
    return this.times[(this.count - 1) % SLOTS]!;
  }

  /** Advance the clock to `now` and return its time. */
  private play(now: number): number {
    const passed = Math.max(0, now - this.looked);
    this.looked = now;
    this.shown += passed * this.speed;
    const wanted = this.newest + (now - this.arrived) * this.speed - BEHIND * this.period;
    const late = wanted - this.shown;
    if (Math.abs(late) > JUMP_PERIODS * this.period) this.shown = wanted;
    else this.shown += late * Math.min(1, CATCH_UP_PER_S * passed);
    return this.shown;
  }

  private blend(
    objects: readonly (Object3D | undefined)[],
    from: Float32Array,
    to: Float32Array,
    share: number,
  ): void {
    for (let body = 0; body < this.bodies; body++) {
      const object = objects[body];
      if (object === undefined) continue;
      const at = NUMBERS * body;
      object.position.set(
        from[at]! + share * (to[at]! - from[at]!),
        from[at + 1]! + share * (to[at + 1]! - from[at + 1]!),
        from[at + 2]! + share * (to[at + 2]! - from[at + 2]!),
      );
      Quaternion.slerpFlat(turn, 0, from as never, at + 3, to as never, at + 3, share);
      object.quaternion.fromArray(turn);
    }
  }
}

const turn: number[] = [0, 0, 0, 1];
