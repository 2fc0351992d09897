// A state held to what the library takes, whoever says it: a slider, a link, a notebook.

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
// what the page works out for itself as long as nobody says it
const OPEN = new Set(["distance", "orthographic_height"]);

/**
 * `other` laid over `base`, where it has the same kind of values; what it does not know is left.
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
    else if (fits(mine, value, OPEN.has(name))) fields[name] = copyOf(value);
  }
  return made;
}

/**
 * @param {unknown} mine
 * @param {unknown} value
 * @param {boolean} open
 */
function fits(mine, value, open) {
  if (open) return value === null || isNumber(value);
  if (Array.isArray(mine)) {
    return Array.isArray(value) && value.length === mine.length && value.every(isNumber);
  }
  return typeof mine === "number" ? isNumber(value) : typeof mine === typeof value;
}

/**
 * @param {unknown} said
 * @param {Data} data
 * @returns {Light}
 */
function lightOf(said, data) {
  const [usual] = data.defaults.lights;
  const made = merged(usual, said, data);
  return Object.hasOwn(data.lightKinds, made.kind) ? made : { ...made, kind: usual.kind };
}

/**
 * A state with every choice one that there is, and every number within its range; in place.
 * @param {State} state
 * @param {State} start
 * @param {Data} data
 */
export function held(state, start, data) {
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
  holdSettings(state, data);
  holdRanges(state, data.limits.numbers);
  holdRanges(state.camera, data.limits.camera);
  for (const light of state.lights) holdRanges(light, data.limits.lights);
  holdTilings(state, start, data.limits);
  // what begins does not end before
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
function holdRecord(values, settings) {
  for (const { name, low, high, whole } of settings) {
    values[name] = within(values[name], [low, high]);
    if (whole) values[name] = Math.round(Number(values[name]));
  }
}

/**
 * @param {State} state
 * @param {Data} data
 */
function holdSettings(state, { techniques, settings }) {
  for (const [name, { settings: own }] of Object.entries(techniques)) {
    holdRecord(state.settings[name], own);
  }
  for (const [name, own] of Object.entries(settings.surface_parameters))
    holdRecord(state.surface_parameters[name], own);
  for (const name of /** @type {const} */ (["shading", "shadowing", "smoothing", "fog"])) {
    holdRecord(state[name], settings[name]);
  }
}

/**
 * Clamp numbers of a record to their ranges; null stays.
 * @param {Fields} record
 * @param {{ [name: string]: Range }} ranges
 */
function holdRanges(record, ranges) {
  for (const [name, range] of Object.entries(ranges)) {
    const value = /** @type {number | number[] | null} */ (record[name]);
    if (value !== null) record[name] = within(value, range);
  }
}

/**
 * Tiles may be mirrored, but not be none.
 * @param {State} state
 * @param {State} start
 * @param {Limits} limits
 */
function holdTilings(state, start, { least, most }) {
  /** @type {(now: Pair, then: Pair) => Pair} */
  const tiles = (now, then) =>
    now.map((n, k) => (Math.abs(n) >= least && Math.abs(n) <= most ? n : then[k]));
  state.tiling = tiles(state.tiling, start.tiling);
  for (const each of [...Object.values(state.tilings), state.layer_tiling]) {
    each.tiles = tiles(each.tiles, [1, 1]);
    each.shift = within(each.shift, [-most, most]);
  }
}
