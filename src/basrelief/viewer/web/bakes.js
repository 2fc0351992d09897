// Bakes from heights: normals, and the tables of techniques, by the library's programs and by the steps
// of `baking.exact` and `baking.cone`. Nothing is read back between steps: a step's planes become a
// texture that the next one reads.

import { Job } from "view/gpu.js";
import { linked } from "view/link.js";
import { words } from "view/text.js";

/** @import { Data, Pair, Sector } from "view/data" */
/** @import { Gpu, ProgramValues, Viewable } from "view/gpu.js" */
/** @import { Edge } from "view/link.js" */
/** @import { Pace } from "view/pace.js" */

/**
 * Progress callback: takes the share that is done.
 * @typedef {(share: number) => void} Report
 */
/**
 * Cancellation check: whether the result is still wanted.
 * @typedef {() => boolean} Needed
 */
/**
 * The result of a bake.
 * @typedef {GPUTexture | Uint16Array} BakeResult
 */
/**
 * The kinds of textures that a program's planes are packed into.
 * @typedef {"heights" | "records" | "windows" | "cones" | "normals"} Kind
 */

const ROW = 64; // words that a row of a copy is a multiple of
const LONG = 60; // milliseconds that a submission should take; drivers stop those of seconds
const FIRST = 2 ** 12; // invocations of a program's first submission, of which nothing is known
const GROWTH = 8; // times larger that a submission may be than the one before
const ROOM = 2 ** 24; // bytes of planes at once

// A program's planes as texels of four 16-bit channels; those of one plane of heights are copied.
const PACK = `
struct Size { width: u32, rows: u32, stride: u32 }
@group(0) @binding(0) var<uniform> size: Size;
@group(0) @binding(1) var<storage, read> planes: array<u32>;
@group(0) @binding(2) var<storage, read_write> texels: array<vec2u>;

fn code(p: u32, plane: u32) -> u32 { return u32(bitcast<f32>(planes[p + plane * size.stride])); }

// −1 to 1 as 0 to 65535.
fn unit(p: u32, plane: u32) -> u32 {
  return u32(round((bitcast<f32>(planes[p + plane * size.stride]) * 0.5 + 0.5) * 65535.0));
}

fn texel(p: u32) -> vec2u {
  return TEXEL;
}

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
  if (id.x >= size.width || id.y >= size.rows) { return; }
  let p = id.y * size.width + id.x;
  texels[p] = texel(p);
}
`;
/** @type {{ [Name in Kind]: { planes: number, texel?: string } }} */
const KINDS = {
  heights: { planes: 1 },
  // two words that hold the four channels already
  records: { planes: 2, texel: "vec2u(planes[p], planes[p + size.stride])" },
  windows: {
    planes: 4,
    texel: "vec2u(code(p, 0u) | (code(p, 1u) << 16u), code(p, 2u) | (code(p, 3u) << 16u))",
  },
  cones: { planes: 1, texel: "vec2u(code(p, 0u) * 65537u, code(p, 0u) | 0xffff0000u)" },
  normals: {
    planes: 3,
    texel: "vec2u(unit(p, 0u) | (unit(p, 1u) << 16u), unit(p, 2u) | 0xffff0000u)",
  },
};

// Thrown where a bake is no longer wanted.
export class Cancelled extends Error {}

