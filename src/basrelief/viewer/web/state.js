// The state of the page, and its text as a link, a line of Python and a command line.

import { travelling } from "view/camera.js";
import { copyOf, isObject, merged, validated } from "view/checks.js";

/** @import { Data, Light, Orbit, Pair, SceneState, Setting, Show, Values } from "view/data" */
/** @import { Fields } from "view/checks.js" */

/**
 * The state of a scene and of the page.
 * @typedef {SceneState & { compare: string, divider: number, show: Show, preset: string,
 *   scroll: Pair }} State
 */

/** @type {(a: unknown, b: unknown) => boolean} */
const same = (a, b) => JSON.stringify(a) === JSON.stringify(b);

/**
 * The fields that differ from another state; links hold only these.
 * @param {unknown} now
 * @param {unknown} then
 * @returns {unknown} undefined if none does
 */
export function difference(now, then) {
  if (!isObject(now) || !isObject(then)) return same(now, then) ? undefined : now;
  /** @type {Fields} */
  const changes = {};
  for (const [name, value] of Object.entries(now)) {
    const change = difference(value, then[name]);
    if (change !== undefined) changes[name] = change;
  }
  return Object.keys(changes).length ? changes : undefined;
}

/**
 * The fragment of a link to a state; empty for the state at the start.
 * @param {State} state
 * @param {State} start
 */
export function toHash(state, start) {
  const change = difference(state, start);
  return change ? `#${encodeURIComponent(JSON.stringify(change))}` : "";
}

/**
 * The state of a link's fragment. Throws an error for a fragment that is not JSON.
 * @param {string} hash
 * @param {State} start
 * @param {Data} data
 */
export function fromHash(hash, start, data) {
  if (hash.length < 2) return copyOf(start);
  return withChanges(start, JSON.parse(decodeURIComponent(hash.slice(1))), data);
}

/**
 * A state with the valid fields of `other`.
 * @type {(state: State, other: unknown, data: Data) => State}
 */
export const withChanges = (state, other, data) =>
  validated(merged(state, other, data), state, data);

// --- as text ------------------------------------------------------------------------------------

/**
 * Text of a number to seven digits, the precision of float32.
 * @type {(x: unknown) => string}
 */
const short = (x) => String(Number(Number(x).toPrecision(7)));

/**
 * The options that differ from the library's defaults.
 * @param {State} state
 * @param {Data} data
 */
function changedOptions(state, data) {
  const technique = data.techniques[state.technique];
  const { settings, defaults } = data;
  /** @type {(values: Values, known: Setting[]) => Values} */
  const changed = (values, known) =>
    Object.fromEntries(
      known.filter((s) => !same(values[s.name], s.default)).map((s) => [s.name, values[s.name]]),
    );
  const numbers = {
    settings: changed(state.settings[state.technique], technique.settings),
    surface_parameters: changed(
      state.surface_parameters[state.surface],
      settings.surface_parameters[state.surface],
    ),
    shading: changed(state.shading, settings.shading),
    shadowing: state.shadows === "none" ? {} : changed(state.shadowing, settings.shadowing),
    smoothing: state.heights === "sharp" ? {} : changed(state.smoothing, settings.smoothing),
    fog: state.fog_mode === "none" ? {} : changed(state.fog, settings.fog),
  };
  /** @type {Fields} */
  const simple = { technique: technique.commandName };
  /** @type {Fields} */
  const now = state;
  const simpleDefaults = {
    ...defaults.options,
    opening: null,
    ...(state.opening !== null && { scale: defaults.hole_scale }),
    reference_height: technique.reference_height,
    projection: technique.projection,
  };
  for (const [name, value] of Object.entries(simpleDefaults)) {
    if (now[name] !== value) simple[name] = now[name];
  }
  if (!technique.heights.includes(state.heights)) delete simple.heights;
  /** @type {<T>(value: T, usual: NoInfer<T>) => T | null} */
  const unless = (value, usual) => (same(value, usual) ? null : value);
  const main = { tiles: state.tiling, shift: state.shift };
  const own = Object.entries(state.tilings).filter(([, tiling]) => !same(tiling, main));
  return {
    simple,
    numbers,
    tilings: state.apart && own.length ? Object.fromEntries(own) : null,
    layer: state.layer ? state.layer_tiling : null,
    tiling: unless(state.tiling, data.shapes[state.shape].tiling),
    shift: unless(state.shift, [0, 0]),
    fade: state.fades ? state.fade : null,
    background: unless(state.background, defaults.background),
    lights: unless(state.lights, defaults.lights),
    camera: cameraOf(state.camera, defaults.camera),
  };
}

