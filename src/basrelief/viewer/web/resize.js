// Resizing of single channels.

import { roundEven } from "view/maps.js";

/**
 * As `images.resize.resized`: enlarged bilinearly, reduced to area averages, seamless at the edges,
 * rows before columns.
 * @param {Uint16Array} channel
 * @param {{ width: number, height: number }} size
 * @param {{ width: number, height: number }} wanted
 */
export function resized(channel, { width, height }, wanted) {
  const rows = stretched(channel, height, wanted.height, width, true);
  return stretched(rows, width, wanted.width, wanted.height, false);
}

/**
 * One axis of `have` texels brought to `want`, on `lines` lines that lie beside one another.
 * @param {Uint16Array} from
 * @param {number} have
 * @param {number} want
 * @param {number} lines
 * @param {boolean} down whether the axis is that of the rows
 */
function stretched(from, have, want, lines, down) {
  if (have === want) return from;
  const step = down ? lines : 1;
  const across = down ? [1, 1] : [have, want];
  const made = new Uint16Array(want * lines);
  if (want < have) {
    for (let line = 0; line < lines; line++) {
      averaged(from, have, line * across[0], made, want, line * across[1], step);
    }
    return made;
  }
  for (let k = 0; k < want; k++) {
    const place = ((k + 0.5) * have) / want - 0.5;
    const [first, share] = [Math.floor(place), place - Math.floor(place)];
    const [a, b] = [(first + have) % have, (first + 1) % have].map((n) => n * step);
    for (let line = 0; line < lines; line++) {
      const mix = from[a + line * across[0]] * (1 - share) + from[b + line * across[0]] * share;
      made[k * step + line * across[1]] = roundEven(mix);
    }
  }
  return made;
}

/**
 * Means of a line of `have` texels: texel k of `want` covers k · have ÷ want to (k + 1) · have ÷ want.
 * @param {Uint16Array} from
 * @param {number} have
 * @param {number} start of the line
 * @param {Uint16Array} made
 * @param {number} want
 * @param {number} target start of the line in `made`
 * @param {number} step between texels of the line
 */
function averaged(from, have, start, made, want, target, step) {
  let [sum, n, before] = [0, 0, 0]; // sum of the first n texels, and up to the last end
  for (let k = 0; k < want; k++) {
    const end = ((k + 1) * have) / want;
    for (; n < Math.floor(end); n++) sum += from[start + n * step];
    const below = n < have ? sum + (end - n) * from[start + n * step] : sum;
    made[target + k * step] = roundEven(((below - before) * want) / have);
    before = below;
  }
}
