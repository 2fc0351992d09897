// Frames: the schedule and resolution of a drawing's programs, and reports of their results.
//
// While something moves, whole frames are drawn, at a lower resolution where one is slow. At rest the
// samples of each pixel are drawn in blocks of rows, so that the page stays responsive.

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
/** @typedef {MovingFrame & { work: number }} FinishedFrame */

export const REST = 150; // milliseconds without a change after which the picture is at rest
const PLANES = 9;

export class Frames {
  /**
   * The drawing has the shown states and the arguments of their programs.
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
    this.sides = {}; // buffers by side
    this.limit = data.samples.length;
    this.count = 0; // frames that were drawn while something moved
    this.dirty = false;
    this.done = 0; // samples of the picture at rest
    this.row = 0; // rows of the next sample
    this.fresh = false; // whether a program has drawn nothing yet
    this.reporting = false; // whether results of a frame are being read back
    /** @type {FinishedFrame | null} */
    this.unreported = null; // the frame to be read back next
    this.timing = false; // whether timestamps are waiting to be read
    this.requested = false; // whether an animation frame is requested
    this.running = false; // whether a part of the picture at rest is being drawn
    this.movedAt = -Infinity;
    /** @type {Pair} */
    this.drawnSize = [0, 0]; // of the drawn picture
    this.drawn = 0; // and its samples
    /** @type {[milliseconds: number, gpuMilliseconds: number | null]} */
    this.spent = [0, 0]; // on the next sample
    /** @type {Figures | undefined} */
    this.lastFigures = undefined; // of both sides
  }

  get shown() {
    return this.drawing.shown;
  }

  // Whether anything is left to be drawn or reported.
  get busy() {
    return this.running || this.dirty || this.done < this.limit || !this.still;
  }

  // Draw anew with the next frame, after a change.
  touched() {
    this.dirty = true;
    this.movedAt = performance.now();
    this.wake();
  }

  wake() {
    if (this.requested || this.drawing.paused) return;
    this.requested = true;
    requestAnimationFrame(() => {
      this.requested = false;
      this.tick();
    });
  }

  /** @returns {Pair} */
  get size() {
    return [this.canvas.width, this.canvas.height];
  }

  // Allocate buffers for a picture of the canvas's size, on each side.
  allocate() {
    const area = this.canvas.width * this.canvas.height;
    const names = /** @type {const} */ (["left", "right", "truth", "right_truth"]);
    for (const name of names) {
      const needed = this.shown?.[name] || name === "left" ? area : 1;
      const buffers = this.sides[name];
      if (buffers && buffers.area >= needed && buffers.area <= Math.max(4 * needed, 64)) continue;
      for (const each of [buffers?.planes, buffers?.sum, buffers?.missed]) each?.destroy();
      this.sides[name] = {
        area: needed,
        planes: this.gpu.planes(PLANES, needed, 1),
        sum: this.gpu.planes(4, needed, 1),
        missed: this.gpu.planes(2, needed, 1),
      };
    }
  }

  async tick() {
    if (this.running || !this.shown || this.drawing.paused) return;
    try {
      if (this.dirty) {
        if (this.pace.free) this.movingFrame();
      } else if (this.done < this.limit && this.still) {
        this.running = true;
        await this.refine();
      }
    } catch (error) {
      this.failed(error);
      this.done = this.limit;
    } finally {
      this.running = false;
    }
    this.schedule();
  }

  // Request a frame if one can be drawn; called again whenever a frame in flight is done.
  schedule() {
    if (this.dirty ? this.pace.free : this.done < this.limit && this.still) this.wake();
  }

  // Whether no frame is in flight and none is being read back.
  get still() {
    return !this.pace.flying && !this.reporting;
  }

  movingFrame() {
    const { pace, fresh } = this;
    const size = pace.moving(this.size);
    const full = size[0] === this.size[0] && size[1] === this.size[1];
    this.dirty = false;
    this.allocate();
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
    const done = () => this.frameDone(frame);
    this.gpu.device.queue.onSubmittedWorkDone().then(done, done);
  }

  /** @param {MovingFrame} frame */
  frameDone(frame) {
    const { pace } = this;
    pace.flying -= 1;
    if (!this.shown || this.drawing.paused) {
      if (frame.timed) this.timing = false;
      return;
    }
    this.report({ ...frame, work: pace.work(performance.now() - frame.began) });
    this.schedule();
  }

  /**
   * Read back and report the results of a frame. Later frames do not wait for that; of those drawn
   * meanwhile only the last is reported.
   * @param {FinishedFrame} frame
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
    this.schedule();
  }

  /**
   * Report an error, except a lost device, which is reported elsewhere.
   * @param {unknown} error
   */
  failed(error) {
    const lost = error instanceof Error && error.name === "AbortError";
    if (!lost) this.drawing.onNews({ error: firstLine(error) });
  }

  /** @param {FinishedFrame} frame */
  async read({ size, work, timed, full, alone, fresh, measured }) {
    this.unreported = null;
    const clock = timed ? await this.stamped() : null;
    // by timestamps if available, which alone can separate several frames in flight
    if (this.gpu.stamps ? timed : alone) {
      const milliseconds = Math.max(alone ? work : 0, clock ?? 0);
      // the first frame of a program includes the driver's preparation
      if (!fresh) this.pace.note(milliseconds, size[0] * size[1]);
      this.drawing.onNews({ milliseconds, gpuMilliseconds: clock, timedAt: size });
    }
    this.drawing.onNews({ size, samples: full ? 1 : 0 });
    if (full && this.shown && measured === this.drawing.measured) await this.figures();
  }

  // Draw as many rows of the next sample as fit a frame's time.
  async refine() {
    if (performance.now() - this.movedAt < REST) return;
    const { size, pace } = this;
    this.allocate();
    const rows = Math.min(size[1], pace.rows(size[0], rowsApart(size[0])));
    const last = Math.min(size[1], this.row + rows);
    const began = performance.now();
    const timed = this.sample(size, this.done, this.row, last);
    const [clock] = await Promise.all([
      timed ? this.stamped() : null,
      this.gpu.device.queue.onSubmittedWorkDone(),
    ]);
    const cost = Math.max(pace.work(performance.now() - began), clock ?? 0);
    // the last few rows are too few for a measurement
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
    this.drawing.onNews({ milliseconds, gpuMilliseconds, timedAt: size, size, samples: this.done });
    if (this.done === 1) await this.figures();
  }

  /**
   * Draw rows of a sample, on each side; returns whether they are timed by timestamps.
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
   * Add a completed sample to the picture and show it.
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
      figures: this.lastFigures,
    };
  }

  // Show the drawn picture on the canvas, with the divider at its current position.
  present() {
    if (!this.shown || !this.drawn || this.drawing.paused) return;
    this.colors.present(this.buffers("left"), this.buffers("right"), this.view());
  }

  /**
   * The buffers of a side, allocated by `allocate`.
   * @param {SideName} side
   */
  buffers(side) {
    return /** @type {SideBuffers} */ (this.sides[side]);
  }

  // Measure the picture and report it, unless another one is drawn by then.
  async figures() {
    const { measured } = this.drawing;
    const view = this.view();
    const shown = /** @type {Shown} */ (this.shown);
    // request both before anything else is drawn
    const [left, right] = await Promise.all([
      this.colors.figures(this.buffers("left"), view),
      shown.right && this.colors.figures(this.buffers("right"), view),
    ]);
    if (!this.shown || this.drawing.measured !== measured) return;
    this.lastFigures = { ...left, most: Math.max(left.most, right?.most ?? 0) };
    this.drawing.onNews({ figures: { left, right, missed: Boolean(shown.truth) } });
    if (view.show !== "color" && !this.dirty) this.present();
  }

  // Milliseconds of the programs that were timed last, by timestamps.
  async stamped() {
    try {
      return await this.gpu.readStamps();
    } finally {
      this.timing = false;
    }
  }

  /**
   * The words of the last drawn planes of a side.
   * @param {SideName} side
   */
  async words(side = "left") {
    const [width, height] = this.drawnSize;
    const words = await this.gpu.read(this.buffers(side).planes);
    return words.slice(0, 4 * PLANES * width * height);
  }
}