/**
 * Arguments of the orbit, those that have the default omitted except its angles.
 * @param {Orbit} camera
 * @param {Orbit} usual
 * @returns {Partial<Orbit>}
 */
function cameraOf(camera, usual) {
  /** @type {Partial<Orbit>} */
  const options = { azimuth: camera.azimuth, elevation: camera.elevation };
  if (camera.distance !== null) options.distance = camera.distance;
  if (!same(camera.target, [0, 0, 0])) options.target = camera.target;
  if (camera.orthographic_height !== null) options.orthographic_height = camera.orthographic_height;
  else if (camera.field_of_view !== usual.field_of_view)
    options.field_of_view = camera.field_of_view;
  return options;
}

/**
 * Arguments of the constructor of a light, which has a target in place of the angles of a spot.
 * @param {Light} light
 * @param {Data} data
 * @returns {Fields}
 */
function lightOf(light, { lightKinds }) {
  const { azimuth, elevation, position } = light;
  const target = travelling(azimuth, elevation).map((x, k) => position[k] + x);
  /** @type {Fields} */
  const numbers = { ...light, target };
  return Object.fromEntries(lightKinds[light.kind].map((name) => [name, numbers[name]]));
}

/**
 * What a text depends on besides the state: the picture's size, and whether maps were changed.
 * @typedef {{ size: Pair, mapsChanged: boolean }} Shown
 */

/**
 * The comment at the end of a text: what it leaves out, and the folder to run it in.
 * @param {State} state
 * @param {Data} data
 * @param {Shown} shown
 * @param {string[]} omitted
 */
function comment(state, data, { mapsChanged }, omitted) {
  const without = [...data.omitted, ...omitted];
  if (state.compare && state.compare !== state.technique)
    without.push(`${state.compare} right of the divider`);
  if (state.scroll.some(Boolean)) without.push("the scrolling");
  if (mapsChanged) without.push("the maps that were changed on the page");
  const remarks = [
    ...(without.length ? [`without ${without.join(", ")}`] : []),
    ...(data.relative.length
      ? [`run it in the folder that contains ${data.relative.join(" and ")}`]
      : []),
  ];
  return remarks.length ? `  # ${remarks.join("; ")}` : "";
}

/**
 * The command line that draws the picture.
 * @param {State} state
 * @param {Data} data
 * @param {Shown} shown
 */