export class Bakes {
  /**
   * Of the heights in a texture with all its levels, for maps that end as an `edge` says.
   * @param {Gpu} gpu
   * @param {Data} data
   * @param {GPUTexture} field
   * @param {number} highest
   * @param {Edge} edge
   * @param {Pace} pace
   */
  constructor(gpu, data, field, highest, edge, pace) {
    this.gpu = gpu;
    this.data = data;
    this.field = field;
    this.highest = highest;
    this.edge = edge;
    this.pace = pace;
    /** @type {Pair} */
    this.size = [field.width, field.height];
    /** @type {Map<string, GPUTexture>} */
    this.tables = new Map();
    /** @type {Map<string, unknown>} */
    this.failures = new Map();
    /** @type {Map<string, Job>} */
    this.jobs = new Map();
    /** @type {Map<Kind, GPUComputePipeline>} */
    this.packers = new Map();
    /**
     * Milliseconds and invocations of each program's last submission.
     * @type {Map<string, Pair>}
     */
    this.speeds = new Map();
    this.destroyed = false;
    // the bake in progress
    /** @type {Report} */
    this.report = () => {};
    /** @type {Needed} */
    this.needed = () => true;
    this.done = 0;
    this.whole = 1;
    /** @type {Promise<void>[]} */
    this.refused = [];
    /** @type {Set<GPUTexture>} */
    this.scratch = new Set();
    // buffers that are reused
    /** @type {GPUBuffer | undefined} */
    this.planes = undefined;
    /** @type {GPUBuffer | undefined} */
    this.packed = undefined;
    /** @type {GPUBuffer | undefined} */
    this.packing = undefined;
  }

  /**
   * The table `name`, made once. `report` is called with the finished share, `needed` says whether to
   * continue. A failed bake is not repeated.
   * @param {string} name
   * @param {Report} report
   * @param {Needed} needed
   */
  async table(name, report, needed) {
    if (this.failures.has(name)) throw this.failures.get(name);
    const known = this.tables.get(name);
    if (known) return known;
    try {
      const made = await this.runBake(() => this.bake(name), report, needed);
      this.tables.set(name, made);
      return made;
    } catch (error) {
      if (!(error instanceof Cancelled)) this.failures.set(name, error);
      throw error;
    }
  }

  /** @param {string} name */
  async bake(name) {
    switch (name) {
      case "bounds":
        return this.bounds(1);
      case "mip_bounds":
        return this.bounds(this.field.mipLevelCount);
      case "cone_map":
        return this.coneMap();
      case "relaxed_cone_map":
        return this.relaxedConeMap();
      default:
        throw new Error(`the page cannot bake ${words(name)}`);
    }
  }

  /**
   * Normals of a relief by its height range in texels, in four 16-bit channels per texel.
   * @param {number} per_texel
   * @param {Needed} needed
   */
  normals(per_texel, needed) {
    const steps = async () => {
      const values = { field: this.field, relief: { per_texel } };
      return this.gpu.readTexture(await this.computed("normals", "normals", values));
    };
    return this.runBake(steps, undefined, needed);
  }

  /**
   * Run the steps of a bake; of its textures only the returned one is kept.
   * @template {BakeResult} T
   * @param {() => Promise<T>} steps
   * @param {Report} report
   * @param {Needed} needed
   * @returns {Promise<T>}
   */
  async runBake(steps, report = () => {}, needed = () => true) {
    Object.assign(this, { report, needed, done: 0, whole: 1, refused: [], scratch: new Set() });
    /** @type {BakeResult | null} */
    let result = null;
    try {
      const made = await steps();
      this.checkNeeded();
      result = made;
      return made;
    } finally {
      for (const each of this.scratch) if (each !== result) each.destroy();
    }
  }

  // Stop and free all resources, as the heights have changed.
  destroy() {
    this.destroyed = true;
    for (const each of this.tables.values()) each.destroy();
    for (const each of this.jobs.values()) each.destroy();
    this.planes?.destroy();
    this.packed?.destroy();
  }

  // --- the bounds, as `baking/exact.py` has them

