// Dropped pictures: their texels, with all bits if possible, and the maps made of them.

import { roundEven, single } from "view/maps.js";
import { decoded, headerOf, isRead } from "view/png.js";
import { resized } from "view/resize.js";
import { decoded as inLight } from "view/srgb.js";

/** @import { Slot, Slots } from "view/data" */
/** @import { Picture } from "view/maps.js" */

/**
 * Pictures by name: maps and baked tables.
 * @typedef {{ [name: string]: Picture | undefined }} Pictures
 */
/**
 * Options for reading a picture.
 * @typedef {{ channel: string, polarity: string, green: string }} Reading
 */
/** @typedef {Picture & { bits: number, lost?: boolean }} FilePicture */
/**
 * Channels by their place in a picture.
 * @typedef {{ [c: number]: Uint16Array }} Channels
 */

/**
 * Defaults of textures for missing maps.
 * @type {{ [texture: string]: Picture | undefined }}
 */
const DEFAULTS = {
  base_color: single([39321, 39321, 39321, 65535]),
  response: single([65535, 52428, 0, 65535]),
};

/**
 * { width, height, bits, texels } of four 16-bit channels as they are stored; `lost` where the file
 * has more bits than are read. A side is at most `most` texels long.
 * @param {File} file
 * @param {number} most
 * @returns {Promise<FilePicture>}
 */
export async function pictureOf(file, most) {
  const bytes = new Uint8Array(await file.arrayBuffer());
  const header = headerOf(bytes);
  if (header) check(header, most);
  if (header && isRead(header)) {
    const { width, height, bits } = header;
    return { width, height, bits, texels: await decoded(bytes, header) };
  }
  return { ...(await byCanvas(file, most)), lost: header?.bits === 16 };
}

/**
 * Read a picture by the browser, with 8 bits per channel.
 * @param {File} file
 * @param {number} most
 */
async function byCanvas(file, most) {
  let bitmap;
  try {
    bitmap = await createImageBitmap(file, {
      colorSpaceConversion: "none",
      premultiplyAlpha: "none",
    });
  } catch {
    throw new Error("this is no picture that the browser can read");
  }
  const { width, height } = bitmap;
  check(bitmap, most);
  const canvas = new OffscreenCanvas(width, height);
  const context = /** @type {OffscreenCanvasRenderingContext2D} */ (canvas.getContext("2d"));
  context.drawImage(bitmap, 0, 0);
  const { data } = context.getImageData(0, 0, width, height);
  return { width, height, bits: 8, texels: Uint16Array.from(data, (code) => code * 257) };
}

/**
 * @param {{ width: number, height: number }} size
 * @param {number} most
 */
function check({ width, height }, most) {
  if (Math.max(width, height) > most) {
    const size = `${width} × ${height}`;
    throw new Error(`${size} is larger than this GPU takes (${most} a side); scale it down`);
  }
}

/**
 * The page's pictures with one map, or some channels of one, taken from a dropped picture.
 * @param {Pictures} pictures
 * @param {Slots} slots
 * @param {Slot} slot
 * @param {Picture} picture
 * @param {Reading} how
 * @returns {Pictures}
 */
export function replaced(pictures, slots, slot, picture, { channel, polarity, green }) {
  const { texture, channels, light } = slots[slot] ?? slots.occlusion;
  const one = () => channelOf(picture, channel, polarity === "depth");
  const old = pictures[texture] ?? DEFAULTS[texture] ?? picture;
  const { width, height } = picture;
  switch (slot) {
    case "height":
    case "dust":
      return { ...pictures, [texture]: { width, height, count: 1, texels: one() } };
    case "base_color": {
      const color = withLight(picture);
      // a picture without opacity keeps that of the map, as in the library
      const places = threeOf(color);
      if (varies(picture, 3)) places[3] = channelAt(picture, 3);
      return { ...pictures, base_color: merged(old, picture, places) };
    }
    case "normal":
      return { ...pictures, normal: opaque(green === "dx" ? greenInverted(picture) : picture) };
    case "packed":
      return { ...pictures, [texture]: merged(old, picture, threeOf(picture)) };
  }
  if (channels.length === 1) {
    // a cut-out is often stored as the alpha of a plain picture
    const cutOut = slot === "opacity" && channel === "luminance" && varies(picture, 3);
    const texels = cutOut ? channelAt(picture, 3) : one();
    return { ...pictures, [texture]: merged(old, picture, { [channels[0]]: texels }) };
  }
  return {
    ...pictures,
    [texture]: { ...opaque(light ? withLight(picture) : picture), dropped: true },
  };
}

