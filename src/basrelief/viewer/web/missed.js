// Missed hits of a picture, by the library's own shader (`shading.missed_hit`).

/** @import { Pair } from "view/data" */
/** @import { Gpu, Job, ProgramValues } from "view/gpu.js" */

// A program reads the pixels of a picture as a list of records, behind their count.
const LIST = `
@group(0) @binding(0) var<storage, read> planes: array<u32>;
@group(0) @binding(1) var<storage, read_write> list: array<vec4u>;

@compute @workgroup_size(256)
fn main(@builtin(global_invocation_id) id: vec3u) {
  let area = arrayLength(&list) - 1u;
  let p = id.x;
  if (p >= area) { return; }
  if (p == 0u) { list[0] = vec4u(area, 0u, 0u, 0u); }
  // of the planes color.xyzw, depth, uv.xy, hit, reads
  list[p + 1u] = vec4u(planes[p + 5u * area], planes[p + 6u * area], planes[p + 7u * area], 0u);
}
`;

export class MissedHits {
  /**
   * @param {Gpu} gpu
   * @param {Job} job of the program `missed_hit`
   */
  constructor(gpu, job) {
    this.gpu = gpu;
    this.job = job;
    this.pipeline = gpu.ownPipeline(LIST, "list");
    /** @type {{ drawn?: GPUBuffer, truth?: GPUBuffer }} */
    this.lists = {};
  }

  /**
   * Find the missed hits of a picture: in `planes`, which pixels miss and which have passed through
   * a feature.
   * @param {GPUBuffer} planes
   * @param {{ drawn: GPUBuffer, truth: GPUBuffer }} pictures
   * @param {Pair} size
   * @param {Pair} texels of the heights
   * @param {ProgramValues} values that the truth was drawn with
   */
  find(planes, pictures, size, texels, values) {
    const [width, height] = size;
    const drawn = this.list("drawn", pictures.drawn, width * height);
    const truth = this.list("truth", pictures.truth, width * height);
    this.job.put({ ...values, picture: { width, texels }, drawn, truth });
    this.job.dispatch(planes, size, 0, height);
  }

  /**
   * @param {"drawn" | "truth"} name
   * @param {GPUBuffer} planes
   * @param {number} area pixels
   */
  list(name, planes, area) {
    const size = 16 * (area + 1);
    let list = this.lists[name];
    if (list?.size !== size) {
      list?.destroy();
      list = this.gpu.device.createBuffer({ size, usage: GPUBufferUsage.STORAGE });
      this.lists[name] = list;
    }
    this.gpu.compute(this.pipeline, [planes, list], [Math.ceil(area / 256)]);
    return list;
  }

  destroy() {
    this.lists.drawn?.destroy();
    this.lists.truth?.destroy();
    this.job.destroy();
  }
}
