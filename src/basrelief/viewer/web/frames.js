// The frames: when the programs of a drawing run, how fine, and what is told of it.
//
// While something moves, whole frames are drawn, smaller where one is slow. At rest the places in each
// pixel are gone through, row by row, so that the page stays awake.

import { Colors } from "view/colors.js";
import { rowsApart } from "view/gpu.js";
import { Pace } from "view/pace.js";
import { firstLine } from "view/text.js";

/** @import { Pair } from "view/data" */
/** @import { Figures, PictureView, SideBuffers } from "view/colors.js" */
/** @import { State } from "view/state.js" */
/** @import { Drawing, Shown, Side, SideName } from "view/drawing.js" */

/**
 * A frame in flight.
 * @typedef {object} MovingFrame
 * @property {number} began milliseconds
 * @property {Pair} size
 * @property {boolean} full whether it has the size of the canvas
 * @property {boolean} fresh whether one of its programs had drawn nothing before
 * @property {string} measured the key of its figures
 * @property {boolean} alone whether no other frame was in flight
 * @property {boolean} timed whether its programs write timestamps
 */
/** @typedef {MovingFrame & { work: number }} LandedFrame */

export const REST = 150; // milliseconds after which nothing moves any more
const PLANES = 9;

export class Frames {
  /**
   * Of a drawing, which says what is shown and what its programs are given.
   * @param {Drawing} drawing
   * @param {HTMLCanvasElement} canvas
   */
  constructor(drawing, canvas) {
    const { gpu, data } = drawing;
    this.drawing = drawing;
    this.canvas = canvas;
    this.gpu = gpu;
    this.colors = new Colors(gpu, canvas, data.colors);
    this.pace = new Pace(Boolean(gpu.stamps));
    /** @type {{ [side in SideName]?: SideBuffers & { area: number } }} */
    this.sides = {}; // buffers, by where they are shown
    this.limit = data.samples.length;
    this.count = 0; // frames that were drawn while something moved
    this.dirty = false;
    this.done = 0; // samples of the picture at rest
    this.row = 0; // and rows of the next one
    this.fresh = false; // whether a program has drawn nothing yet
    this.reporting = false; // whether something is read back of a frame, while others may be drawn
    /** @type {LandedFrame | null} */
    this.unreported = null; // the frame that it is to be read of next
    this.timing = false; // whether the GPU's clock is not read yet
    this.asked = false; // whether an animation frame is requested
    this.running = false; // whether a part of the picture at rest is being drawn
    this.movedAt = -Infinity;
    /** @type {Pair} */
    this.drawnSize = [0, 0]; // of the picture that is drawn
    this.drawn = 0; // and its samples
    /** @type {[milliseconds: number, gpuMilliseconds: number | null]} */
    this.spent = [0, 0]; // on the next sample
    /** @type {Figures | undefined} */
    this.found = undefined; // of both sides
  }

  get shown() {
    return this.drawing.shown;
  }

  // Whether anything is left to be drawn or told.
  get busy() {
    return this.running || this.dirty || this.done < this.limit || !this.still;
  }

  // Something changed: draw anew with the next frame.
  touched() {
    this.dirty = true;
    this.movedAt = performance.now();
    this.wake();
  }

  wake() {
    if (this.asked || this.drawing.held) return;
    this.asked = true;
    requestAnimationFrame(() => {
      this.asked = false;
      this.tick();
    });
  }

  /** @returns {Pair} */
  get size() {
    return [this.canvas.width, this.canvas.height];
  }

  // Buffers for a picture of the canvas's size, on each side.
  room() {
    const area = this.canvas.width * this.canvas.height;
    const names = /** @type {const} */ (["left", "right", "truth", "right_truth"]);
    for (const name of names) {
      const needed = this.shown?.[name] || name === "left" ? area : 1;
      const held = this.sides[name];
      if (held && held.area >= needed && held.area <= Math.max(4 * needed, 64)) continue;
      for (const each of [held?.planes, held?.sum, held?.missed]) each?.destroy();
      this.sides[name] = {
        area: needed,
        planes: this.gpu.planes(PLANES, needed, 1),
        sum: this.gpu.planes(4, needed, 1),
        missed: this.gpu.planes(2, needed, 1),
      };
    }
  }

