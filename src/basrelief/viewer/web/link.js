// Programs put together from their pieces, as `lang.library.linked` does it.

// What a decision tree says: a name, or a question and what follows from each answer.
export function answered(tree, choices) {
  while (Array.isArray(tree)) {
    const [question, then] = tree;
    tree = then[String(choices[question])];
  }
  return tree;
}

// An entry with its slots bound as choices say: its WGSL, what it binds, and a key that programs
// of the same text share.
export function linked({ pieces, slots, entries, bindings, trees }, entry, choices) {
  const [first, uses] = entries[entry];
  const texts = new Map([["", first]]);
  // the sampler goes by the edge too, which no piece tells
  const bound = { edge: answered(trees.edge, choices) };
  const left = [...uses];
  while (left.length) {
    const name = left.pop();
    if (texts.has(name)) continue;
    if (slots[name]) bound[name] = answered(trees[name], choices);
    const piece = slots[name] ? slots[name][bound[name]] : pieces[name];
    if (!piece) throw new Error(`the page has no program for ${name} as ${bound[name]}`);
    texts.set(name, piece[0]);
    left.push(...piece[1]);
  }
  return {
    key: [entry, ...Object.entries(bound).map((each) => each.join(" ")).sort()].join("|"),
    code: [...texts.values()].join("\n"),
    bindings: bindings[entry].map((each) => ({ ...each, type: bound[each.type] ?? each.type })),
    edge: bound.edge,
  };
}
