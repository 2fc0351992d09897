// Programs put together from their pieces, as `lang.library.linked` does it.

/** @import { Binding, Condition, Programs, Tree } from "view/data" */

/**
 * Answers to the questions of trees, and values of static fields.
 * @typedef {{ [question: string]: unknown }} Choices
 */
/**
 * A whole program.
 * @typedef {{ key: string, entry: string, code: string, bindings: Binding[], edge: Edge }} Program
 */
/** @typedef {"wrap" | "clamp"} Edge */

// Two texts under the number of a static condition, no other such texts within them.
const STATIC = /\ue000(\d+)\ue001([^\ue000-\ue003]*)\ue002([^\ue000-\ue003]*)\ue003/g;
// A name that is used: not a field, nor the name of a parameter.
const NAME = /(?<![.\w])[A-Za-z_]\w*(?!\w|\s*:)/g;

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
 * Whether a static condition is true of choices.
 * @param {Condition} condition
 * @param {Choices} choices
 * @returns {boolean}
 */
export function holds(condition, choices) {
  const [word, a, b] = /** @type {[string, any, any]} */ (condition);
  if (word === "not") return !holds(a, choices);
  if (word === "and") return holds(a, choices) && holds(b, choices);
  if (word === "or") return holds(a, choices) || holds(b, choices);
  if (!Object.hasOwn(choices, word)) throw new Error(`the page chooses no ${word}`);
  return a.includes(choices[word]);
}

/**
 * A text with what static conditions leave of it, the innermost decided first.
 * @param {string} text
 * @param {Condition[]} conditions
 * @param {Choices} choices
 * @returns {string}
 */
function decided(text, conditions, choices) {
  const chosen = text.replace(STATIC, (_, k, then, otherwise) =>
    holds(conditions[k], choices) ? then : otherwise,
  );
  return chosen === text ? text : decided(chosen, conditions, choices);
}

/** @type {Map<string, Set<string>>} */
const names = new Map();

/**
 * The names in a text, its comments left out, each once; found once, since few texts change.
 * @param {string} text
 */
function namesIn(text) {
  let found = names.get(text);
  if (!found) {
    found = new Set(text.replace(/\/\/.*/g, "").match(NAME));
    names.set(text, found);
  }
  return found;
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
  const { entries, bindings, trees, edge, conditions } = programs;
  // the sampler goes by the edge too, which no piece tells
  const chosenEdge = /** @type {Edge} */ (answered(trees[edge], choices));
  /** @type {Map<string, string>} */
  const bound = new Map([[edge, chosenEdge]]);
  const texts = new Map([["", decided(entries[entry], conditions, choices)]]);
  // those that are added while this goes on are gone through too
  for (const text of texts.values()) {
    for (const name of namesIn(text)) {
      const piece = texts.has(name) ? undefined : pieceOf(programs, name, bound, choices);
      if (piece !== undefined) texts.set(name, decided(piece, conditions, choices));
    }
  }
  const code = [...texts.values()].join("\n");
  return {
    key: [entry, chosenEdge, code].join("\n"),
    entry,
    code,
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
 * @returns {string | undefined}
 */
function pieceOf({ pieces, slots, trees }, name, bound, choices) {
  if (!Object.hasOwn(slots, name)) return Object.hasOwn(pieces, name) ? pieces[name] : undefined;
  const wanted = bound.get(name) ?? answered(trees[name], choices);
  bound.set(name, wanted);
  if (!Object.hasOwn(slots[name], wanted)) throw new Error(`the page has no ${name} as ${wanted}`);
  return slots[name][wanted];
}
