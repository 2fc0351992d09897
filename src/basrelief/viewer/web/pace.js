// How much is asked of the GPU at once, so that the page stays awake and what moves is seen to move.
//
// What counts is what the GPU does. Some browsers look only ten times a second whether it has done
// something (Firefox): what an answer takes where there was nothing to do is taken off, and frames
// there do not wait for one another.

/** @import { Pair } from "view/data" */

const SLOW = 33; // milliseconds that a frame may cost while something moves, and a part of one at rest
const COARSEST = 8; // times smaller that each side is at most while something moves
const SHOWN = 16; // milliseconds that a frame is shown for
const MOST = 8; // frames that may be on their way
const GROWTH = 4; // times more that is asked than the time before, at most

export class Pace {
  /**
   * `clocked` where the GPU tells how long it took: without, what one of several frames on their way
   * cost cannot be known.
   * @param {boolean} clocked
   */
  constructor(clocked) {
    this.clocked = clocked;
    this.latency = 0; // milliseconds of an answer to nothing
    this.speed = 1e-5; // milliseconds a pixel, as last seen
    this.flying = 0; // frames that are on their way
    this.cost = 0; // milliseconds of the last one
  }

  /**
   * Find out how long an answer takes: the first is to all that was asked before.
   * @param {GPUQueue} queue
   */
  async measureLatency(queue) {
    const answers = [];
    for (let k = 0; k < 4; k++) {
      const asked = performance.now();
      queue.submit([]);
      await queue.onSubmittedWorkDone();
      answers.push(performance.now() - asked);
    }
    this.latency = Math.min(...answers.slice(1));
  }

  /**
   * What the GPU worked, of the milliseconds that passed until it was known.
   * @param {number} passed
   */
  work(passed) {
    return Math.max(0, passed - this.latency);
  }

  /**
   * So many pixels cost so many milliseconds. Speed-ups are adopted gradually.
   * @param {number} cost
   * @param {number} pixels
   */
  note(cost, pixels) {
    this.cost = cost;
    this.speed = Math.max(Math.max(cost, 0.01) / pixels, this.speed / GROWTH);
  }

  // Whether another frame may be sent on its way.
  get free() {
    const more = this.clocked ? Math.floor(this.latency / Math.max(SHOWN, this.cost)) : 0;
    return this.flying < Math.min(MOST, 1 + more);
  }

  /**
   * The size of a frame while something moves.
   * @param {Pair} size
   * @returns {Pair}
   */
  moving(size) {
    const [width, height] = size;
    const wanted = Math.sqrt((this.speed * width * height) / SLOW);
    const coarse = wanted < 1.2 ? 1 : Math.min(COARSEST, wanted);
    return size.map((n) => Math.max(16, Math.round(n / coarse)));
  }

  /**
   * How many rows of a picture are drawn at once when nothing moves, a multiple of `apart`.
   * @param {number} width
   * @param {number} apart
   */
  rows(width, apart) {
    return Math.max(apart, Math.floor(SLOW / this.speed / width / apart) * apart);
  }
}