  /**
   * Records of so many levels below one another, of each the near ones above the far ones.
   * @param {number} count
   */
  async bounds(count) {
    const { block, reach, farBlock, farReach, farWindows } = this.data.bakes.bounds;
    const levels = Array.from({ length: count }, (_, k) => this.level(k));
    const rows = levels.map(({ size }) => records(size, block)[1] + records(size, farBlock)[1]);
    const columns = records(this.size, block)[0];
    const table = this.texture([columns, rows.reduce((sum, n) => sum + n)], false);
    let below = 0;
    for (const { field, size } of levels) {
      const near = await this.windowsOf(field, size, block, reach, [["windows", reach]]);
      await this.run("near_record", "records", near, records(size, block), table, below);
      below += records(size, block)[1];
      const far = await this.windowsOf(field, size, farBlock, farReach, farWindows);
      await this.run("far_record", "records", far, records(size, farBlock), table, below);
      below += records(size, farBlock)[1];
    }
    return table;
  }

  /**
   * A level of the heights as a map of its own.
   * @param {number} k
   */
  level(k) {
    const { field } = this;
    const view = { baseMipLevel: k, mipLevelCount: 1 };
    return {
      field: { createView: () => field.createView(view) },
      size: this.size.map((n) => Math.max(1, n >> k)),
    };
  }

  /**
   * A field, and the highest points of its blocks in windows by name, each from the one before.
   * @param {Viewable} field
   * @param {Pair} size
   * @param {number} side of a block, in cells
   * @param {number} margin of blocks around
   * @param {[window: string, width: number][]} windows
   */
  async windowsOf(field, size, side, margin, windows) {
    const wide = size.map((n) => Math.ceil(n / side) + 2 * margin);
    this.speeds.delete("block_top"); // it goes by the side
    const blocks = { blocks: { side, margin }, field };
    let highest = await this.computed("block_top", "heights", blocks, wide);
    let width = 1;
    /** @type {ProgramValues} */
    const values = { field };
    for (const [name, wanted] of windows) {
      highest = values[name] = await this.widened(highest, width, wanted);
      width = wanted;
    }
    return values;
  }

  /**
   * Windows of a wanted width in blocks, from narrower ones that overlap.
   * @param {GPUTexture} windows
   * @param {number} width
   * @param {number} wanted
   */
  async widened(windows, width, wanted) {
    let [wide, now] = [windows, width];
    while (now < wanted) {
      const spacing = Math.min(now, wanted - now);
      const values = { overlap: { spacing }, field: wide };
      wide = await this.computed("window_top", "heights", values, [wide.width, wide.height]);
      now += spacing;
    }
    return wide;
  }

  // --- cone maps, as `baking/cone.py` has them

  async coneMap() {
    this.whole = this.octaves();
    const none = this.texture(this.size, true);
    const slopes = await this.steepest(this.field, null, none);
    return this.computed("cone_of", "cones", { field: this.field, slopes });
  }

  async relaxedConeMap() {
    const { sectors } = this.data.bakes.cones;
    this.whole = sectors.length * this.octaves();
    let slopes = this.texture(this.size, true);
    for (const sector of sectors) {
      const values = { sector: sector.record, field: this.field };
      const falling = await this.computed("crest_height", "heights", values);
      slopes = await this.steepest(falling, sector, slopes);
      this.free(falling);
    }
    return this.computed("relaxed_cone_of", "cones", { slopes });
  }

  // The number of octaves that reach all texels that matter; where they repeat, the nearest.
  octaves() {
    const side = Math.max(...this.size);
    const furthest = this.edge === "wrap" ? Math.floor(side / 2) : side - 1;
    let count = 1;
    while (this.data.bakes.cones.blocks * 2 ** (count - 1) <= furthest) count += 1;
    return count;
  }

  /**
   * The steepest line, squared, from each vertex to those of a field; `squared` is used up.
   * @param {GPUTexture} those
   * @param {Sector | null} sector
   * @param {GPUTexture} squared
   */
  async steepest(those, sector, squared) {
    const { blocks: across, sectors } = this.data.bakes.cones;
    const [first, last] = (sector ?? sectors[0]).ends;
    let slopes = squared;
    /** @type {GPUTexture | null} */
    let narrower = null;
    for (let k = 0; k < this.octaves(); k++) {
      const windows = await this.windows(k, those, narrower);
      const nearest = k ? (across * 2 ** k) / 2 : 0;
      const values = {
        bounds: { nearest, highest: this.highest, first, last },
        layout: this.held(k),
        field: this.field,
        windows,
        previous: slopes,
      };
      const inSector = Boolean(sector);
      const steeper = await this.computed("steepest", "heights", values, this.size, inSector);
      this.free(slopes);
      slopes = steeper;
      narrower = windows;
      this.done += 1;
      this.report(this.done / this.whole);
    }
    if (narrower) this.free(narrower);
    return slopes;
  }

