// Display of a program's planes: sums of samples, debug pictures, figures. This is the page's own
// WGSL; the library's programs compute the pictures.

/** @import { DebugColors, Pair, Show } from "view/data" */
/** @import { Gpu } from "view/gpu.js" */

/**
 * A drawn picture: its planes, and the sum of its samples, and its missed hits.
 * @typedef {{ planes: GPUBuffer, sum: GPUBuffer, missed: GPUBuffer }} SideBuffers
 */
/**
 * Measurements of a picture.
 * @typedef {object} Figures
 * @property {number} hits pixels that show the object
 * @property {number} reads of all pixels
 * @property {number} most reads of one pixel
 * @property {number} missed pixels
 * @property {number} nearest depth
 * @property {number} furthest depth
 */
/**
 * The parameters of a display pass.
 * @typedef {object} PictureView
 * @property {Pair} size of the drawn picture
 * @property {Pair} canvas
 * @property {Pair} texels of the heights
 * @property {number[]} background
 * @property {number} divider in pixels of the canvas
 * @property {Show} show
 * @property {number} samples
 * @property {Figures} [figures]
 * @property {boolean} [first] whether this is the first sample of the sum
 */

const COMMON = `
struct View {
  size: vec2u,
  canvas: vec2f,
  texels: vec2f,
  background: vec4f,
  divider: f32,
  show: u32,
  samples: f32,
  most_reads: f32,
  nearest: f32,
  furthest: f32,
  first: u32,
}

@group(0) @binding(0) var<uniform> view: View;
// Planes of a picture: color.xyzw, depth, uv.xy, hit, reads.
@group(0) @binding(1) var<storage, read> left: array<u32>;
`;

const ADD = `${COMMON}
@group(0) @binding(2) var<storage, read_write> sum: array<vec4f>;

// Lay a sample over the background and add it to those before.
@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
  if (any(id.xy >= view.size)) { return; }
  let p = id.y * view.size.x + id.x;
  let area = view.size.x * view.size.y;
  let color = vec3f(
    bitcast<f32>(left[p]), bitcast<f32>(left[p + area]), bitcast<f32>(left[p + 2u * area]));
  let there = left[p + 7u * area] != 0u;
  let share = select(0.0, bitcast<f32>(left[p + 3u * area]), there);
  let over = vec4f(view.background.rgb * (1.0 - share) + color * share, 1.0);
  sum[p] = select(sum[p] + over, over, view.first == 1u);
}
`;

const COUNT = `${COMMON}
// Planes: missed, passed.
@group(0) @binding(2) var<storage, read> missed: array<u32>;
struct Row { hits: u32, reads: u32, most: u32, missed: u32, nearest: f32, furthest: f32 }
@group(0) @binding(3) var<storage, read_write> rows: array<Row>;

// One row's figures: reads of the pixels that show the object, missed hits, depths.
@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u) {
  if (id.x >= view.size.y) { return; }
  let area = view.size.x * view.size.y;
  var row = Row(0u, 0u, 0u, 0u, 1e30, 0.0);
  for (var x = 0u; x < view.size.x; x++) {
    let p = id.x * view.size.x + x;
    if (left[p + 7u * area] != 0u) {
      let depth = bitcast<f32>(left[p + 4u * area]);
      row.hits += 1u;
      row.reads += left[p + 8u * area];
      row.most = max(row.most, left[p + 8u * area]);
      row.nearest = min(row.nearest, depth);
      row.furthest = max(row.furthest, depth);
    }
    if (view.show == 2u && missed[p] != 0u) { row.missed += 1u; }
  }
  rows[id.x] = row;
}
`;

