// Records written into the words that a GPU reads, by the layouts that the page was made with.

const ints = new Set(["int", "IVec2"]);

function put(view, word, type, value, layouts) {
  if (layouts[type]) {
    for (const [name, inner, offset] of layouts[type].fields) {
      if (value[name] === undefined) throw new Error(`the record ${type} needs ${name}`);
      put(view, word + offset, inner, value[name], layouts);
    }
  } else if (type === "Mat3") {
    for (const [k, x] of value.entries()) {
      view.setFloat32(4 * (word + 4 * Math.floor(k / 3) + (k % 3)), x, true);
    }
  } else {
    for (const [k, x] of [value].flat().entries()) {
      const place = 4 * (word + k);
      if (ints.has(type)) view.setInt32(place, x, true);
      else view.setFloat32(place, x, true);
    }
  }
}

export function pack(type, value, layouts) {
  const view = new DataView(new ArrayBuffer(4 * layouts[type].words));
  put(view, 0, type, value, layouts);
  return view.buffer;
}

// A list: its count, padded to the alignment of its items, and its items; at least one of zeros.
export function packList(type, items, layouts) {
  const { words, align } = layouts[type];
  const view = new DataView(new ArrayBuffer(4 * (align + words * Math.max(items.length, 1))));
  view.setInt32(0, items.length, true);
  for (const [k, item] of items.entries()) put(view, align + k * words, type, item, layouts);
  return view.buffer;
}