  /**
   * Windows of 2 ** k texels, from narrower ones, which are used up; the first from heights.
   * @param {number} k
   * @param {GPUTexture} field
   * @param {GPUTexture | null} windows
   */
  async windows(k, field, windows) {
    const held = this.held(k);
    const size = this.size.map((n) => n + held.before);
    if (!windows) return this.computed("first_windows", "windows", { layout: held, field }, size);
    const values = { layout: held, narrower: this.held(k - 1), windows };
    const wider = await this.computed("next_windows", "windows", values, size);
    this.free(windows);
    return wider;
  }

  /** @param {number} k */
  held(k) {
    return { width: 2 ** k, before: this.edge === "clamp" ? 2 ** (k + 1) - 1 : 0 };
  }

  // --- a step

  /**
   * A texture that a program fills.
   * @param {string} key
   * @param {Kind} kind
   * @param {ProgramValues} values
   * @param {Pair} size
   * @param {boolean} inSector
   */
  async computed(key, kind, values, size = this.size, inSector = false) {
    const made = this.texture(size, kind === "heights");
    await this.run(key, kind, values, size, made, 0, inSector);
    return made;
  }

  /**
   * @param {Pair} size
   * @param {boolean} heights
   */
  texture(size, heights) {
    const { value, failed } = this.gpu.checked(() => this.gpu.emptyTexture(size, heights));
    this.refused.push(failed);
    this.scratch.add(value);
    return value;
  }

  /** @param {GPUTexture} texture */
  free(texture) {
    this.scratch.delete(texture);
    texture.destroy();
  }

  /**
   * Run a program over a picture, into a texture from row `below` on, as many rows at once as take
   * no longer than a submission should.
   * @param {string} key
   * @param {Kind} kind
   * @param {ProgramValues} values
   * @param {Pair} size
   * @param {GPUTexture} texture
   * @param {number} below
   * @param {boolean} inSector
   */
  async run(key, kind, values, [width, height], texture, below = 0, inSector = false) {
    const job = await this.job(key, inSector);
    const { planes, texel } = KINDS[kind];
    if (texel && !this.packers.has(kind)) this.packers.set(kind, await this.packer(kind, texel));
    const wide = Math.ceil(width / ROW) * ROW;
    const most = Math.max(1, Math.floor(ROOM / (4 * planes * wide)));
    // the heights may have changed meanwhile, and the job's buffers be freed
    this.checkNeeded();
    job.put(values);
    for (let first = 0; first < height; ) {
      this.checkNeeded();
      const rows = Math.min(height - first, most, Math.max(1, Math.floor(this.room(key) / wide)));
      const began = performance.now();
      const { failed } = this.gpu.checked(() => {
        this.submit(job, kind, wide, first, first + rows, {
          texture,
          origin: [0, below + first],
          size: [width, rows],
        });
      });
      await this.gpu.device.queue.onSubmittedWorkDone();
      await Promise.all([failed, ...this.refused.splice(0)]);
      this.note(key, this.pace.work(performance.now() - began), rows * wide);
      first += rows;
      if (height > rows) this.report((this.done + first / height) / this.whole);
    }
  }

  /**
   * Record the time of a submission; the last few rows count only if they were slow.
   * @param {string} key
   * @param {number} took
   * @param {number} count
   */
  note(key, took, count) {
    const [, before] = this.speeds.get(key) ?? [0, 0];
    if (2 * count >= before || took > LONG) this.speeds.set(key, [took, count]);
  }

