// Reading of file names by the library's tables, as in `material.conventions`.

/** @import { Green, Meaning, Names, Slot } from "view/data" */

/**
 * The meaning of a run of words, and the words around it.
 * @typedef {{ slot: Slot | "", over: boolean, around: string[], green?: Green }} Place
 */

/**
 * The entry of a table for a word, which may be any, such as "constructor".
 * @template T
 * @param {{ [word: string]: T | undefined }} table
 * @param {string} word
 */
const known = (table, word) => (Object.hasOwn(table, word) ? table[word] : undefined);

/**
 * The slot of a file and the options for reading it: { slot, polarity, green }, or null.
 * @param {string} fileName
 * @param {Names} names
 */
export function meaningOf(fileName, names) {
  const words = wordsOf(fileName.replace(/\.[^.]*$/, ""), names);
  const found = placeOf(words, names);
  if (!found) return null;
  const { slot, over, around } = found;
  const turned = around.some((word) => names.inverted.includes(word));
  const turns = turned && ["height", "roughness"].includes(slot);
  const green = found.green ?? around.map((word) => known(names.green, word)).find(Boolean);
  return { slot, polarity: over !== turns ? "depth" : "height", green: green ?? "gl" };
}

/**
 * @param {string} stem
 * @param {Names} names
 */
function wordsOf(stem, { sizes, word, formats, resolutions }) {
  const text = stem.replace(new RegExp(sizes, "gi"), " ").replace(/d3d/gi, "Directx");
  return [...text.matchAll(new RegExp(word, "g"))]
    .map(([found]) => found)
    .filter((found) => !formats.includes(found.toLowerCase()) && !resolutions.includes(found))
    .map((found) => found.toLowerCase());
}

/**
 * The last run of words that is known, the longest first.
 * @param {string[]} words
 * @param {Names} names
 * @returns {Place | null}
 */
function placeOf(words, names) {
  const { meanings, unreal, longest } = names;
  const last = known(meanings, known(unreal, words.at(-1) ?? "") ?? "");
  if (words.length > 2 && words[0] === "t" && last) {
    return { slot: last[0], over: last[1], around: words.slice(-2, -1) };
  }
  for (let end = words.length; end > 0; end--) {
    for (let start = Math.max(end - longest, 0); start < end; start++) {
      const run = words.slice(start, end).join("");
      const whole = known(meanings, run);
      const [meaning, green] = whole ? [whole] : withGreen(run, names);
      if (!meaning) continue;
      if (!meaning[0]) return null;
      const around = [...words.slice(0, start).slice(-1), ...words.slice(end)];
      return { slot: meaning[0], over: meaning[1], around, green };
    }
  }
  return null;
}

/**
 * Words written together, such as "normalgl".
 * @param {string} run
 * @param {Names} names
 * @returns {[Meaning, Green] | []}
 */
function withGreen(run, { meanings, green }) {
  for (const [spelling, way] of Object.entries(green)) {
    const meaning = run.endsWith(spelling) && known(meanings, run.slice(0, -spelling.length));
    if (meaning && meaning[0] === "normal") return [meaning, way];
  }
  return [];
}