  async tick() {
    if (this.running || !this.shown || this.drawing.held) return;
    try {
      if (this.dirty) {
        if (this.pace.free) this.movingFrame();
      } else if (this.done < this.limit && this.still) {
        this.running = true;
        await this.finer();
      }
    } catch (error) {
      this.failed(error);
      this.done = this.limit;
    } finally {
      this.running = false;
    }
    this.goOn();
  }

  // Frames that are on their way come here when they have landed.
  goOn() {
    if (this.dirty ? this.pace.free : this.done < this.limit && this.still) this.wake();
  }

  // Whether nothing is on its way, to the GPU or back.
  get still() {
    return !this.pace.flying && !this.reporting;
  }

  movingFrame() {
    const { pace, fresh } = this;
    const size = pace.moving(this.size);
    const full = size[0] === this.size[0] && size[1] === this.size[1];
    this.dirty = false;
    this.room();
    const { measured } = this.drawing;
    const began = performance.now();
    const timed = this.sample(size, 0, 0, size[1]);
    /** @type {MovingFrame} */
    const frame = { began, size, full, fresh, measured, alone: !pace.flying, timed };
    this.complete(size, 0);
    this.fresh = false;
    this.count += 1;
    this.done = full ? 1 : 0;
    this.row = 0;
    this.spent = [0, 0];
    pace.flying += 1;
    const land = () => this.landed(frame);
    this.gpu.device.queue.onSubmittedWorkDone().then(land, land);
  }

  /** @param {MovingFrame} frame */
  landed(frame) {
    const { pace } = this;
    pace.flying -= 1;
    if (!this.shown || this.drawing.held) {
      if (frame.timed) this.timing = false;
      return;
    }
    this.report({ ...frame, work: pace.work(performance.now() - frame.began) });
    this.goOn();
  }

  /**
   * Tell of a frame what has to be read back. The next do not wait for that, and of those that come
   * meanwhile only the last is told of.
   * @param {LandedFrame} frame
   */
  async report(frame) {
    if (this.unreported?.timed) this.timing = false;
    this.unreported = frame;
    if (this.reporting) return;
    this.reporting = true;
    try {
      while (this.unreported) await this.read(this.unreported);
    } catch (error) {
      this.unreported = null;
      this.timing = false;
      this.failed(error);
    } finally {
      this.reporting = false;
    }
    this.goOn();
  }

  /**
   * That a device is lost is told by itself.
   * @param {unknown} error
   */
  failed(error) {
    const lost = error instanceof Error && error.name === "AbortError";
    if (!lost) this.drawing.heard({ error: firstLine(error) });
  }

  /** @param {LandedFrame} frame */
  async read({ size, work, timed, full, alone, fresh, measured }) {
    this.unreported = null;
    const clock = timed ? await this.stamped() : null;
    // by the GPU's own clock where it has one: it alone knows what one of several took
    if (this.gpu.stamps ? timed : alone) {
      const milliseconds = Math.max(alone ? work : 0, clock ?? 0);
      // the first of a program says how long its driver makes ready, and nothing of the next
      if (!fresh) this.pace.note(milliseconds, size[0] * size[1]);
      this.drawing.heard({ milliseconds, gpuMilliseconds: clock, timedAt: size });
    }
    this.drawing.heard({ size, samples: full ? 1 : 0 });
    if (full && this.shown && measured === this.drawing.measured) await this.figures();
  }

  // A part of the next sample, as many rows as fit a frame's time.
  async finer() {
    if (performance.now() - this.movedAt < REST) return;
    const { size, pace } = this;
    this.room();
    const rows = Math.min(size[1], pace.rows(size[0], rowsApart(size[0])));
    const last = Math.min(size[1], this.row + rows);
    const began = performance.now();
    const timed = this.sample(size, this.done, this.row, last);
    const [clock] = await Promise.all([
      timed ? this.stamped() : null,
      this.gpu.device.queue.onSubmittedWorkDone(),
    ]);
    const cost = Math.max(pace.work(performance.now() - began), clock ?? 0);
    // the few rows that are left at the end say little
    if (2 * (last - this.row) >= rows) pace.note(cost, size[0] * (last - this.row));
    const [before, clockBefore] = this.spent;
    const known = clock !== null && clockBefore !== null;
    this.spent = [before + cost, known ? clockBefore + clock : null];
    if (this.dirty || !this.shown) return;
    this.row = last;
    if (last < size[1]) return;
    this.complete(size, this.done);
    this.done += 1;
    this.row = 0;
    const [milliseconds, gpuMilliseconds] = this.spent;
    this.spent = [0, 0];
    this.drawing.heard({ milliseconds, gpuMilliseconds, timedAt: size, size, samples: this.done });
    if (this.done === 1) await this.figures();
  }