/**
 * The page's pictures without one map, or with some channels as they are where there is none.
 * @param {Pictures} pictures
 * @param {Slots} slots
 * @param {Slot} slot
 * @returns {Pictures}
 */
export function without(pictures, slots, slot) {
  const left = { ...pictures };
  const { texture, channels } = slots[slot];
  const plain = DEFAULTS[texture];
  if (plain) {
    const none = Object.fromEntries(channels.map((c) => [c, channelAt(plain, c)]));
    left[texture] = merged(left[texture] ?? plain, plain, none);
  } else {
    delete left[texture];
  }
  return left;
}

/**
 * Whether a channel is not the same everywhere.
 * @param {Picture} picture
 * @param {number} c
 */
export function varies({ texels }, c) {
  for (let k = c; k < texels.length; k += 4) if (texels[k] !== texels[c]) return true;
  return false;
}

// --- channels -----------------------------------------------------------------------------------

/**
 * @param {Picture} picture
 * @param {number} c
 */
function channelAt({ width, height, texels }, c) {
  const made = new Uint16Array(width * height);
  for (let k = 0; k < made.length; k++) made[k] = texels[4 * k + c];
  return made;
}

/** @type {(picture: Picture) => Channels} */
const threeOf = (picture) => Object.fromEntries([0, 1, 2].map((c) => [c, channelAt(picture, c)]));

/**
 * @param {Picture} picture
 * @param {string} channel "luminance", or one of "rgba"
 * @param {boolean} over whether white is black
 */
function channelOf(picture, channel, over) {
  const { width, height, texels } = picture;
  let made;
  if (channel === "luminance") {
    made = new Uint16Array(width * height);
    for (let k = 0; k < made.length; k++) {
      const [r, g, b] = [texels[4 * k], texels[4 * k + 1], texels[4 * k + 2]];
      made[k] = Math.round(0.2126 * r + 0.7152 * g + 0.0722 * b);
    }
  } else {
    made = channelAt(picture, "rgba".indexOf(channel));
  }
  return over ? made.map((code) => 65535 - code) : made;
}

/**
 * Colours decoded to linear light.
 * @param {Picture} picture
 */
function withLight(picture) {
  const table = Uint16Array.from({ length: 65536 }, (_, k) =>
    roundEven(inLight(k / 65535) * 65535),
  );
  return {
    ...picture,
    texels: picture.texels.map((code, k) => (k % 4 === 3 ? code : table[code])),
  };
}

/** @type {(picture: Picture) => Picture} */
const opaque = ({ width, height, texels }) => ({
  width,
  height,
  count: 4,
  texels: texels.map((code, k) => (k % 4 === 3 ? 65535 : code)),
});

/** @type {(picture: Picture) => Picture} */
const greenInverted = (picture) => ({
  ...picture,
  texels: picture.texels.map((code, k) => (k % 4 === 1 ? 65535 - code : code)),
});

/**
 * A map with some channels replaced; the smaller of map and channels is resized to the larger.
 * @param {Picture} old
 * @param {{ width: number, height: number }} size of the channels
 * @param {Channels} places
 */
export function merged(old, { width, height }, places) {
  const larger = { width: Math.max(old.width, width), height: Math.max(old.height, height) };
  const texels = new Uint16Array(4 * larger.width * larger.height);
  for (let c = 0; c < 4; c++) {
    const taken = c in places;
    const from = taken ? places[c] : channelAt(old, c);
    const channel = resized(from, taken ? { width, height } : old, larger);
    for (let k = 0; k < channel.length; k++) texels[4 * k + c] = channel[k];
  }
  return { width: larger.width, height: larger.height, count: 4, texels };
}
