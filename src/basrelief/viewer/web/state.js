// What a person can change, as one plain object; as a link, a line of Python, a command line.

import { travelling } from "view/camera.js";
import { copyOf, held, isObject, merged } from "view/checks.js";

/** @import { Data, Light, Orbit, Pair, SceneState, Setting, Show, Values } from "view/data" */
/** @import { Fields } from "view/checks.js" */

/**
 * The state of a scene and of the page.
 * @typedef {SceneState & { compare: string, divider: number, show: Show, preset: string }} State
 */

/** @type {(a: unknown, b: unknown) => boolean} */
const same = (a, b) => JSON.stringify(a) === JSON.stringify(b);

/**
 * Only what differs from another state, so that links stay short.
 * @param {unknown} now
 * @param {unknown} then
 * @returns {unknown} undefined where nothing does
 */
export function difference(now, then) {
  if (!isObject(now) || !isObject(then)) return same(now, then) ? undefined : now;
  /** @type {Fields} */
  const found = {};
  for (const [name, value] of Object.entries(now)) {
    const left = difference(value, then[name]);
    if (left !== undefined) found[name] = left;
  }
  return Object.keys(found).length ? found : undefined;
}

/**
 * @param {State} state
 * @param {State} start
 */
export function toHash(state, start) {
  const left = difference(state, start);
  return left ? `#${encodeURIComponent(JSON.stringify(left))}` : "";
}

/**
 * @param {string} hash
 * @param {State} start
 * @param {Data} data
 */
export function fromHash(hash, start, data) {
  if (hash.length < 2) return copyOf(start);
  return laidOver(start, JSON.parse(decodeURIComponent(hash.slice(1))), data);
}

/**
 * `other` laid over a state as far as it makes sense, whoever says so.
 * @type {(state: State, other: unknown, data: Data) => State}
 */
export const laidOver = (state, other, data) => held(merged(state, other, data), state, data);

// --- as text ------------------------------------------------------------------------------------

/** @type {(x: unknown) => string} */
const short = (x) => String(Number(Number(x).toPrecision(7)));

/**
 * What the library would have to be told: all that is not its own default.
 * @param {State} state
 * @param {Data} data
 */
function told(state, data) {
  const made = data.techniques[state.technique];
  const { settings, defaults } = data;
  /** @type {(values: Values, known: Setting[]) => Values} */
  const changed = (values, known) =>
    Object.fromEntries(
      known.filter((s) => !same(values[s.name], s.default)).map((s) => [s.name, values[s.name]]),
    );
  const numbers = {
    settings: changed(state.settings[state.technique], made.settings),
    finish: changed(
      state.surface_parameters[state.surface],
      settings.surface_parameters[state.surface],
    ),
    shading: changed(state.shading, settings.shading),
    shadowing: state.shadows === "none" ? {} : changed(state.shadowing, settings.shadowing),
    smoothing: state.heights === "sharp" ? {} : changed(state.smoothing, settings.smoothing),
    fog: state.fog_mode === "none" ? {} : changed(state.fog, settings.fog),
  };
  /** @type {Fields} */
  const plain = { technique: made.called };
  /** @type {Fields} */
  const now = state;
  const usual = {
    ...defaults.plain,
    reference_height: made.reference_height,
    projection: made.projection,
  };
  for (const [name, value] of Object.entries(usual)) {
    if (now[name] !== value) plain[name] = now[name];
  }
  if (!made.heights.includes(state.heights)) delete plain.heights;
  /** @type {<T>(value: T, usually: NoInfer<T>) => T | null} */
  const other = (value, usually) => (same(value, usually) ? null : value);
  const main = { tiles: state.tiling, shift: state.shift };
  const own = Object.entries(state.tilings).filter(([, each]) => !same(each, main));
  return {
    plain,
    numbers,
    tilings: state.apart && own.length ? Object.fromEntries(own) : null,
    layer: state.layer ? state.layer_tiling : null,
    tiling: other(state.tiling, data.shapes[state.shape].tiling),
    shift: other(state.shift, [0, 0]),
    fade: state.fades ? state.fade : null,
    background: other(state.background, defaults.background),
    lights: other(state.lights, defaults.lights),
    camera: cameraOf(state.camera, defaults.camera),
  };
}

/**
 * @param {Orbit} camera
 * @param {Orbit} usual
 * @returns {Partial<Orbit>}
 */
