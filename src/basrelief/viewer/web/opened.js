// Pictures of a material with a hole where its dust lies, as in `material.opening`.

import { merged, without } from "view/dropped.js";
import { roundEven } from "view/maps.js";
import { resized } from "view/resize.js";
import { decoded, encoded } from "view/srgb.js";

/** @import { Data } from "view/data" */
/** @import { Pictures } from "view/dropped.js" */
/** @import { Picture } from "view/maps.js" */

export const OPENING = 0.6; // of a hole that is turned on
const UNIT = 65535;
/**
 * Pictures without occlusion, by the picture that they are made of.
 * @type {WeakMap<Picture, Picture | undefined>}
 */
const unoccluded = new WeakMap();

/**
 * The pictures that are drawn: those of the page without dust and, at an opening other than null, with
 * the heights of a hole. The colour is darkened inside; normals, occlusion and baked tables are those
 * of the heights before, and omitted.
 * @param {Pictures} pictures
 * @param {number | null} opening
 * @param {Data} data
 * @returns {Pictures}
 */
export function opened({ dust, ...pictures }, opening, data) {
  const { field, base_color, response } = pictures;
  if (opening === null || !dust || !field) return pictures;
  const made = without({ ...pictures }, data.slots, "normal");
  for (const { bake } of Object.values(data.techniques)) if (bake) delete made[bake];
  made.field = hole(field, dust, opening, data);
  if (base_color) made.base_color = darkened(base_color, made.field);
  if (response) {
    if (!unoccluded.has(response)) {
      unoccluded.set(response, without({ response }, data.slots, "occlusion").response);
    }
    made.response = unoccluded.get(response);
  }
  return made;
}

/**
 * The heights of a hole: in 32 bits, as NumPy computes them.
 * @param {Picture} field
 * @param {Picture} dust
 * @param {number} opening
 * @param {Data} data
 * @returns {Picture}
 */
function hole(field, dust, opening, { constants }) {
  const f = Math.fround;
  const strength = f(constants.dust_strength * opening);
  const falloff = f(-1 / constants.hole_softness);
  const size = sizeOf(field, dust, constants.proportion);
  const over = resized(dust.texels, dust, size);
  const texels = resized(field.texels, field, size).map((code, k) => {
    const excess = f(f(f(over[k] / UNIT) * strength) - f(code / UNIT));
    return excess > 0 ? roundEven(f(f(Math.exp(f(excess * falloff))) * UNIT)) : UNIT;
  });
  return { ...field, ...size, texels };
}

/**
 * The size of a hole: the material's proportion, and as many texels as the larger map.
 * @param {Picture} field
 * @param {Picture} dust
 * @param {number} proportion
 */
function sizeOf({ width, height }, dust, proportion) {
  const texels = dust.width * dust.height;
  if (texels <= width * height) return { width, height };
  const rows = Math.max(1, roundEven(Math.sqrt(texels / proportion)));
  return { width: Math.max(1, roundEven(rows * proportion)), height: rows };
}

/** @type {{ codes: Float32Array, lights: Uint16Array } | undefined} */
let known;
// Codes of sRGB by those of light, and light by codes.
function curves() {
  const all = { length: UNIT + 1 };
  known ??= {
    codes: Float32Array.from(all, (_, k) => UNIT * encoded(k / UNIT)),
    lights: Uint16Array.from(all, (_, k) => roundEven(UNIT * decoded(k / UNIT))),
  };
  return known;
}

/**
 * A colour map times powers of the height in sRGB: 1½ for red, 2 for green, 2½ for blue. The smaller
 * of the two is resized to the larger.
 * @param {Picture} color
 * @param {Picture} field
 * @returns {Picture}
 */
function darkened(color, field) {
  const { codes, lights } = curves();
  const size = {
    width: Math.max(color.width, field.width),
    height: Math.max(color.height, field.height),
  };
  const inside = resized(field.texels, field, size);
  const whole = color.width === size.width && color.height === size.height;
  const texels = whole ? color.texels.slice() : merged(color, size, {}).texels;
  inside.forEach((code, k) => {
    if (code === UNIT) return;
    const height = code / UNIT;
    const root = Math.sqrt(height);
    const square = height * height;
    const factors = [height * root, square, square * root];
    for (let c = 0; c < 3; c++) {
      const at = 4 * k + c;
      texels[at] = lights[Math.round(codes[texels[at]] * factors[c])];
    }
  });
  return { ...color, ...size, texels };
}
