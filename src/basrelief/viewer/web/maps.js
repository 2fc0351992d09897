// Maps of the page or of dropped pictures, and their mip levels.

/** @import { PackedMap } from "view/data" */

/**
 * A map of one or four 16-bit channels, row by row from the top. `dropped` marks an emission map
 * that a user has dropped.
 * @typedef {{ width: number, height: number, count?: number, texels: Uint16Array,
 *   dropped?: boolean }} Picture
 */
/**
 * A level of a map.
 * @template {Uint16Array | Float32Array} Texels
 * @typedef {{ width: number, height: number, texels: Texels }} Level
 */

/**
 * @param {string} text in base64
 * @returns {Uint8Array<ArrayBuffer>}
 */
export function bytesOf(text) {
  if (Uint8Array.fromBase64) return Uint8Array.fromBase64(text);
  const raw = atob(text);
  const bytes = new Uint8Array(raw.length);
  for (let k = 0; k < raw.length; k++) bytes[k] = raw.charCodeAt(k);
  return bytes;
}

/** @param {BlobPart} bytes */
export async function inflated(bytes) {
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

/**
 * The finest level of a packed map.
 * @param {PackedMap} map
 * @param {string} content
 * @returns {Promise<Picture>}
 */
export async function unpacked({ width, height, channels }, content) {
  const bytes = await inflated(bytesOf(content));
  const [area, count] = [width * height, channels.length];
  const texels = new Uint16Array(area * count);
  let at = 0;
  channels.forEach(({ constant, palette, same }, c) => {
    let last = 0;
    if (same !== undefined) {
      for (let k = 0; k < area; k++) texels[k * count + c] = texels[k * count + same];
      return;
    }
    for (let k = 0; k < area; k++) {
      if (constant !== undefined) last = constant;
      else if (palette) last = (last + bytes[at + k]) & 0xff;
      else last = (last + bytes[at + k] + (bytes[at + area + k] << 8)) & 0xffff;
      texels[k * count + c] = palette ? palette[last] : last;
    }
    at += constant !== undefined ? 0 : palette ? area : 2 * area;
  });
  return { width, height, count, texels };
}

/**
 * A map of one texel, in place of a missing one.
 * @type {(values: number[]) => Picture}
 */
export const single = (values) => ({
  width: 1,
  height: 1,
  count: values.length,
  texels: Uint16Array.from(values),
});

/**
 * Whether a map of four channels is transparent anywhere.
 * @param {Picture} picture
 */
export function hasHoles({ texels }) {
  for (let k = 3; k < texels.length; k += 4) if (texels[k] !== 65535) return true;
  return false;
}

/**
 * Heights as levels of float32, each half of the one before.
 * @param {Picture} picture
 */
export function heightLevels({ width, height, texels }) {
  const first = new Float32Array(texels.length);
  for (let k = 0; k < texels.length; k++) first[k] = texels[k] / 65535;
  return levelsOf({ width, height, texels: first }, (level) => halved(level, 1));
}

/**
 * Mip levels of four 16-bit channels; of a cut-out, colours are weighted by opacity.
 * @param {Picture} picture
 * @param {boolean} cutOut
 */
export function channelLevels({ width, height, texels }, cutOut = false) {
  return levelsOf({ width, height, texels }, (level) => nextLevel(level, cutOut));
}

/**
 * A level and all that are smaller, down to one texel.
 * @template {Uint16Array | Float32Array} Texels
 * @param {Level<Texels>} level
 * @param {(level: Level<Texels>) => Level<Texels>} next
 */
function levelsOf(level, next) {
  const levels = [level];
  let last = level;
  while (Math.max(last.width, last.height) > 1) {
    last = next(last);
    levels.push(last);
  }
  return levels;
}

/**
 * @param {Level<Uint16Array>} level
 * @param {boolean} cutOut
 * @returns {Level<Uint16Array>}
 */
function nextLevel(level, cutOut) {
  if (!cutOut) {
    if (level.width % 2 === 0 && level.height % 2 === 0) return quartered(level);
    const made = halved(level, 4);
    return { ...made, texels: Uint16Array.from(made.texels, roundEven) };
  }
  const weighed = new Float32Array(level.texels.length);
  for (let k = 0; k < weighed.length; k += 4) {
    const weight = level.texels[k + 3] + 1;
    for (let c = 0; c < 3; c++) weighed[k + c] = level.texels[k + c] * weight;
    weighed[k + 3] = weight;
  }
  const made = halved({ ...level, texels: weighed }, 4);
  const plain = halved(level, 4);
  const texels = new Uint16Array(made.texels.length);
  for (let k = 0; k < texels.length; k += 4) {
    const share = made.texels[k + 3];
    // in 32 bits, as NumPy divides: a quotient just beside a half may be rounded onto it
    for (let c = 0; c < 3; c++) texels[k + c] = roundEven(Math.fround(made.texels[k + c] / share));
    texels[k + 3] = roundEven(plain.texels[k + 3]);
  }
  return { ...made, texels };
}

/**
 * `halved` and `roundEven` of a level of even size in integers, ten times as fast.
 * @param {Level<Uint16Array>} level
 */
function quartered({ width, height, texels }) {
  const [row, below] = [4 * width, height >> 1];
  const made = new Uint16Array((texels.length / 4) | 0);
  for (let y = 0, to = 0; y < below; y++) {
    for (let at = 2 * y * row; at < (2 * y + 1) * row; at += 8) {
      for (let c = at; c < at + 4; c++) {
        const sum = texels[c] + texels[c + 4] + texels[c + row] + texels[c + row + 4];
        made[to++] = (sum + 1 + ((sum >> 2) & 1)) >> 2;
      }
    }
  }
  return { width: width >> 1, height: below, texels: made };
}

/** @param {number} x */
export function roundEven(x) {
  const low = Math.floor(x);
  const rest = x - low;
  if (rest !== 0.5) return rest < 0.5 ? low : low + 1;
  return low % 2 === 0 ? low : low + 1;
}

/**
 * As `baking.levels.halved`: rows first, then columns, in 32 bits.
 * @param {Level<Uint16Array | Float32Array>} level
 * @param {number} count channels
 */
function halved({ width, height, texels }, count) {
  const rows = along(texels, height, width * count, 1);
  const below = height === 1 ? 1 : height >> 1;
  const columns = along(rows, width, count, below);
  return { width: width === 1 ? 1 : width >> 1, height: below, texels: columns };
}

/**
 * Halves one axis of n items, each `stride` numbers long, `times` over.
 * @param {Uint16Array | Float32Array} from
 * @param {number} n
 * @param {number} stride
 * @param {number} times
 */
function along(from, n, stride, times) {
  if (n === 1) return Float32Array.from(from);
  const m = n >> 1;
  const made = new Float32Array(m * stride * times);
  const f = Math.fround;
  for (let t = 0; t < times; t++) {
    for (let k = 0; k < m; k++) {
      const [to, at] = [(t * m + k) * stride, (t * n + 2 * k) * stride];
      if (n % 2 === 0) {
        for (let c = 0; c < stride; c++) {
          made[to + c] = f(f(from[at + c]) + f(from[at + stride + c])) * 0.5;
        }
      } else {
        const [before, middle, after] = [f((m - k) / n), f(m / n), f((k + 1) / n)];
        for (let c = 0; c < stride; c++) {
          const sum = f(f(from[at + c] * before) + f(from[at + stride + c] * middle));
          made[to + c] = sum + f(from[at + 2 * stride + c] * after);
        }
      }
    }
  }
  return made;
}
