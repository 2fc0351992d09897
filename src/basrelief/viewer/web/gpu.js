// Runs the page's programs as `engine/gpu.py` does: the same bindings, formats and uniforms.

import { pack, packList } from "view/records.js";

const GROUP = 8;
const TIMED = 4; // programs that are timed together at most
const TRIES = 4; // times that a device is asked for
const APART = 300; // milliseconds between them

export class Gpu {
  // A browser whose graphics process has just begun, or begun anew, may have a device a moment later.
  static async open() {
    if (!navigator.gpu) throw new Error("this browser has no WebGPU");
    for (let left = TRIES - 1; ; left--) {
      try {
        return await Gpu.openOnce();
      } catch (error) {
        if (!left) throw error;
      }
      await new Promise((next) => setTimeout(next, APART));
    }
  }

  static async openOnce() {
    const adapter = await navigator.gpu.requestAdapter({ powerPreference: "high-performance" });
    if (!adapter) throw new Error("WebGPU finds no graphics adapter here");
    const wanted = [
      "maxStorageBufferBindingSize",
      "maxBufferSize",
      "maxTextureDimension2D",
      "maxStorageBuffersPerShaderStage",
    ];
    const device = await adapter.requestDevice({
      requiredLimits: Object.fromEntries(wanted.map((name) => [name, adapter.limits[name]])),
      requiredFeatures: adapter.features.has("timestamp-query") ? ["timestamp-query"] : [],
    });
    return new Gpu(adapter, device);
  }

  constructor(adapter, device) {
    this.adapter = adapter;
    this.device = device;
    this.limits = device.limits;
    this.pipelines = new Map();
    this.compiled = 0; // how many pipelines were ever made
    const sampler = (mode) => device.createSampler({ addressModeU: mode, addressModeV: mode });
    this.samplers = { wrap: sampler("repeat"), clamp: sampler("clamp-to-edge") };
    this.stamps = device.features.has("timestamp-query") ? this.timing() : null;
  }

  timing() {
    const { device } = this;
    const usage = GPUBufferUsage;
    const size = 16 * TIMED;
    return {
      queries: device.createQuerySet({ type: "timestamp", count: 2 * TIMED }),
      resolved: device.createBuffer({ size, usage: usage.QUERY_RESOLVE | usage.COPY_SRC }),
      read: device.createBuffer({ size, usage: usage.MAP_READ | usage.COPY_DST }),
      count: 0,
    };
  }

  // So many programs were timed: their times may be read.
  resolveStamps(count) {
    const { stamps, device } = this;
    const encoder = device.createCommandEncoder();
    encoder.resolveQuerySet(stamps.queries, 0, 2 * count, stamps.resolved, 0);
    encoder.copyBufferToBuffer(stamps.resolved, 0, stamps.read, 0, 16 * count);
    device.queue.submit([encoder.finish()]);
    stamps.count = count;
  }

  // Milliseconds that they took together; not to be timed again before they are read.
  async readStamps() {
    const { read, count } = this.stamps;
    await read.mapAsync(GPUMapMode.READ);
    const times = new BigUint64Array(read.getMappedRange());
    let sum = 0;
    for (let k = 0; k < count; k++) sum += Number(times[2 * k + 1] - times[2 * k]) * 1e-6;
    read.unmap();
    return sum;
  }

  // The pipeline of a linked program, made once; rejects with what the compiler says, and is not
  // compiled again.
  pipeline(program) {
    const { key } = program;
    if (!this.pipelines.has(key)) {
      const made = this.build(program);
      this.pipelines.set(key, made);
      made.catch(() => {});
    }
    return this.pipelines.get(key);
  }

  async build(program) {
    const { device } = this;
    this.compiled += 1;
    const { value: module, failed } = this.checked(() =>
      device.createShaderModule({ code: program.code, label: program.entry }),
    );
    await failed;
    const layout = device.createBindGroupLayout({ entries: program.bindings.map(layoutEntry) });
    const pipeline = await device.createComputePipelineAsync({
      layout: device.createPipelineLayout({ bindGroupLayouts: [layout] }),
      compute: { module, entryPoint: "main" },
    });
    return { pipeline, layout, program };
  }

  buffer(bytes, usage) {
    const size = Math.max(16, bytes.byteLength);
    const made = this.device.createBuffer({ size, usage: usage | GPUBufferUsage.COPY_DST });
    this.device.queue.writeBuffer(made, 0, bytes);
    return made;
  }

  // A texture with all its levels: heights as r32float, four channels as rgba16uint.
  texture(levels, heights) {
    const [{ width, height }] = levels;
    const texture = this.emptyTexture([width, height], heights, levels.length);
    levels.forEach((level, mipLevel) => {
      this.device.queue.writeTexture(
        { texture, mipLevel },
        level.texels,
        { bytesPerRow: level.width * (heights ? 4 : 8), rowsPerImage: level.height },
        [level.width, level.height],
      );
    });
    return texture;
  }

  // One of zeros, which is filled later.
  emptyTexture([width, height], heights, mipLevelCount = 1) {
    const most = this.limits.maxTextureDimension2D;
    if (Math.max(width, height) > most) {
      throw new Error(`a map of ${width} × ${height} is larger than this GPU takes (${most})`);
    }
    const usage = GPUTextureUsage;
    return this.device.createTexture({
      size: [width, height],
      format: heights ? "r32float" : "rgba16uint",
      mipLevelCount,
      usage: usage.TEXTURE_BINDING | usage.COPY_DST | usage.COPY_SRC,
    });
  }