  /**
   * The number of invocations of a program that fit the time of a submission.
   * @param {string} key
   */
  room(key) {
    const [took, count] = this.speeds.get(key) ?? [LONG, FIRST];
    return Math.min((LONG / Math.max(took, 0.01)) * count, Math.max(GROWTH * count, FIRST));
  }

  // Throw if the bake is no longer needed.
  checkNeeded() {
    if (this.destroyed || !this.needed()) throw new Cancelled();
  }

  /**
   * @param {string} entry
   * @param {boolean} by_sector
   */
  async job(entry, by_sector) {
    const name = `${entry} ${by_sector}`;
    const known = this.jobs.get(name);
    if (known) return known;
    const program = linked(this.data.programs, entry, {
      "map.edge": this.edge,
      "map.filter": "sharp",
      by_sector,
    });
    const compiled = await this.gpu.pipeline(program);
    this.checkNeeded();
    const made = new Job(this.gpu, compiled, this.data);
    this.jobs.set(name, made);
    return made;
  }

  /**
   * @param {Job} job
   * @param {Kind} kind
   * @param {number} wide
   * @param {number} first
   * @param {number} last
   * @param {{ texture: GPUTexture, origin: Pair, size: Pair }} target
   */
  submit(job, kind, wide, first, last, { texture, origin, size }) {
    const { device } = this.gpu;
    const rows = last - first;
    const { planes: count, texel } = KINDS[kind];
    const planes = this.roomFor(this.planes, 4 * count * wide * rows);
    this.planes = planes;
    job.dispatch(planes, [wide, rows], first, last, { top: first });
    const encoder = device.createCommandEncoder();
    encoder.copyBufferToTexture(
      {
        buffer: texel ? this.pack(kind, planes, wide, rows) : planes,
        bytesPerRow: this.gpu.format(!texel)[1] * wide,
        rowsPerImage: rows,
      },
      { texture, origin },
      size,
    );
    device.queue.submit([encoder.finish()]);
  }

  /**
   * A buffer of at least `bytes` bytes: the current one, or a new one in its place.
   * @param {GPUBuffer | undefined} buffer
   * @param {number} bytes
   */
  roomFor(buffer, bytes) {
    if (buffer && buffer.size >= bytes) return buffer;
    buffer?.destroy();
    return this.gpu.planes(1, bytes / 4, 1);
  }

  /**
   * @param {Kind} kind
   * @param {string} texel
   */
  async packer(kind, texel) {
    const { device } = this.gpu;
    const code = PACK.replace("TEXEL", texel);
    const module = device.createShaderModule({ code, label: `pack ${kind}` });
    const compute = { module, entryPoint: "main" };
    return device.createComputePipelineAsync({ layout: "auto", compute });
  }

  /**
   * @param {Kind} kind
   * @param {GPUBuffer} planes
   * @param {number} wide
   * @param {number} rows
   */
  pack(kind, planes, wide, rows) {
    const pipeline = /** @type {GPUComputePipeline} */ (this.packers.get(kind));
    this.packed = this.roomFor(this.packed, 8 * wide * rows);
    this.packing ??= this.gpu.buffer(new ArrayBuffer(16), GPUBufferUsage.UNIFORM);
    const size = new Uint32Array([wide, rows, wide * rows, 0]);
    this.gpu.device.queue.writeBuffer(this.packing, 0, size);
    const groups = [Math.ceil(wide / 8), Math.ceil(rows / 8)];
    this.gpu.compute(pipeline, [this.packing, planes, this.packed], groups);
    return this.packed;
  }
}

/**
 * The size of the records of a map: two along each axis for a block of so many cells a side.
 * @type {(size: Pair, side: number) => Pair}
 */
const records = (size, side) => size.map((n) => 2 * Math.ceil(n / side));
