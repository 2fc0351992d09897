// What is made of the heights: normals, and what techniques have baked, by the steps of the
// library's `bake.bounds` and `bake.cones` and by its own programs. Between steps nothing is read
// back: a step's planes become a texture that the next one reads.

import { Job } from "view/gpu.js";
import { linked } from "view/link.js";
import { words } from "view/text.js";

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
export class Left extends Error {}

export class Bakes {
  // Of the heights in a texture with all its levels, for maps that end as an `edge` says.
  constructor(gpu, data, field, highest, edge, pace) {
    Object.assign(this, { gpu, data, field, highest, edge, pace });
    this.size = [field.width, field.height];
    this.tables = new Map();
    this.failures = new Map();
    this.jobs = new Map();
    this.packers = new Map();
    this.speeds = new Map(); // milliseconds and invocations of each program's last submission
    this.over = false;
  }

  // The table `name`, made once; `tell` hears what share is done, and `wanted` whether to go on.
  // What could not be made is not tried again.
  async table(name, tell, wanted) {
    if (this.failures.has(name)) throw this.failures.get(name);
    if (!this.tables.has(name)) {
      try {
        if (!(name in this)) throw new Error(`the page cannot bake ${words(name)}`);
        this.tables.set(name, await this.making(() => this[name](), tell, wanted));
      } catch (error) {
        if (!(error instanceof Left)) this.failures.set(name, error);
        throw error;
      }
    }
    return this.tables.get(name);
  }

  // Normals of a relief that rises so much a texel, four 16-bit channels a texel.
  normals(per_texel, wanted) {
    const steps = async () => {
      const made = this.texture(this.size, false);
      const values = { field: this.field, relief: { per_texel } };
      await this.run("normals", "normals", values, this.size, made);
      return this.gpu.readTexture(made);
    };
    return this.making(steps, undefined, wanted);
  }

  // Go through a bake's steps; of its textures only the one that it returns is kept.
  async making(steps, tell = () => {}, wanted = () => true) {
    Object.assign(this, { tell, wanted, done: 0, whole: 1, refused: [], scratch: new Set() });
    let made = null;
    try {
      const found = await steps();
      this.stay();
      made = found;
      return made;
    } finally {
      for (const each of this.scratch) if (each !== made) each.destroy();
    }
  }

  // The heights are others now: stop, and give back what is held.
  destroy() {
    this.over = true;
    for (const each of this.tables.values()) each.destroy();
    for (const each of this.jobs.values()) each.destroy();
    this.planes?.destroy();
    this.packed?.destroy();
  }

  // --- the bounds, as `bake/bounds.py` has them

  bounds() {
    return this.boundsOf(1);
  }

  mip_bounds() {
    return this.boundsOf(this.field.mipLevelCount);
  }

  // Of so many levels, below one another.
  async boundsOf(count) {
    const { block, farBlock } = this.data.bakes.bounds;
    const levels = Array.from({ length: count }, (_, k) => this.level(k));
    const rows = levels.map(({ size }) => 2 * (blocks(size, block)[1] + blocks(size, farBlock)[1]));
    const columns = 2 * blocks(this.size, block)[0];
    const table = this.texture([columns, rows.reduce((sum, n) => sum + n)], false);
    let below = 0;
    for (const [k, level] of levels.entries()) {
      await this.near(level, table, below);
      await this.far(level, table, below + 2 * blocks(level.size, block)[1]);
      below += rows[k];
    }
    return table;
  }

  // A level of the heights as a map of its own.
  level(k) {
    const { field } = this;
    const view = { baseMipLevel: k, mipLevelCount: 1 };
    return {
      field: { createView: () => field.createView(view) },
      size: this.size.map((n) => Math.max(1, n >> k)),
    };
  }

  async near({ field, size }, table, below) {
    const { block, reach } = this.data.bakes.bounds;
    const windows = await this.widened(await this.tops(field, size, block, reach), 1, reach);
    const records = blocks(size, block).map((n) => 2 * n);
    await this.run("near_record", "records", { field, windows }, records, table, below);
  }

