// The amount of work per submission to the GPU, so that the page stays responsive and motion smooth.
//
// Only the GPU's own time counts. Some browsers poll the GPU ten times a second (Firefox): the latency
// of an empty submission is subtracted, and several frames may be in flight there.

/** @import { Pair } from "view/data" */

const SLOW = 33; // milliseconds of a frame in motion, and of a block of rows at rest
const COARSEST = 8; // largest factor by which each side is reduced in motion
const SHOWN = 16; // milliseconds for which a frame is shown
const MOST = 8; // largest number of frames in flight
const GROWTH = 4; // largest factor by which a submission grows

export class Pace {
  /**
   * `clocked` if the GPU has timestamps; without, the cost of one of several frames in flight is
   * unknown.
   * @param {boolean} clocked
   */
  constructor(clocked) {
    this.clocked = clocked;
    this.latency = 0; // milliseconds of an empty submission
    this.speed = 1e-5; // milliseconds per pixel, as last measured
    this.flying = 0; // frames in flight
    this.cost = 0; // milliseconds of the last one
  }

  /**
   * Measure the latency of empty submissions; the first one waits for earlier work.
   * @param {GPUQueue} queue
   */
  async measureLatency(queue) {
    const answers = [];
    for (let k = 0; k < 4; k++) {
      const sent = performance.now();
      queue.submit([]);
      await queue.onSubmittedWorkDone();
      answers.push(performance.now() - sent);
    }
    this.latency = Math.min(...answers.slice(1));
  }

  /**
   * Milliseconds of the GPU's work, from those that passed until it was done.
   * @param {number} passed
   */
  work(passed) {
    return Math.max(0, passed - this.latency);
  }

  /**
   * Record the cost of pixels in milliseconds. Speed-ups are adopted gradually.
   * @param {number} cost
   * @param {number} pixels
   */
  note(cost, pixels) {
    this.cost = cost;
    this.speed = Math.max(Math.max(cost, 0.01) / pixels, this.speed / GROWTH);
  }

  // Whether another frame may be submitted.
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
   * The number of rows that are drawn at once at rest, a multiple of `apart`.
   * @param {number} width
   * @param {number} apart
   */
  rows(width, apart) {
    return Math.max(apart, Math.floor(SLOW / this.speed / width / apart) * apart);
  }
}