const SHOW = `${COMMON}
@group(0) @binding(2) var<storage, read> left_sum: array<vec4f>;
@group(0) @binding(3) var<storage, read> right: array<u32>;
@group(0) @binding(4) var<storage, read> right_sum: array<vec4f>;
@group(0) @binding(5) var<storage, read> left_missed: array<u32>;
@group(0) @binding(6) var<storage, read> right_missed: array<u32>;
@group(0) @binding(7) var<storage, read> heat: array<vec4f>;

@vertex
fn corners(@builtin(vertex_index) k: u32) -> @builtin(position) vec4f {
  return vec4f(f32(k & 1u) * 4.0 - 1.0, f32(k >> 1u) * 4.0 - 1.0, 0.0, 1.0);
}

fn encoded(c: vec3f) -> vec3f {
  let clamped = clamp(c, vec3f(0.0), vec3f(1.0));
  let curve = 1.055 * pow(clamped, vec3f(1.0 / 2.4)) - 0.055;
  return select(curve, clamped * 12.92, clamped <= vec3f(0.0031308));
}

fn heated(share: f32) -> vec3f {
  return heat[u32(round(clamp(share, 0.0, 1.0) * f32(arrayLength(&heat) - 1u)))].rgb;
}

SIDES

@fragment
fn main(@builtin(position) at: vec4f) -> @location(0) vec4f {
  let size = vec2f(view.size);
  let cell = min(vec2u(at.xy / view.canvas * size), view.size - 1u);
  let p = cell.y * view.size.x + cell.x;
  // smooth where the picture is smaller than the canvas
  let place = clamp(at.xy / view.canvas * size - 0.5, vec2f(0.0), size - 1.0);
  let a = vec2u(place);
  let b = min(a + 1u, view.size - 1u);
  let corner = vec4u(
    a.y * view.size.x + a.x, a.y * view.size.x + b.x,
    b.y * view.size.x + a.x, b.y * view.size.x + b.x);
  if (at.x < view.divider) {
    return vec4f(encoded(shown_left(p, corner, fract(place))), 1.0);
  }
  return vec4f(encoded(shown_right(p, corner, fract(place))), 1.0);
}
`;

const SIDE = `
fn averaged_SIDE(corner: vec4u, share: vec2f) -> vec3f {
  let upper = mix(SIDE_sum[corner.x], SIDE_sum[corner.y], share.x);
  let lower = mix(SIDE_sum[corner.z], SIDE_sum[corner.w], share.x);
  return mix(upper, lower, share.y).rgb / view.samples;
}
fn shown_SIDE(p: u32, corner: vec4u, share: vec2f) -> vec3f {
  let area = view.size.x * view.size.y;
  let color = averaged_SIDE(corner, share);
  if (view.show == 0u) { return color; }
  if (view.show == 2u) {
    if (SIDE_missed[p] != 0u) {
      return select(vec3f(SHORT), vec3f(PASSED), SIDE_missed[p + area] != 0u);
    }
    return vec3f((color.r + color.g + color.b) / 12.0);
  }
  if (SIDE[p + 7u * area] == 0u) { return vec3f(0.03); }
  if (view.show == 1u) { return heated(f32(SIDE[p + 8u * area]) / view.most_reads); }
  let depth = bitcast<f32>(SIDE[p + 4u * area]);
  return heated(1.0 - (depth - view.nearest) / max(view.furthest - view.nearest, 1e-6));
}
`;

const WORDS = 24;
const NO_FIGURES = { most: 1, nearest: 0, furthest: 1 };
const shows = ["color", "reads", "missed", "depth"];

