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
// A name that is used: not a field, nor the name of a parameter.
const NAME = /(?<![.\w])[A-Za-z_]\w*(?!\w|\s*:)/g;

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

/** @type {Map<string, Set<string>>} */
const names = new Map();

/**
 * The distinct names in a text without comments; cached, since few texts change.
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
  const texts = new Map([["", decided(entries[entry], conditions, choices)]]);
  // texts that are added during the iteration are visited too
  for (const text of texts.values()) {
    for (const name of namesIn(text)) {
      const piece = texts.has(name) ? undefined : pieceOf(programs, name, bound);
      if (piece !== undefined) texts.set(name, decided(piece, conditions, choices));
    }
  }
  const code = [...texts.values()].join("\n");
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
 * @returns {string | undefined}
 */
function pieceOf({ pieces, slots }, name, bound) {
  if (!Object.hasOwn(slots, name)) return Object.hasOwn(pieces, name) ? pieces[name] : undefined;
  const wanted = bound.get(name);
  if (wanted === undefined || !Object.hasOwn(slots[name], wanted)) {
    throw new Error(`the page has no ${name} as ${wanted}`);
  }
  return slots[name][wanted];
}
