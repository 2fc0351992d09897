// Runs the page's programs as `engine/gpu.py` does, by the same description of bindings and formats.

import { pack, packList } from "view/records.js";

/** @import { Binding, Data, Pair, Programs } from "view/data" */
/** @import { Program } from "view/link.js" */
/** @import { Level } from "view/maps.js" */
/** @import { Value } from "view/records.js" */

/**
 * A compiled program.
 * @typedef {object} Compiled
 * @property {GPUComputePipeline} pipeline
 * @property {Program} program
 */
/**
 * Timestamp queries, their buffers, and the number of programs that were timed last.
 * @typedef {{ queries: GPUQuerySet, resolved: GPUBuffer, read: GPUBuffer, count: number }} Stamps
 */
/**
 * A texture, or one level of a texture.
 * @typedef {{ createView(): GPUTextureView }} Viewable
 */
/**
 * The arguments of a program by name: records, lists of records, textures, buffers on the GPU.
 * @typedef {{ [name: string]: Value | Value[] | Viewable | GPUBuffer }} ProgramValues
 */

const TIMED = 4; // programs that are timed together at most
const TRIES = 4; // requests for a device
const APART = 300; // milliseconds between requests

export class Gpu {
  /**
   * Request a device; a browser whose graphics process has just started may need several requests.
   * @param {Programs} programs
   * @returns {Promise<Gpu>}
   */
  static async open(programs) {
    if (!navigator.gpu) throw new Error("this browser has no WebGPU");
    for (let left = TRIES - 1; ; left--) {
      try {
        return await Gpu.openOnce(programs);
      } catch (error) {
        if (!left) throw error;
      }
      await new Promise((next) => setTimeout(next, APART));
    }
  }

  /** @param {Programs} programs */
  static async openOnce(programs) {
    const adapter = await navigator.gpu.requestAdapter({ powerPreference: "high-performance" });
    if (!adapter) throw new Error("WebGPU finds no graphics adapter here");
    const wanted = /** @type {const} */ ([
      "maxStorageBufferBindingSize",
      "maxBufferSize",
      "maxTextureDimension2D",
      "maxStorageBuffersPerShaderStage",
    ]);
    const device = await adapter.requestDevice({
      requiredLimits: Object.fromEntries(wanted.map((name) => [name, adapter.limits[name]])),
      requiredFeatures: adapter.features.has("timestamp-query") ? ["timestamp-query"] : [],
    });
    return new Gpu(adapter, device, programs);
  }

  /**
   * @param {GPUAdapter} adapter
   * @param {GPUDevice} device
   * @param {Programs} programs
   */
  constructor(adapter, device, programs) {
    this.programs = programs;
    this.adapter = adapter;
    this.device = device;
    this.limits = device.limits;
    /** @type {Map<string, Promise<Compiled>>} */
    this.pipelines = new Map();
    this.lost = false;
    this.compiled = 0; // number of pipelines that were compiled
    /** @type {(mode: GPUAddressMode) => GPUSampler} */
    const sampler = (mode) => device.createSampler({ addressModeU: mode, addressModeV: mode });
    this.samplers = { wrap: sampler("repeat"), clamp: sampler("clamp-to-edge") };
    this.stamps = device.features.has("timestamp-query") ? this.timing() : null;
  }

  /** @returns {Stamps} */
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

  /**
   * Resolve the timestamps of `count` programs, which may then be read.
   * @param {number} count
   */
  resolveStamps(count) {
    const { device } = this;
    const stamps = /** @type {Stamps} */ (this.stamps);
    const encoder = device.createCommandEncoder();
    encoder.resolveQuerySet(stamps.queries, 0, 2 * count, stamps.resolved, 0);
    encoder.copyBufferToBuffer(stamps.resolved, 0, stamps.read, 0, 16 * count);
    device.queue.submit([encoder.finish()]);
    stamps.count = count;
  }

  // Their total in milliseconds; no program may be timed before this is read.
  async readStamps() {
    const { read, count } = /** @type {Stamps} */ (this.stamps);
    await read.mapAsync(GPUMapMode.READ);
    const times = new BigUint64Array(read.getMappedRange());
    let sum = 0;
    for (let k = 0; k < count; k++) sum += Number(times[2 * k + 1] - times[2 * k]) * 1e-6;
    read.unmap();
    return sum;
  }