function cameraOf(camera, usual) {
  /** @type {Partial<Orbit>} */
  const made = { azimuth: camera.azimuth, elevation: camera.elevation };
  if (camera.distance !== null) made.distance = camera.distance;
  if (!same(camera.target, [0, 0, 0])) made.target = camera.target;
  if (camera.orthographic_height !== null) made.orthographic_height = camera.orthographic_height;
  else if (camera.field_of_view !== usual.field_of_view) made.field_of_view = camera.field_of_view;
  return made;
}

/**
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
 * @param {State} state
 * @param {Data} data
 */
export function toCommand(state, data) {
  const said = told(state, data);
  /** @type {(each: Fields, sign: string) => string[]} */
  const values = (each, sign) =>
    Object.entries(each).map(([name, x]) => `${name}=${[x].flat().map(short).join(sign)}`);
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
  // what begins with a minus would be taken for an option
  /** @type {(name: string, numbers: number[]) => void} */
  const joined = (name, numbers) => parts.push(`--${name}=${numbers.map(short).join(",")}`);
  for (const [name, x] of Object.entries(data.reading)) {
    if (x === true) parts.push(`--${name.replaceAll("_", "-")}`);
    else option(name, x);
  }
  for (const [name, x] of Object.entries(said.plain)) {
    // the one number of an object that is no option of its own
    if (name === "bias") parts.push("--set", `bias=${short(x)}`);
    else option(name, x);
  }
  for (const each of Object.values(said.numbers)) {
    for (const text of values(each, "/")) parts.push("--set", text);
  }
  if (said.tiling) parts.push("--tiling", tiles(said.tiling));
  if (said.shift) joined("shift", said.shift);
  for (const [name, each] of Object.entries(said.tilings ?? {})) {
    parts.push("--map-tiling", `${name}=${tiles(each.tiles)}`);
    if (!same(each.shift, state.shift)) {
      parts.push("--map-shift", `${name}=${each.shift.map(short).join(",")}`);
    }
  }
  if (said.layer) {
    parts.push("--layer", data.layerSource, "--layer-tiling", tiles(said.layer.tiles));
    joined("layer-shift", said.layer.shift);
  }
  if (said.fade) joined("fade", said.fade);
  if (said.background) joined("background", said.background);
  parts.push("--camera", values(said.camera, "/").join(","));
  if (said.lights?.length === 0) parts.push("--light", "none");
  for (const light of said.lights ?? []) {
    parts.push("--light", [light.kind, ...values(lightOf(light, data), "/")].join(","));
  }
  return parts.map(quoted).join(" ");
}

/**
 * @param {State} state
 * @param {Data} data
 */
export function toPython(state, data) {
  const said = told(state, data);
  /** @type {(x: unknown) => string} */
  const value = (x) => {
    if (x === true) return "True";
    if (typeof x === "string") return JSON.stringify(x);
    if (Array.isArray(x)) return `(${x.map(value).join(", ")})`;
    if (typeof x === "number") return short(x);
    const items = Object.entries(/** @type {Fields} */ (x));
    return `{${items.map(([name, y]) => `"${name}": ${value(y)}`).join(", ")}}`;
  };
  /** @type {(given: Fields) => string[]} */
  const listed = (given) => Object.entries(given).map(([key, x]) => `${key}=${value(x)}`);
  /** @type {(name: string, given: Fields) => string} */
  const call = (name, given) => `basrelief.${name}(${listed(given).join(", ")})`;
  const given = listed(said.plain);
  for (const [name, each] of Object.entries(said.numbers)) {
    if (Object.keys(each).length) given.push(`${name}=${value(each)}`);
  }
  for (const name of /** @type {const} */ (["tiling", "shift", "fade", "background"])) {
    if (said[name] !== null) given.push(`${name}=${value(said[name])}`);
  }
  if (said.tilings) {
    const each = Object.entries(said.tilings).map(([name, x]) => `"${name}": ${call("Tiling", x)}`);
    given.push(`tilings={${each.join(", ")}}`);
  }
  if (said.layer) {
    const over = `basrelief.load(${JSON.stringify(data.layerSource)})`;
    given.push(`layer=basrelief.Layer(${over}, ${call("Tiling", said.layer)})`);
  }
  const { world } = data.shapes[state.shape];
  if (world) given.push(`transform=${value(world)}`);
  given.push(`camera=${call("Orbit", said.camera)}`);
  if (said.lights) {
    const each = said.lights.map((l) => `${call(l.kind, lightOf(l, data))},`);
    given.push(`lights=(${each.join(" ")})`);
  }
  const source = JSON.stringify(data.source);
  const reading = listed(data.reading);
  const what = reading.length ? `basrelief.load(${[source, ...reading].join(", ")})` : source;
  return `import basrelief; basrelief.render(${[what, ...given].join(", ")})`;
}
