// A state held to what the library takes, whoever says it: a slider, a link, a notebook.

export const copyOf = (value) => structuredClone(value);

const isObject = (x) => x !== null && typeof x === "object" && !Array.isArray(x);
const isNumber = (x) => typeof x === "number" && Number.isFinite(x);
// what the page works out for itself as long as nobody says it
const OPEN = new Set(["distance", "orthographic_height"]);

// `other` laid over `base`, where it has the same kind of values; what it does not know is left.
export function merged(base, other, data) {
  const made = copyOf(base);
  for (const [name, value] of Object.entries(isObject(other) ? other : {})) {
    if (!Object.hasOwn(made, name)) continue;
    if (name === "lights") {
      if (Array.isArray(value)) made.lights = value.map((each) => lightOf(each, data));
    } else if (isObject(made[name])) {
      made[name] = merged(made[name], value, data);
    } else if (fits(made[name], value, OPEN.has(name))) {
      made[name] = copyOf(value);
    }
  }
  return made;
}

function fits(mine, value, open) {
  if (open) return value === null || isNumber(value);
  if (Array.isArray(mine)) {
    return Array.isArray(value) && value.length === mine.length && value.every(isNumber);
  }
  return typeof mine === "number" ? isNumber(value) : typeof mine === typeof value;
}

function lightOf(said, data) {
  const [usual] = data.defaults.lights;
  const made = merged(usual, said, data);
  return data.lightKinds.includes(made.kind) ? made : { ...made, kind: usual.kind };
}

// A state with every choice one that there is, and every number within its range; in place.
export function held(state, start, data) {
  for (const [name, known] of Object.entries(data.menus)) {
    if (!known.includes(state[name])) state[name] = start[name];
  }
  if (!["", ...data.menus.technique].includes(state.compare)) state.compare = "";
  if (!data.shows.includes(state.show)) state.show = start.show;
  if (!Object.hasOwn(data.presets, state.preset)) state.preset = "";
  if (!data.techniques[state.technique].heights.includes(state.heights)) state.heights = "sharp";
  state.layer &&= data.constants.layer;
  holdSettings(state, data);
  holdNumbers(state, data.limits);
  holdTilings(state, start, data.limits);
  // what begins does not end before
  const [near, far] = state.fade;
  if (near >= far) state.fade[1] = near + 0.01;
  state.air.fog_end = Math.max(state.air.fog_start, state.air.fog_end);
  return state;
}

function within(x, [low, high]) {
  if (Array.isArray(x)) return x.map((each) => within(each, [low, high]));
  return Math.max(low ?? -Infinity, Math.min(high ?? Infinity, x));
}

function holdRecord(values, settings) {
  for (const { name, low, high, whole } of settings) {
    values[name] = within(values[name], [low, high]);
    if (whole) values[name] = Math.round(values[name]);
  }
}

function holdSettings(state, { techniques, settings }) {
  for (const [name, { settings: own }] of Object.entries(techniques)) {
    holdRecord(state.settings[name], own);
  }
  for (const [name, own] of Object.entries(settings.finish)) holdRecord(state.finish[name], own);
  for (const name of ["shading", "shadowing", "smoothing", "air"]) {
    holdRecord(state[name], settings[name]);
  }
}

function holdNumbers(state, { numbers, lights, camera }) {
  for (const [name, range] of Object.entries(numbers)) state[name] = within(state[name], range);
  for (const light of state.lights) {
    for (const [name, range] of Object.entries(lights)) light[name] = within(light[name], range);
  }
  for (const [name, range] of Object.entries(camera)) {
    if (state.camera[name] !== null) state.camera[name] = within(state.camera[name], range);
  }
}

// Tiles may be mirrored, but not be none.
function holdTilings(state, start, { least, most }) {
  const tiles = (now, then) =>
    now.map((n, k) => (Math.abs(n) >= least && Math.abs(n) <= most ? n : then[k]));
  state.tiling = tiles(state.tiling, start.tiling);
  for (const each of [...Object.values(state.tilings), state.layer_tiling]) {
    each.tiles = tiles(each.tiles, [1, 1]);
    each.shift = within(each.shift, [-most, most]);
  }
}