  /**
   * Draw rows of a sample, on each side; returns whether the GPU's clock is asked for it.
   * @param {Pair} size
   * @param {number} number of the sample
   * @param {number} first
   * @param {number} last
   */
  sample(size, number, first, last) {
    const timed = Boolean(this.gpu.stamps) && !this.timing;
    const shown = Object.entries(/** @type {Shown} */ (this.shown));
    for (const [k, [side, { state, job }]] of shown.entries()) {
      const { planes } = this.buffers(/** @type {SideName} */ (side));
      job.put(this.drawing.values(state, size, this.drawing.data.samples[number]));
      job.dispatch(planes, size, first, last, { stamp: timed ? k : null });
    }
    if (timed) this.gpu.resolveStamps(shown.length);
    this.timing ||= timed;
    return timed;
  }

  /**
   * Add a sample whose rows are all drawn to the picture, and show that.
   * @param {Pair} size
   * @param {number} number of the sample
   */
  complete(size, number) {
    const view = { ...this.view(), size, first: number === 0 };
    this.colors.accumulate(this.buffers("left"), view);
    if (this.shown?.right) this.colors.accumulate(this.buffers("right"), view);
    this.missedHits(size, number);
    this.drawnSize = size;
    this.drawn = number + 1;
    this.present();
  }

  /**
   * Find the missed hits of a sample, on each side.
   * @param {Pair} size
   * @param {number} number of the sample
   */
  missedHits(size, number) {
    const { drawing, shown } = this;
    if (!shown?.truth || !drawing.missed) return;
    for (const side of /** @type {const} */ (["left", "right"])) {
      if (!shown[side]) continue;
      const truth = side === "right" && shown.right_truth ? "right_truth" : "truth";
      const { state } = /** @type {Side} */ (shown[truth]);
      const values = drawing.values(state, size, drawing.data.samples[number]);
      const pictures = { drawn: this.buffers(side).planes, truth: this.buffers(truth).planes };
      drawing.missed.find(this.buffers(side).missed, pictures, size, drawing.texels, values);
    }
  }

  /** @returns {PictureView} */
  view() {
    const { canvas } = this;
    const state = /** @type {State} */ (this.drawing.state);
    return {
      size: this.drawnSize,
      canvas: this.size,
      texels: this.drawing.texels,
      background: [...state.background, 1],
      divider: state.compare ? state.divider * canvas.width : canvas.width + 1,
      show: state.show,
      samples: this.drawn,
      figures: this.found,
    };
  }

  // Put what is drawn on the canvas, with the divider where it is now.
  present() {
    if (!this.shown || !this.drawn || this.drawing.held) return;
    this.colors.present(this.buffers("left"), this.buffers("right"), this.view());
  }

  /**
   * The buffers of a side, allocated by `room`.
   * @param {SideName} side
   */
  buffers(side) {
    return /** @type {SideBuffers} */ (this.sides[side]);
  }

  // What is measured on the picture; what another is drawn instead of by then is not told.
  async figures() {
    const { measured } = this.drawing;
    const view = this.view();
    const shown = /** @type {Shown} */ (this.shown);
    // both are asked for before anything else is drawn
    const [left, right] = await Promise.all([
      this.colors.figures(this.buffers("left"), view),
      shown.right && this.colors.figures(this.buffers("right"), view),
    ]);
    if (!this.shown || this.drawing.measured !== measured) return;
    this.found = { ...left, most: Math.max(left.most, right?.most ?? 0) };
    this.drawing.heard({ figures: { left, right, missed: Boolean(shown.truth) } });
    if (view.show !== "color" && !this.dirty) this.present();
  }

  // What the programs took that were timed last, by the GPU's own clock.
  async stamped() {
    try {
      return await this.gpu.readStamps();
    } finally {
      this.timing = false;
    }
  }

  /**
   * The words of a side's planes, as they were drawn last.
   * @param {SideName} side
   */
  async words(side = "left") {
    const [width, height] = this.drawnSize;
    const words = await this.gpu.read(this.buffers(side).planes);
    return words.slice(0, 4 * PLANES * width * height);
  }
}