  /**
   * The pipeline of a linked program, made once; rejects with what the compiler says, and is not
   * compiled again.
   * @param {Program} program
   * @returns {Promise<Compiled>}
   */
  pipeline(program) {
    const { key } = program;
    const known = this.pipelines.get(key);
    if (known) return known;
    const made = this.build(program);
    this.pipelines.set(key, made);
    made.catch(() => {});
    return made;
  }

  /**
   * @param {Program} program
   * @returns {Promise<Compiled>}
   */
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
    return { pipeline, program };
  }

  /**
   * A compute pipeline of the page's own WGSL.
   * @param {string} code
   * @param {string} label
   */
  ownPipeline(code, label) {
    const module = this.device.createShaderModule({ code, label });
    const compute = { module, entryPoint: "main" };
    return this.device.createComputePipeline({ layout: "auto", compute });
  }

  /**
   * @param {GPURenderPipeline | GPUComputePipeline} pipeline
   * @param {GPUBindingResource[]} resources in the order of their bindings
   */
  bindGroup(pipeline, resources) {
    // older browsers take no buffer by itself
    const entries = resources.map((each, binding) => ({
      binding,
      resource: each instanceof GPUBuffer ? { buffer: each } : each,
    }));
    return this.device.createBindGroup({ layout: pipeline.getBindGroupLayout(0), entries });
  }

  /**
   * Run a compute pipeline.
   * @param {GPUComputePipeline} pipeline
   * @param {GPUBindingResource[]} resources in the order of their bindings
   * @param {number[]} groups along x and y
   * @param {GPUComputePassTimestampWrites} [timestampWrites]
   */
  compute(pipeline, resources, [x, y = 1], timestampWrites) {
    const encoder = this.device.createCommandEncoder();
    const pass = encoder.beginComputePass({ timestampWrites });
    pass.setPipeline(pipeline);
    pass.setBindGroup(0, this.bindGroup(pipeline, resources));
    pass.dispatchWorkgroups(x, y);
    pass.end();
    this.device.queue.submit([encoder.finish()]);
  }

  /**
   * @param {ArrayBuffer} bytes
   * @param {GPUBufferUsageFlags} usage
   */
  buffer(bytes, usage) {
    const size = Math.max(16, bytes.byteLength);
    const made = this.device.createBuffer({ size, usage: usage | GPUBufferUsage.COPY_DST });
    this.device.queue.writeBuffer(made, 0, bytes);
    return made;
  }

  /**
   * A texture with all its levels.
   * @param {Level<Uint16Array | Float32Array>[]} levels
   * @param {boolean} heights
   */
  texture(levels, heights) {
    const [{ width, height }] = levels;
    const texture = this.emptyTexture([width, height], heights, levels.length);
    levels.forEach((level, mipLevel) => {
      this.device.queue.writeTexture(
        { texture, mipLevel },
        level.texels,
        { bytesPerRow: level.width * this.format(heights)[1], rowsPerImage: level.height },
        [level.width, level.height],
      );
    });
    return texture;
  }

  /**
   * Format of the texels of heights or of four channels, and their bytes.
   * @param {boolean} heights
   */
  format(heights) {
    return this.programs.formats[heights ? "HeightField" : "Texture"];
  }

  /**
   * A texture of zeros, to be filled later.
   * @param {Pair} size
   * @param {boolean} heights
   * @param {number} mipLevelCount
   */
  emptyTexture([width, height], heights, mipLevelCount = 1) {
    const most = this.limits.maxTextureDimension2D;
    if (Math.max(width, height) > most) {
      throw new Error(`a map of ${width} × ${height} is larger than this GPU takes (${most})`);
    }
    const usage = GPUTextureUsage;
    return this.device.createTexture({
      size: [width, height],
      format: this.format(heights)[0],
      mipLevelCount,
      usage: usage.TEXTURE_BINDING | usage.COPY_DST | usage.COPY_SRC,
    });
  }

  /**
   * Run an action on the GPU; `failed` rejects where the GPU refuses it.
   * @template T
   * @param {() => T} act
   * @returns {{ value: T, failed: Promise<void> }}
   */
  checked(act) {
    const { device } = this;
    const filters = /** @type {const} */ (["out-of-memory", "validation"]);
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

  /**
   * A buffer of `count` planes of a picture, which programs write.
   * @param {number} count
   * @param {number} width
   * @param {number} height
   */
  planes(count, width, height) {
    const usage = GPUBufferUsage.STORAGE | GPUBufferUsage.COPY_SRC;
    return this.device.createBuffer({ size: 4 * count * width * height, usage });
  }

  /**
   * The content of a texture of four channels, row by row.
   * @param {GPUTexture} texture
   */
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

  /** @param {GPUBuffer} buffer */
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

/**
 * The number of rows after which a binding may start: a multiple of 256 bytes.
 * @param {number} width
 */
export function rowsApart(width) {
  let rows = 64;
  while (rows > 1 && ((rows / 2) * width) % 64 === 0) rows /= 2;
  return rows;
}

// A program with its arguments, to be run on rows of a picture any number of times.
export class Job {
  /**
   * @param {Gpu} gpu
   * @param {Compiled} made
   * @param {Data} data
   */
  constructor(gpu, made, data) {
    this.gpu = gpu;
    this.made = made;
    this.data = data;
    /** @type {Map<string, GPUBuffer>} */
    this.uniforms = new Map();
    /** @type {ProgramValues} */
    this.textures = {};
    const bytes = 4 * gpu.programs.run.length;
    this.run = gpu.buffer(new ArrayBuffer(bytes), GPUBufferUsage.UNIFORM);
  }

  /**
   * `values` by name: records, lists of them, textures; nothing is compiled for a new one.
   * @param {ProgramValues} values
   */
  put(values) {
    const { gpu, data } = this;
    for (const { kind, name, type } of this.made.program.bindings) {
      if ((kind !== "uniform" && kind !== "buffer") || values[name] instanceof GPUBuffer) continue;
      const bytes =
        kind === "uniform"
          ? pack(type, /** @type {Value} */ (values[name]), data.records)
          : packList(type, /** @type {Value[]} */ (values[name]), data.records);
      const buffer = this.uniforms.get(name);
      if (buffer && buffer.size >= bytes.byteLength) {
        gpu.device.queue.writeBuffer(buffer, 0, bytes);
      } else {
        buffer?.destroy();
        const usage = kind === "uniform" ? GPUBufferUsage.UNIFORM : GPUBufferUsage.STORAGE;
        this.uniforms.set(name, gpu.buffer(bytes, usage));
      }
    }
    this.textures = values;
  }

  /**
   * Compute rows first … last − 1 of a picture into planes that hold `height` rows from `top` on;
   * `first` is a multiple of `rowsApart` beyond that. `stamp` says as which of those timed.
   * @param {GPUBuffer} planes
   * @param {Pair} size
   * @param {number} first
   * @param {number} last
   * @param {{ stamp?: number | null, top?: number }} options
   */
  dispatch(planes, [width, height], first, last, { stamp = null, top = 0 } = {}) {
    const { gpu } = this;
    const { pipeline, program } = this.made;
    const run = {
      width,
      first_row: first,
      last_row: last,
      plane_row: first,
      plane_stride: width * height,
    };
    const words = new Uint32Array(gpu.programs.run.map((word) => run[word]));
    gpu.device.queue.writeBuffer(this.run, 0, words);
    const offset = 4 * width * (first - top);
    const resources = program.bindings.map(({ kind, name }) => {
      if (kind === "run") return this.run;
      if (kind === "planes") return { buffer: planes, offset };
      if (kind === "sampler") return gpu.samplers[program.edge];
      const value = this.textures[name];
      if (kind === "map") return /** @type {Viewable} */ (value).createView();
      if (value instanceof GPUBuffer) return value;
      return /** @type {GPUBuffer} */ (this.uniforms.get(name));
    });
    const timestampWrites =
      gpu.stamps && stamp !== null
        ? {
            querySet: gpu.stamps.queries,
            beginningOfPassWriteIndex: 2 * stamp,
            endOfPassWriteIndex: 2 * stamp + 1,
          }
        : undefined;
    const [across, down] = gpu.programs.group;
    const groups = [Math.ceil(width / across), Math.ceil((last - first) / down)];
    gpu.compute(pipeline, resources, groups, timestampWrites);
  }

  destroy() {
    for (const each of [this.run, ...this.uniforms.values()]) each.destroy();
  }
}

/**
 * @param {Binding} bound
 * @param {number} binding its number
 * @returns {GPUBindGroupLayoutEntry}
 */
function layoutEntry({ kind, access }, binding) {
  const visibility = GPUShaderStage.COMPUTE;
  if (kind === "map") return { binding, visibility, texture: { sampleType: access } };
  if (kind === "sampler") return { binding, visibility, sampler: { type: access } };
  return { binding, visibility, buffer: { type: access } };
}