  // Do something with the GPU; `failed` rejects where the GPU refuses it.
  checked(act) {
    const { device } = this;
    const filters = ["out-of-memory", "validation"];
    for (const filter of filters) device.pushErrorScope(filter);
    let found;
    let value;
    try {
      value = act();
    } finally {
      found = Promise.all(filters.map(() => device.popErrorScope()));
    }
    const failed = found.then((errors) => {
      const error = errors.find(Boolean);
      if (error) throw new Error(error.message || "the GPU has no room for it");
    });
    failed.catch(() => {});
    return { value, failed };
  }

  // Where a program writes: so many planes of a picture.
  planes(count, width, height) {
    const usage = GPUBufferUsage.STORAGE | GPUBufferUsage.COPY_SRC;
    return this.device.createBuffer({ size: 4 * count * width * height, usage });
  }

  // What a texture of four channels holds, row by row.
  async readTexture(texture) {
    const { width, height } = texture;
    const row = Math.ceil((8 * width) / 256) * 256;
    const usage = GPUBufferUsage.COPY_DST | GPUBufferUsage.COPY_SRC;
    const buffer = this.device.createBuffer({ size: row * height, usage });
    const encoder = this.device.createCommandEncoder();
    encoder.copyTextureToBuffer({ texture }, { buffer, bytesPerRow: row }, [width, height]);
    this.device.queue.submit([encoder.finish()]);
    const words = new Uint16Array(await this.read(buffer));
    buffer.destroy();
    const texels = new Uint16Array(4 * width * height);
    for (let y = 0; y < height; y++) {
      const from = (y * row) / 2;
      texels.set(words.subarray(from, from + 4 * width), 4 * width * y);
    }
    return texels;
  }

  async read(buffer) {
    const usage = GPUBufferUsage.MAP_READ | GPUBufferUsage.COPY_DST;
    const copy = this.device.createBuffer({ size: buffer.size, usage });
    const encoder = this.device.createCommandEncoder();
    encoder.copyBufferToBuffer(buffer, 0, copy, 0, buffer.size);
    this.device.queue.submit([encoder.finish()]);
    await copy.mapAsync(GPUMapMode.READ);
    const words = copy.getMappedRange().slice(0);
    copy.destroy();
    return words;
  }
}

// Rows that begin where a binding may: at multiples of 256 bytes.
export function rowsApart(width) {
  let rows = 64;
  while (rows > 1 && ((rows / 2) * width) % 64 === 0) rows /= 2;
  return rows;
}

// A program with its values in place, to be run on rows of a picture as often as is wanted.
export class Job {
  constructor(gpu, made, data) {
    this.gpu = gpu;
    this.made = made;
    this.data = data;
    this.uniforms = new Map();
    this.run = gpu.buffer(new ArrayBuffer(16), GPUBufferUsage.UNIFORM);
  }

  // `values` by name: records, lists of them, textures; nothing is compiled for a new one.
  put(values) {
    const { gpu, data } = this;
    for (const { kind, name, type } of this.made.program.bindings) {
      if (kind !== "uniform" && kind !== "buffer") continue;
      const bytes = (kind === "uniform" ? pack : packList)(type, values[name], data.records);
      const held = this.uniforms.get(name);
      if (held && held.size >= bytes.byteLength) {
        gpu.device.queue.writeBuffer(held, 0, bytes);
      } else {
        held?.destroy();
        const usage = kind === "uniform" ? GPUBufferUsage.UNIFORM : GPUBufferUsage.STORAGE;
        this.uniforms.set(name, gpu.buffer(bytes, usage));
      }
    }
    this.textures = values;
  }

  // Compute rows first … last − 1 of a picture into planes that hold `height` rows from `top` on;
  // `first` is a multiple of `rowsApart` beyond that. `stamp` says as which of those timed.
  dispatch(planes, [width, height], first, last, { stamp = null, top = 0 } = {}) {
    const { gpu, made } = this;
    const { device } = gpu;
    device.queue.writeBuffer(this.run, 0, new Uint32Array([width, first, last, width * height]));
    const offset = 4 * width * (first - top);
    const entries = made.program.bindings.map(({ kind, name }, binding) => {
      if (kind === "run") return { binding, resource: { buffer: this.run } };
      if (kind === "planes") return { binding, resource: { buffer: planes, offset } };
      if (kind === "sampler") return { binding, resource: gpu.samplers[made.program.edge ?? "wrap"] };
      if (kind === "map") return { binding, resource: this.textures[name].createView() };
      return { binding, resource: { buffer: this.uniforms.get(name) } };
    });
    const encoder = device.createCommandEncoder();
    const timestampWrites = {
      querySet: gpu.stamps?.queries,
      beginningOfPassWriteIndex: 2 * stamp,
      endOfPassWriteIndex: 2 * stamp + 1,
    };
    const pass = encoder.beginComputePass(stamp === null ? {} : { timestampWrites });
    pass.setPipeline(made.pipeline);
    pass.setBindGroup(0, device.createBindGroup({ layout: made.layout, entries }));
    pass.dispatchWorkgroups(Math.ceil(width / GROUP), Math.ceil((last - first) / GROUP));
    pass.end();
    device.queue.submit([encoder.finish()]);
  }

  destroy() {
    for (const each of [this.run, ...this.uniforms.values()]) each.destroy();
  }
}

function layoutEntry({ kind, name, type }, binding) {
  const entry = { binding, visibility: GPUShaderStage.COMPUTE };
  if (kind === "map") {
    const sampleType = type === "HeightField" ? "unfilterable-float" : "uint";
    entry.texture = { sampleType, viewDimension: "2d" };
  } else if (kind === "sampler") {
    entry.sampler = { type: "non-filtering" };
  } else {
    const kinds = { run: "uniform", uniform: "uniform", planes: "storage" };
    entry.buffer = { type: kinds[kind] ?? "read-only-storage" };
  }
  return entry;
}