export class Colors {
  /**
   * @param {Gpu} gpu
   * @param {HTMLCanvasElement} canvas
   * @param {DebugColors} colors
   */
  constructor(gpu, canvas, colors) {
    this.gpu = gpu;
    const { device } = gpu;
    this.context = /** @type {GPUCanvasContext} */ (canvas.getContext("webgpu"));
    const format = navigator.gpu.getPreferredCanvasFormat();
    const usage = GPUTextureUsage.RENDER_ATTACHMENT | GPUTextureUsage.COPY_SRC;
    this.context.configure({ device, format, usage, alphaMode: "opaque" });
    const sides = ["left", "right"].map((side) => SIDE.replaceAll("SIDE", side));
    const show = SHOW.replace("SIDES", sides.join(""))
      .replaceAll("SHORT", colors.short.join(", "))
      .replaceAll("PASSED", colors.passed.join(", "));
    const module = device.createShaderModule({ code: show, label: "show" });
    this.show = device.createRenderPipeline({
      layout: "auto",
      vertex: { module, entryPoint: "corners" },
      fragment: { module, entryPoint: "main", targets: [{ format }] },
    });
    this.add = gpu.ownPipeline(ADD, "add");
    this.count = gpu.ownPipeline(COUNT, "count");
    const heat = Float32Array.from(colors.heat.flatMap((c) => [...c, 1]));
    this.heat = gpu.buffer(heat.buffer, GPUBufferUsage.STORAGE);
    this.view = gpu.buffer(new ArrayBuffer(4 * WORDS), GPUBufferUsage.UNIFORM);
  }

  /** @param {PictureView} view */
  put({ size, canvas, texels, background, divider, show, samples, figures, first }) {
    const real = new Float32Array(WORDS);
    const whole = new Uint32Array(real.buffer);
    whole.set(size);
    real.set([...canvas, ...texels], 2);
    real.set([...background, divider], 8);
    whole[13] = shows.indexOf(show);
    const { most, nearest, furthest } = figures ?? NO_FIGURES;
    real.set([samples, most || 1, nearest, furthest], 14);
    whole[18] = first ? 1 : 0;
    this.gpu.device.queue.writeBuffer(this.view, 0, real);
  }

  /**
   * Add a whole sample's colours to a sum.
   * @param {SideBuffers} side
   * @param {PictureView} view
   */
  accumulate(side, view) {
    this.put(view);
    const groups = view.size.map((n) => Math.ceil(n / 8));
    this.gpu.compute(this.add, [this.view, side.planes, side.sum], groups);
  }

  /**
   * @param {SideBuffers} left
   * @param {SideBuffers} right
   * @param {PictureView} view
   */
  present(left, right, view) {
    this.put(view);
    const encoder = this.gpu.device.createCommandEncoder();
    const target = this.context.getCurrentTexture().createView();
    const pass = encoder.beginRenderPass({
      colorAttachments: [{ view: target, loadOp: "clear", storeOp: "store" }],
    });
    const shown = [left.planes, left.sum, right.planes, right.sum];
    const buffers = [this.view, ...shown, left.missed, right.missed, this.heat];
    pass.setPipeline(this.show);
    pass.setBindGroup(0, this.gpu.bindGroup(this.show, buffers));
    pass.draw(3);
    pass.end();
    this.gpu.device.queue.submit([encoder.finish()]);
  }

  /**
   * Measure a picture's planes: pixels that show the object, reads, missed hits, depths.
   * @param {SideBuffers} side
   * @param {PictureView} view
   * @returns {Promise<Figures>}
   */
  async figures(side, view) {
    this.put(view);
    const height = view.size[1];
    const rows = this.gpu.planes(6, 1, height);
    const buffers = [this.view, side.planes, side.missed, rows];
    this.gpu.compute(this.count, buffers, [Math.ceil(height / 64)]);
    const words = await this.gpu.read(rows);
    rows.destroy();
    const [whole, real] = [new Uint32Array(words), new Float32Array(words)];
    const found = { hits: 0, reads: 0, most: 0, missed: 0, nearest: Infinity, furthest: 0 };
    for (let k = 0; k < whole.length; k += 6) {
      found.hits += whole[k];
      found.reads += whole[k + 1];
      found.most = Math.max(found.most, whole[k + 2]);
      found.missed += whole[k + 3];
      found.nearest = Math.min(found.nearest, real[k + 4]);
      found.furthest = Math.max(found.furthest, real[k + 5]);
    }
    return found;
  }
}
