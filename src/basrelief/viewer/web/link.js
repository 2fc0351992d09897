// Linking of programs from the pieces that `lang.library` prints.

/** @import { Binding, Condition, Programs } from "view/data" */

/**
 * The values of static conditions by name, and the bindings of slots.
 * @typedef {{ [name: string]: unknown, "map.edge": Edge }} Choices
 */
/**
 * A whole program.
 * @typedef {{ key: string, entry: string, code: string, bindings: Binding[], edge: Edge }} Program
 */
/** @typedef {"wrap" | "clamp"} Edge */

// Two texts under the number of a static condition, no other such texts within them.
const STATIC = /\ue000(\d+)\ue001([^\ue000-\ue003]*)\ue002([^\ue000-\ue003]*)\ue003/g;
// On both sides of the name of a piece, where it is used.
const NAME = "\ue004";

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
 * A text with its static conditions decided, innermost first.
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

/**
 * Link an entry with the slots of the choices: its WGSL, its bindings, and a key that programs of the
 * same text share.
 * @param {Programs} programs
 * @param {string} entry
 * @param {Choices} choices
 * @returns {Program}
 */
export function linked(programs, entry, choices) {
  const { entries, bindings, conditions } = programs;
  const bound = new Map(
    Object.entries(programs.bound).flatMap(([menu, of]) =>
      Object.entries(of[String(choices[menu])] ?? {}),
    ),
  );
  // each text without its marks, names of pieces at odd places
  const split = (/** @type {string} */ text) => decided(text, conditions, choices).split(NAME);
  const texts = new Map([["", split(entries[entry])]]);
  // texts that are added during the iteration are visited too
  for (const parts of texts.values()) {
    for (let k = 1; k < parts.length; k += 2) {
      if (!texts.has(parts[k])) texts.set(parts[k], split(pieceOf(programs, parts[k], bound)));
    }
  }
  const code = [...texts.values()].map((parts) => parts.join("")).join("\n");
  const edge = choices["map.edge"];
  return {
    // the sampler depends on the edge too, which is in no piece
    key: [entry, edge, code].join("\n"),
    entry,
    code,
    bindings: bindings[entry].map((each) => ({ ...each, type: bound.get(each.type) ?? each.type })),
    edge,
  };
}

/**
 * A piece by its name, which may be any, as in a user's shaders.
 * @param {Programs} programs
 * @param {string} name
 * @param {Map<string, string>} bound what each slot is bound to
 * @returns {string}
 */
function pieceOf({ pieces, slots }, name, bound) {
  if (!Object.hasOwn(slots, name)) return pieces[name];
  const wanted = bound.get(name);
  if (wanted === undefined || !Object.hasOwn(slots[name], wanted)) {
    throw new Error(`the page has no ${name} as ${wanted}`);
  }
  return slots[name][wanted];
}
