// Programs put together from their pieces, as `lang.library.linked` does it.

/** @import { Binding, Piece, Programs, Tree } from "view/data" */

/**
 * Answers to the questions of trees.
 * @typedef {{ [question: string]: unknown }} Choices
 */
/**
 * A whole program.
 * @typedef {{ key: string, code: string, bindings: Binding[], edge: Edge }} Program
 */
/** @typedef {"wrap" | "clamp"} Edge */

/**
 * What a decision tree says: a name, or a question and what follows from each answer.
 * @param {Tree} tree
 * @param {Choices} choices
 * @returns {string}
 */
export function answered(tree, choices) {
  while (Array.isArray(tree)) {
    const [question, then] = tree;
    tree = then[String(choices[question])];
  }
  return tree;
}

/**
 * An entry with its slots bound as choices say: its WGSL, what it binds, and a key that programs
 * of the same text share.
 * @param {Programs} programs
 * @param {string} entry
 * @param {Choices} choices
 * @returns {Program}
 */
export function linked(programs, entry, choices) {
  const { entries, bindings, trees, edge } = programs;
  const [first, uses] = entries[entry];
  const texts = new Map([["", first]]);
  // the sampler goes by the edge too, which no piece tells
  const chosenEdge = /** @type {Edge} */ (answered(trees[edge], choices));
  /** @type {Map<string, string>} */
  const bound = new Map([[edge, chosenEdge]]);
  const left = [...uses];
  for (let name = left.pop(); name !== undefined; name = left.pop()) {
    if (texts.has(name)) continue;
    const [text, more] = pieceOf(programs, name, bound, choices);
    texts.set(name, text);
    left.push(...more);
  }
  return {
    key: [entry, ...[...bound].map((each) => each.join(" ")).sort()].join("|"),
    code: [...texts.values()].join("\n"),
    bindings: bindings[entry].map((each) => ({ ...each, type: bound.get(each.type) ?? each.type })),
    edge: chosenEdge,
  };
}

/**
 * A piece by its name, which may be any: those of a user's own shaders too.
 * @param {Programs} programs
 * @param {string} name
 * @param {Map<string, string>} bound the bindings of slots, extended here
 * @param {Choices} choices
 * @returns {Piece}
 */
function pieceOf({ pieces, slots, trees }, name, bound, choices) {
  if (!Object.hasOwn(slots, name)) return pieces[name];
  const wanted = bound.get(name) ?? answered(trees[name], choices);
  bound.set(name, wanted);
  if (!Object.hasOwn(slots[name], wanted)) throw new Error(`the page has no ${name} as ${wanted}`);
  return slots[name][wanted];
}