  async far({ field, size }, table, below) {
    const { farBlock, farReach, farWindows } = this.data.bakes.bounds;
    const found = {};
    let [wide, width] = [await this.tops(field, size, farBlock, farReach), 1];
    for (const [name, wanted] of farWindows) {
      wide = found[name] = await this.widened(wide, width, wanted);
      width = wanted;
    }
    const records = blocks(size, farBlock).map((n) => 2 * n);
    await this.run("far_record", "records", { field, ...found }, records, table, below);
  }

  // The highest points of the blocks of so many cells, and of a margin of blocks around.
  tops(field, size, side, margin) {
    const wide = blocks(size, side).map((n) => n + 2 * margin);
    this.speeds.delete("block_top"); // it goes by the side
    return this.heights("block_top", { blocks: { side, margin }, field }, wide);
  }

  // Windows of a wanted width in blocks, from narrower ones that overlap.
  async widened(windows, width, wanted) {
    let [wide, now] = [windows, width];
    while (now < wanted) {
      const apart = Math.min(now, wanted - now);
      const size = [wide.width, wide.height];
      wide = await this.heights("window_top", { overlap: { apart }, field: wide }, size);
      now += apart;
    }
    return wide;
  }

  // --- cone maps, as `bake/cones.py` has them

  async cone_map() {
    this.whole = this.octaves();
    const none = this.texture(this.size, true);
    const slopes = await this.steepest(this.field, null, none);
    return this.cones("cone_of", { field: this.field, slopes });
  }

  async relaxed_cone_map() {
    const { sectors } = this.data.bakes.cones;
    this.whole = sectors.length * this.octaves();
    let slopes = this.texture(this.size, true);
    for (const sector of sectors) {
      const values = { sector: sector.asked, field: this.field };
      const falling = await this.heights("far_side", values, this.size);
      slopes = await this.steepest(falling, sector, slopes);
      this.free(falling);
    }
    return this.cones("relaxed_cone_of", { slopes });
  }

  // How many octaves reach as far as texels matter: of those that repeat, the nearest do.
  octaves() {
    const side = Math.max(...this.size);
    const furthest = this.edge === "wrap" ? Math.floor(side / 2) : side - 1;
    let count = 1;
    while (this.data.bakes.cones.blocks * 2 ** (count - 1) <= furthest) count += 1;
    return count;
  }

  // The steepest line, squared, from each vertex to those of a field; `squared` is used up.
  async steepest(those, sector, squared) {
    const { blocks: across, sectors } = this.data.bakes.cones;
    const [first, last] = (sector ?? sectors[0]).ends;
    let [slopes, windows] = [squared, null];
    for (let k = 0; k < this.octaves(); k++) {
      windows = await this.windows(k, those, windows);
      const nearest = k ? (across * 2 ** k) / 2 : 0;
      const values = {
        octave: { nearest, highest: this.highest, first, last },
        held: this.held(k),
        field: this.field,
        windows,
        so_far: slopes,
      };
      const steeper = await this.heights("steepest", values, this.size, Boolean(sector));
      this.free(slopes);
      slopes = steeper;
      this.done += 1;
      this.tell(this.done / this.whole);
    }
    this.free(windows);
    return slopes;
  }

  // Windows of 2 ** k texels, from narrower ones, which are used up; the first from heights.
  async windows(k, field, windows) {
    const held = this.held(k);
    const size = this.size.map((n) => n + held.before);
    const made = this.texture(size, false);
    const [key, values] = k
      ? ["next_windows", { made: held, narrower: this.held(k - 1), windows }]
      : ["first_windows", { made: held, field }];
    await this.run(key, "windows", values, size, made);
    if (windows) this.free(windows);
    return made;
  }

  held(k) {
    return { width: 2 ** k, before: this.edge === "clamp" ? 2 ** (k + 1) - 1 : 0 };
  }

  async cones(key, values) {
    const table = this.texture(this.size, false);
    await this.run(key, "cones", values, this.size, table);
    return table;
  }

  // --- a step

  async heights(key, values, size, inSector = false) {
    const made = this.texture(size, true);
    await this.run(key, "heights", values, size, made, 0, inSector);
    return made;
  }

  texture(size, heights) {
    const { value, failed } = this.gpu.checked(() => this.gpu.emptyTexture(size, heights));
    this.refused.push(failed);
    this.scratch.add(value);
    return value;
  }

  free(texture) {
    this.scratch.delete(texture);
    texture.destroy();
  }

