// sRGB, as `picture.srgb_encode` and `srgb_decode` have it, of numbers from 0 to 1.

/** @type {(x: number) => number} */
export const encoded = (x) => (x <= 0.0031308 ? 12.92 * x : 1.055 * x ** (1 / 2.4) - 0.055);
/** @type {(x: number) => number} */
export const decoded = (x) => (x <= 0.04045 ? x / 12.92 : ((x + 0.055) / 1.055) ** 2.4);
