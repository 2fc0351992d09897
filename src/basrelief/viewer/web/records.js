// Packing of records into the words of GPU buffers, by the layouts of the page.

/** @import { Layouts } from "view/data" */

/**
 * A value of a record's field; matrices are lists of nine, column by column.
 * @typedef {number | number[] | { [field: string]: Value }} Value
 */

const ints = new Set(["int", "IVec2"]);

/**
 * @param {DataView} view
 * @param {number} word
 * @param {string} type
 * @param {Value} value
 * @param {Layouts} layouts
 */
function put(view, word, type, value, layouts) {
  const layout = layouts[type];
  if (layout && !layout.scalars) {
    const record = /** @type {{ [field: string]: Value }} */ (value);
    for (const [name, inner, offset] of layout.fields) {
      if (record[name] === undefined) throw new Error(`the record ${type} needs ${name}`);
      put(view, word + offset, inner, record[name], layouts);
    }
    return;
  }
  const numbers = /** @type {number[]} */ ([value].flat());
  for (const [k, x] of numbers.entries()) {
    const place = 4 * (word + (layout?.scalars ? layout.scalars[k] : k));
    if (ints.has(type)) view.setInt32(place, x, true);
    else view.setFloat32(place, x, true);
  }
}

/**
 * @param {string} type
 * @param {Value} value
 * @param {Layouts} layouts
 */
export function pack(type, value, layouts) {
  const view = new DataView(new ArrayBuffer(4 * layouts[type].words));
  put(view, 0, type, value, layouts);
  return view.buffer;
}

/**
 * A list: its count, padded to the alignment of its items, and its items; at least one of zeros.
 * @param {string} type
 * @param {Value[]} items
 * @param {Layouts} layouts
 */
export function packList(type, items, layouts) {
  const { words, align } = layouts[type];
  const view = new DataView(new ArrayBuffer(4 * (align + words * Math.max(items.length, 1))));
  view.setInt32(0, items.length, true);
  for (const [k, item] of items.entries()) put(view, align + k * words, type, item, layouts);
  return view.buffer;
}