export function toCommand(state, data, shown) {
  const options = changedOptions(state, data);
  /** @type {(fields: Fields) => string[]} */
  const assignments = (fields) =>
    Object.entries(fields).map(([name, x]) => `${name}=${[x].flat().map(short).join("/")}`);
  /** @type {(text: string) => string} */
  const quoted = (text) =>
    /^[\w./:=,@%+-]+$/.test(text) ? text : `'${text.replaceAll("'", `'\\''`)}'`;
  const parts = ["basrelief", "render", data.source];
  /** @type {(name: string, x: unknown) => void} */
  const option = (name, x) => {
    parts.push(`--${name.replaceAll("_", "-")}`, typeof x === "number" ? short(x) : String(x));
  };
  /** @type {(pair: Pair) => string} */
  const tiles = (pair) => pair.map(short).join("x");
  // a value that starts with a minus would be parsed as an option
  /** @type {(name: string, numbers: number[]) => void} */
  const joined = (name, numbers) => parts.push(`--${name}=${numbers.map(short).join(",")}`);
  // a scale, and the depth of a hole, replace that of the material, and are refused beside it
  const replaced = "scale" in options.simple || state.opening !== null ? data.lengths : [];
  for (const [name, x] of Object.entries(data.reading)) {
    if (replaced.includes(name)) continue;
    if (x === true) parts.push(`--${name.replaceAll("_", "-")}`);
    else option(name, x);
  }
  for (const [name, x] of Object.entries(options.simple)) {
    option(name, x);
  }
  for (const changed of Object.values(options.numbers)) {
    for (const text of assignments(changed)) parts.push("--set", text);
  }
  if (options.tiling) parts.push("--tiling", tiles(options.tiling));
  if (options.shift) joined("shift", options.shift);
  for (const [name, tiling] of Object.entries(options.tilings ?? {})) {
    parts.push("--map-tiling", `${name}=${tiles(tiling.tiles)}`);
    if (!same(tiling.shift, state.shift)) {
      parts.push("--map-shift", `${name}=${tiling.shift.map(short).join(",")}`);
    }
  }
  if (options.layer) {
    parts.push("--layer", data.layerSource, "--layer-tiling", tiles(options.layer.tiles));
    joined("layer-shift", options.layer.shift);
  }
  if (options.fade) joined("fade", options.fade);
  if (options.background) joined("background", options.background);
  parts.push("--camera", assignments(options.camera).join(","));
  if (options.lights?.length === 0) parts.push("--light", "none");
  for (const light of options.lights ?? []) {
    parts.push("--light", [light.kind, ...assignments(lightOf(light, data))].join(","));
  }
  const { world, placement } = data.shapes[state.shape];
  for (const [name, text] of Object.entries(placement ?? {})) parts.push(`--${name}=${text}`);
  if (["reads", "missed"].includes(state.show)) option("show", state.show);
  option("size", tiles(shown.size));
  const omitted = [
    ...(world && !placement ? ["the transform of the object"] : []),
    ...(state.show === "depth" ? ["the picture of depth"] : []),
  ];
  return parts.map(quoted).join(" ") + comment(state, data, shown, omitted);
}

/**
 * The line of Python that draws the picture.
 * @param {State} state
 * @param {Data} data
 * @param {Shown} shown
 */
export function toPython(state, data, shown) {
  const options = changedOptions(state, data);
  /** @type {(x: unknown) => string} */
  const value = (x) => {
    if (x === true) return "True";
    if (typeof x === "string") return JSON.stringify(x);
    if (Array.isArray(x)) return `(${x.map(value).join(", ")})`;
    if (typeof x === "number") return short(x);
    const items = Object.entries(/** @type {Fields} */ (x));
    return `{${items.map(([name, y]) => `"${name}": ${value(y)}`).join(", ")}}`;
  };
  /** @type {(fields: Fields) => string[]} */
  const listed = (fields) => Object.entries(fields).map(([key, x]) => `${key}=${value(x)}`);
  /** @type {(name: string, fields: Fields) => string} */
  const call = (name, fields) => `basrelief.${name}(${listed(fields).join(", ")})`;
  const args = listed(options.simple);
  for (const [name, changed] of Object.entries(options.numbers)) {
    if (Object.keys(changed).length) args.push(`${name}=${value(changed)}`);
  }
  for (const name of /** @type {const} */ (["tiling", "shift", "fade", "background"])) {
    if (options[name] !== null) args.push(`${name}=${value(options[name])}`);
  }
  if (options.tilings) {
    const tilings = Object.entries(options.tilings).map(
      ([name, tiling]) => `"${name}": ${call("Tiling", tiling)}`,
    );
    args.push(`tilings={${tilings.join(", ")}}`);
  }
  if (options.layer) {
    const material = `basrelief.load(${JSON.stringify(data.layerSource)})`;
    args.push(`layer=basrelief.Layer(${material}, ${call("Tiling", options.layer)})`);
  }
  const { world } = data.shapes[state.shape];
  if (world) args.push(`transform=${value(world)}`);
  args.push(`camera=${call("Orbit", options.camera)}`);
  if (options.lights) {
    const lights = options.lights.map((light) => `${call(light.kind, lightOf(light, data))},`);
    args.push(`lights=(${lights.join(" ")})`);
  }
  args.push(`size=${value(shown.size)}`);
  const source = JSON.stringify(data.source);
  const reading = listed(data.reading);
  const what = reading.length ? `basrelief.load(${[source, ...reading].join(", ")})` : source;
  const omitted = state.show === "color" ? [] : [`the picture of ${state.show}`];
  const line = `import basrelief; basrelief.render(${[what, ...args].join(", ")})`;
  return line + comment(state, data, shown, omitted);
}