  // Run a program over a picture, into a texture from row `below` on, as many rows at once as take
  // no longer than a submission should.
  async run(key, kind, values, [width, height], texture, below = 0, inSector = false) {
    const job = await this.job(key, inSector);
    if (!this.packers.has(kind) && KINDS[kind].texel) {
      this.packers.set(kind, await this.packer(kind));
    }
    const wide = Math.ceil(width / ROW) * ROW;
    const most = Math.max(1, Math.floor(ROOM / (4 * KINDS[kind].planes * wide)));
    // others' heights may have come meanwhile, and the job's buffers be gone
    this.stay();
    job.put(values);
    for (let first = 0; first < height; ) {
      this.stay();
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
      if (height > rows) this.tell((this.done + first / height) / this.whole);
    }
  }

  // What a submission took; of the few rows that are left at the end only that they took long.
  note(key, took, count) {
    const [, before] = this.speeds.get(key) ?? [0, 0];
    if (2 * count >= before || took > LONG) this.speeds.set(key, [took, count]);
  }

  // How many invocations of a program should take as long as a submission should.
  room(key) {
    const [took, count] = this.speeds.get(key) ?? [LONG, FIRST];
    return Math.min((LONG / Math.max(took, 0.01)) * count, Math.max(GROWTH * count, FIRST));
  }

  // Throws where nobody waits for a bake any more.
  stay() {
    if (this.over || !this.wanted()) throw new Left();
  }

  async job(entry, in_sector) {
    const name = `${entry} ${in_sector}`;
    if (!this.jobs.has(name)) {
      const program = linked(this.data.programs, entry, { edge: this.edge, in_sector });
      const made = await this.gpu.pipeline(program);
      this.stay();
      this.jobs.set(name, new Job(this.gpu, made, this.data));
    }
    return this.jobs.get(name);
  }

  submit(job, kind, wide, first, last, { texture, origin, size }) {
    const { device } = this.gpu;
    const rows = last - first;
    const { planes: count, texel } = KINDS[kind];
    this.planes = this.roomFor(this.planes, 4 * count * wide * rows);
    job.dispatch(this.planes, [wide, rows], first, last, { top: first });
    const encoder = device.createCommandEncoder();
    if (texel) this.pack(encoder, kind, wide, rows);
    encoder.copyBufferToTexture(
      {
        buffer: texel ? this.packed : this.planes,
        bytesPerRow: (texel ? 8 : 4) * wide,
        rowsPerImage: rows,
      },
      { texture, origin },
      size,
    );
    device.queue.submit([encoder.finish()]);
  }

  // A buffer of at least so many bytes: the one that is there, or another in its place.
  roomFor(buffer, bytes) {
    if (buffer?.size >= bytes) return buffer;
    buffer?.destroy();
    return this.gpu.planes(1, bytes / 4, 1);
  }

  async packer(kind) {
    const { device } = this.gpu;
    const code = PACK.replace("TEXEL", KINDS[kind].texel);
    const module = device.createShaderModule({ code, label: `pack ${kind}` });
    const compute = { module, entryPoint: "main" };
    return device.createComputePipelineAsync({ layout: "auto", compute });
  }

  pack(encoder, kind, wide, rows) {
    const { device } = this.gpu;
    const pipeline = this.packers.get(kind);
    this.packed = this.roomFor(this.packed, 8 * wide * rows);
    this.packing ??= this.gpu.buffer(new ArrayBuffer(16), GPUBufferUsage.UNIFORM);
    device.queue.writeBuffer(this.packing, 0, new Uint32Array([wide, rows, wide * rows, 0]));
    const buffers = [this.packing, this.planes, this.packed];
    const entries = buffers.map((buffer, binding) => ({ binding, resource: { buffer } }));
    const pass = encoder.beginComputePass();
    pass.setPipeline(pipeline);
    pass.setBindGroup(
      0,
      device.createBindGroup({ layout: pipeline.getBindGroupLayout(0), entries }),
    );
    pass.dispatchWorkgroups(Math.ceil(wide / 8), Math.ceil(rows / 8));
    pass.end();
  }
}

// How many blocks of so many cells a side a map has.
const blocks = (size, side) => size.map((n) => Math.ceil(n / side));
