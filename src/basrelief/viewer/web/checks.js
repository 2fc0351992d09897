// Validation of states from sliders, links and notebooks, as the library does it.

/** @import { Data, Light, Limits, Pair, Setting, Values } from "view/data" */
/** @import { State } from "view/state.js" */

/** @typedef {{ [name: string]: unknown }} Fields */
/** @typedef {[low: number | null, high: number | null]} Range */

/** @type {<T>(value: T) => T} */
export const copyOf = (value) => structuredClone(value);

/** @param {unknown} x @returns {x is Fields} */
export const isObject = (x) => x !== null && typeof x === "object" && !Array.isArray(x);
/** @param {unknown} x @returns {x is number} */
const isNumber = (x) => typeof x === "number" && Number.isFinite(x);
// fields that may be null, for values that the page computes, or for none
const NULLABLE = new Set(["distance", "orthographic_height", "opening"]);

/**
 * `base` with the fields of `other` of the same types; unknown fields are ignored.
 * @template {object} T
 * @param {T} base
 * @param {unknown} other
 * @param {Data} data
 * @returns {T}
 */
export function merged(base, other, data) {
  const made = copyOf(base);
  const fields = /** @type {Fields} */ (made);
  for (const [name, value] of Object.entries(isObject(other) ? other : {})) {
    if (!Object.hasOwn(made, name)) continue;
    if (name === "lights") {
      if (Array.isArray(value)) fields.lights = value.map((each) => lightOf(each, data));
      continue;
    }
    const mine = fields[name];
    if (isObject(mine)) fields[name] = merged(mine, value, data);
    else if (fits(mine, value, NULLABLE.has(name))) fields[name] = copyOf(value);
  }
  return made;
}

/**
 * @param {unknown} mine
 * @param {unknown} value
 * @param {boolean} nullable
 */
function fits(mine, value, nullable) {
  if (nullable) return value === null || isNumber(value);
  if (Array.isArray(mine)) {
    return Array.isArray(value) && value.length === mine.length && value.every(isNumber);
  }
  return typeof mine === "number" ? isNumber(value) : typeof mine === typeof value;
}

/**
 * @param {unknown} value
 * @param {Data} data
 * @returns {Light}
 */
function lightOf(value, data) {
  const [usual] = data.defaults.lights;
  const made = merged(usual, value, data);
  return Object.hasOwn(data.lightKinds, made.kind) ? made : { ...made, kind: usual.kind };
}

/**
 * Replace unknown choices and clamp numbers to their ranges, in place.
 * @param {State} state
 * @param {State} start
 * @param {Data} data
 */
export function validated(state, start, data) {
  /** @type {{ [name: string]: unknown[] }} */
  const menus = data.menus;
  /** @type {Fields[]} */
  const [now, then] = [state, start];
  for (const [name, known] of Object.entries(menus)) {
    if (!known.includes(now[name])) now[name] = then[name];
  }
  if (!["", ...data.menus.technique].includes(state.compare)) state.compare = "";
  if (!data.shows.includes(state.show)) state.show = start.show;
  if (!Object.hasOwn(data.presets, state.preset)) state.preset = "";
  if (!data.techniques[state.technique].heights.includes(state.heights)) state.heights = "sharp";
  state.layer &&= data.constants.layer;
  clampSettings(state, data);
  clampRanges(state, data.limits.numbers);
  clampRanges(state.camera, data.limits.camera);
  for (const light of state.lights) clampRanges(light, data.limits.lights);
  clampTilings(state, start, data.limits);
  // ranges do not end before they start
  const [near, far] = state.fade;
  if (near >= far) state.fade[1] = near + 0.01;
  state.fog.fog_end = Math.max(state.fog.fog_start, state.fog.fog_end);
  return state;
}

/**
 * @template {number | number[]} T
 * @param {T} x
 * @param {Range} range
 * @returns {T}
 */
function within(x, [low, high]) {
  /** @type {(n: number) => number} */
  const each = (n) => Math.max(low ?? -Infinity, Math.min(high ?? Infinity, n));
  return /** @type {T} */ (Array.isArray(x) ? x.map(each) : each(x));
}

/**
 * @param {Values} values
 * @param {Setting[]} settings
 */
function clampRecord(values, settings) {
  for (const { name, low, high, whole } of settings) {
    values[name] = within(values[name], [low, high]);
    if (whole) values[name] = Math.round(Number(values[name]));
  }
}

/**
 * @param {State} state
 * @param {Data} data
 */
function clampSettings(state, { techniques, settings }) {
  for (const [name, { settings: own }] of Object.entries(techniques)) {
    clampRecord(state.settings[name], own);
  }
  for (const [name, own] of Object.entries(settings.surface_parameters))
    clampRecord(state.surface_parameters[name], own);
  for (const name of /** @type {const} */ (["shading", "shadowing", "smoothing", "fog"])) {
    clampRecord(state[name], settings[name]);
  }
}

/**
 * Clamp numbers of a record to their ranges; null stays.
 * @param {Fields} record
 * @param {{ [name: string]: Range }} ranges
 */
function clampRanges(record, ranges) {
  for (const [name, range] of Object.entries(ranges)) {
    const value = /** @type {number | number[] | null} */ (record[name]);
    if (value !== null) record[name] = within(value, range);
  }
}

/**
 * Clamp tilings; tiles may be negative, but not 0.
 * @param {State} state
 * @param {State} start
 * @param {Limits} limits
 */
function clampTilings(state, start, { least, most }) {
  /** @type {(now: Pair, then: Pair) => Pair} */
  const tiles = (now, then) =>
    now.map((n, k) => (Math.abs(n) >= least && Math.abs(n) <= most ? n : then[k]));
  state.tiling = tiles(state.tiling, start.tiling);
  for (const each of [...Object.values(state.tilings), state.layer_tiling]) {
    each.tiles = tiles(each.tiles, [1, 1]);
    each.shift = within(each.shift, [-most, most]);
  }
}
