// Thumbnails of maps.

import { encoded } from "view/srgb.js";

/** @import { Picture } from "view/maps.js" */
/** @import { Pair } from "view/data" */

const SIDE = 88; // pixels of the longer side
const READS = 4; // texels a side that are averaged for a pixel, at most
/**
 * Canvases by picture and channels.
 * @type {WeakMap<Picture, { [channels: string]: HTMLCanvasElement }>}
 */
const canvases = new WeakMap();

/**
 * The canvas of a map's channels: one as grey, three as colour, which `light` says to encode.
 * @param {Picture} picture
 * @param {number[]} channels
 * @param {boolean} light
 */
export function thumbnail(picture, channels, light = false) {
  const known = canvases.get(picture) ?? {};
  canvases.set(picture, known);
  const name = channels.join();
  known[name] ??= drawn(picture, channels, light);
  return known[name];
}

/**
 * @param {Picture} picture
 * @param {number[]} channels
 * @param {boolean} light
 */
function drawn({ width, height, count = 4, texels }, channels, light) {
  const share = SIDE / Math.max(width, height);
  /** @type {Pair} */
  const whole = [width, height];
  const size = whole.map((n) => Math.max(1, Math.round(n * share)));
  const canvas = document.createElement("canvas");
  [canvas.width, canvas.height] = size;
  const context = /** @type {CanvasRenderingContext2D} */ (canvas.getContext("2d"));
  const image = context.createImageData(...size);
  /** @type {(mean: number) => number} */
  const code = (mean) => 255 * (light ? encoded(mean / 65535) : mean / 65535);
  for (let y = 0, to = 0; y < size[1]; y++) {
    const rows = places(y, size[1], height);
    for (let x = 0; x < size[0]; x++, to += 4) {
      const columns = places(x, size[0], width);
      const means = channels.map((channel) => {
        let sum = 0;
        for (const row of rows) {
          for (const column of columns) sum += texels[(row * width + column) * count + channel];
        }
        return code(sum / rows.length / columns.length);
      });
      const [r, g = r, b = r] = means;
      image.data.set([r, g, b, 255], to);
    }
  }
  context.putImageData(image, 0, 0);
  return canvas;
}

/**
 * The indices of the `have` texels that a pixel of `want` averages.
 * @param {number} pixel
 * @param {number} want
 * @param {number} have
 */
function places(pixel, want, have) {
  const each = Math.max(1, Math.min(READS, Math.floor(have / want)));
  return Array.from({ length: each }, (_, k) =>
    Math.min(have - 1, Math.floor(((pixel + (k + 0.5) / each) * have) / want)),
  );
}
