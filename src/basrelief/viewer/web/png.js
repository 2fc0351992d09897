// PNG decoding with all bits. A canvas has 8, and loses the colours of transparent pixels.

import { inflated } from "view/maps.js";

/**
 * @typedef {object} Header
 * @property {number} width
 * @property {number} height
 * @property {number} bits of a sample
 * @property {number} type of its colours
 * @property {number} interlaced 0 or 1
 */

const SIGNATURE = [137, 80, 78, 71, 13, 10, 26, 10];
/** @type {{ [type: number]: number }} */
const CHANNELS = { 0: 1, 2: 3, 3: 1, 4: 2, 6: 4 }; // by colour type: grey, RGB, palette, with alpha
const PALETTE = 3;
/** @type {{ [type: number]: number }} */
const CLEAR = { 0: 1, 2: 3 }; // samples of the transparent colour

/**
 * The header of a PNG; null for other files.
 * @param {Uint8Array} bytes
 * @returns {Header | null}
 */
export function headerOf(bytes) {
  if (bytes.length < 33 || SIGNATURE.some((byte, k) => bytes[k] !== byte)) return null;
  const view = new DataView(bytes.buffer, bytes.byteOffset);
  const [bits, type, , , interlaced] = bytes.subarray(24, 29);
  return { width: view.getUint32(16), height: view.getUint32(20), bits, type, interlaced };
}

/**
 * Whether `decoded` supports a file; the browser reads others.
 * @param {Header} header
 */
export function isRead({ bits, type, interlaced }) {
  const known = bits === 8 || (bits === 16 && type !== PALETTE);
  return known && type in CHANNELS && interlaced === 0;
}

/**
 * Red, green, blue and alpha of each texel as 16-bit codes, row by row from the top.
 * @param {Uint8Array<ArrayBuffer>} bytes
 * @param {Header} header
 */
export async function decoded(bytes, header) {
  const packed = [];
  /** @type {{ [chunk: string]: Uint8Array }} */
  const parts = {};
  for (const [name, part] of chunks(bytes)) {
    if (name === "IDAT") packed.push(part);
    else parts[name] = part;
  }
  let raw;
  try {
    raw = await inflated(new Blob(packed));
  } catch {
    throw new Error("this PNG is damaged: it cannot be unpacked");
  }
  const { width, height, bits, type } = header;
  const pixel = (CHANNELS[type] * bits) / 8;
  if (raw.length < height * (1 + pixel * width)) {
    throw new Error("this PNG is damaged: rows are missing");
  }
  unfilter(raw, height, pixel * width, pixel);
  return asColors(raw, header, parts);
}

/**
 * @param {Uint8Array<ArrayBuffer>} bytes
 * @returns {Generator<[name: string, part: Uint8Array<ArrayBuffer>]>}
 */
function* chunks(bytes) {
  const view = new DataView(bytes.buffer, bytes.byteOffset);
  for (let at = 8; at + 12 <= bytes.length; ) {
    const length = view.getUint32(at);
    const name = String.fromCharCode(...bytes.subarray(at + 4, at + 8));
    yield [name, bytes.subarray(at + 8, at + 8 + length)];
    at += 12 + length;
  }
}

/**
 * Rows of differences, each with a byte in front that says which, become rows of samples.
 * @param {Uint8Array} raw
 * @param {number} height
 * @param {number} row bytes
 * @param {number} pixel bytes
 */
function unfilter(raw, height, row, pixel) {
  for (let y = 0; y < height; y++) {
    const [from, above] = [y * (row + 1) + 1, (y - 1) * (row + 1) + 1];
    const filter = raw[from - 1];
    if (filter > 4) throw new Error("this PNG is damaged: a row has an unknown filter");
    if (filter === 0) continue;
    for (let k = 0; k < row; k++) {
      const left = k < pixel ? 0 : raw[from + k - pixel];
      const up = y === 0 ? 0 : raw[above + k];
      const corner = y === 0 || k < pixel ? 0 : raw[above + k - pixel];
      let guess = left;
      if (filter === 2) guess = up;
      else if (filter === 3) guess = (left + up) >> 1;
      else if (filter === 4) guess = nearest(left, up, corner);
      raw[from + k] += guess;
    }
  }
}

/**
 * Paeth's predictor: which of three is nearest to left + up − corner.
 * @param {number} left
 * @param {number} up
 * @param {number} corner
 */
function nearest(left, up, corner) {
  const [a, b, c] = [
    Math.abs(up - corner),
    Math.abs(left - corner),
    Math.abs(left + up - 2 * corner),
  ];
  if (a <= b && a <= c) return left;
  return b <= c ? up : corner;
}

/**
 * @param {Uint8Array} raw
 * @param {Header} header
 * @param {{ [chunk: string]: Uint8Array | undefined }} parts
 */
function asColors(raw, { width, height, bits, type }, { PLTE, tRNS }) {
  const [count, wide] = [CHANNELS[type], bits === 16];
  const row = (width * count * bits) / 8 + 1;
  const texels = new Uint16Array(4 * width * height);
  // one colour may be transparent
  const clear = tRNS && CLEAR[type] ? samples(tRNS, CLEAR[type]) : null;
  const found = [0, 0, 0, 0];
  for (let y = 0; y < height; y++) {
    for (let x = 0; x < width; x++) {
      const from = y * row + 1 + (wide ? 2 : 1) * count * x;
      for (let c = 0; c < count; c++) {
        found[c] = wide ? (raw[from + 2 * c] << 8) | raw[from + 2 * c + 1] : raw[from + c];
      }
      const to = 4 * (y * width + x);
      const [one, two, three] = found;
      if (type === PALETTE) {
        for (let c = 0; c < 3; c++) texels[to + c] = (PLTE?.[3 * one + c] ?? 0) * 257;
        texels[to + 3] = (tRNS?.[one] ?? 255) * 257;
        continue;
      }
      const unit = wide ? 1 : 257;
      const grey = count < 3;
      texels[to] = one * unit;
      texels[to + 1] = (grey ? one : two) * unit;
      texels[to + 2] = (grey ? one : three) * unit;
      const alpha = count === 2 || count === 4 ? found[count - 1] * unit : 65535;
      texels[to + 3] = clear?.every((code, c) => code === found[c]) ? 0 : alpha;
    }
  }
  return texels;
}

/**
 * @param {Uint8Array} bytes
 * @param {number} count
 */
function samples(bytes, count) {
  if (bytes.length < 2 * count) throw new Error("this PNG is damaged: its clear colour is cut off");
  return Array.from({ length: count }, (_, c) => (bytes[2 * c] << 8) | bytes[2 * c + 1]);
}
