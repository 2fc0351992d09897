// What a person can change, as one plain object; as a link, a line of Python, a command line.

export const copyOf = (value) => structuredClone(value);

export const keyOf = (state, choices) =>
  Object.keys(choices)
    .map((name) => state[name])
    .join("|");

// Only what differs from another state, so that links stay short.
export function difference(now, then) {
  const plain = (x) => x !== null && typeof x === "object" && !Array.isArray(x);
  if (!plain(now) || !plain(then)) {
    return JSON.stringify(now) === JSON.stringify(then) ? undefined : now;
  }
  const found = {};
  for (const [name, value] of Object.entries(now)) {
    const left = difference(value, then[name]);
    if (left !== undefined) found[name] = left;
  }
  return Object.keys(found).length ? found : undefined;
}

// `other` laid over `base`, where it has the same kind of values; what it does not know is left.
export function merged(base, other) {
  const made = copyOf(base);
  for (const [name, value] of Object.entries(other ?? {})) {
    if (!(name in made)) continue;
    const mine = made[name];
    if (mine !== null && typeof mine === "object" && !Array.isArray(mine)) {
      if (value !== null && typeof value === "object") made[name] = merged(mine, value);
    } else if (Array.isArray(mine) ? Array.isArray(value) : fits(mine, value)) {
      made[name] = copyOf(value);
    }
  }
  return made;
}

function fits(mine, value) {
  if (mine === null || value === null) return typeof value !== "object" || value === null;
  if (typeof value === "number") return typeof mine === "number" && Number.isFinite(value);
  return typeof mine === typeof value;
}

export function toHash(state, start) {
  const left = difference(state, start);
  return left ? `#${encodeURIComponent(JSON.stringify(left))}` : "";
}

export function fromHash(hash, start, data) {
  if (hash.length < 2) return copyOf(start);
  return laidOver(start, JSON.parse(decodeURIComponent(hash.slice(1))), data);
}

// `other` laid over a state as far as there are such choices, whoever says so.
export function laidOver(state, other, data) {
  const made = merged(state, other);
  for (const [name, known] of Object.entries(data.choices)) {
    if (!known.includes(made[name])) made[name] = state[name];
  }
  if (made.compare !== "" && !data.choices.technique.includes(made.compare)) made.compare = "";
  return made;
}

// --- as text ------------------------------------------------------------------------------------

const short = (x) => String(Number(Number(x).toPrecision(7)));
const same = (a, b) => JSON.stringify(a) === JSON.stringify(b);

// What the library would have to be told: all that is not its own default.
function told(state, data) {
  const made = data.techniques[state.technique];
  const changed = (values, settings) =>
    Object.fromEntries(
      settings.filter((s) => !same(values[s.name], s.default)).map((s) => [s.name, values[s.name]]),
    );
  const numbers = {
    settings: changed(state.settings[state.technique], made.settings),
    finish: changed(state.finish, data.settings.finish),
    shading: changed(state.shading, data.settings.shading),
    shadowing: changed(state.shadowing, data.settings.shadowing),
  };
  const plain = { technique: state.technique };
  if (state.shape !== "plane") plain.shape = state.shape;
  if (state.scale !== data.defaults.scale) plain.scale = state.scale;
  if (state.level !== made.level) plain.level = state.level;
  if (state.projection !== made.projection) plain.projection = state.projection;
  if (state.shadows !== "none") plain.shadows = state.shadows;
  if (state.shading_model !== "ggx") plain.shading_model = state.shading_model;
  const tiling = same(state.tiling, data.shapes[state.shape].tiling) ? null : state.tiling;
  const shift = same(state.shift, [0, 0]) ? null : state.shift;
  const lights = same(state.lights, data.defaults.lights) ? null : state.lights;
  const bias = state.bias === data.defaults.bias ? null : state.bias;
  return { plain, numbers, tiling, shift, lights, bias, camera: cameraOf(state.camera) };
}

function cameraOf(camera) {
  const made = { azimuth: camera.azimuth, elevation: camera.elevation };
  if (camera.distance !== null) made.distance = camera.distance;
  if (!same(camera.target, [0, 0, 0])) made.target = camera.target;
  if (camera.orthographic_height !== null) made.orthographic_height = camera.orthographic_height;
  else if (camera.field_of_view !== 30) made.field_of_view = camera.field_of_view;
  return made;
}

function lightOf(light) {
  const made = { color: light.color, intensity: light.intensity };
  if (light.kind === "directional") {
    return { azimuth: light.azimuth, elevation: light.elevation, ...made };
  }
  const lamp = { position: light.position, ...made, falloff: light.falloff };
  if (light.kind === "point") return lamp;
  const [outer, inner] = [Math.acos(light.cos_outer), Math.acos(light.cos_inner)];
  const target = light.position.map((x, k) => x + light.direction[k]);
  return { ...lamp, target, angle: (outer * 360) / Math.PI, softness: 1 - inner / outer };
}

export function toCommand(state, data) {
  const { plain, numbers, tiling, shift, lights, bias, camera } = told(state, data);
  const values = (each, sign) =>
    Object.entries(each).map(([name, x]) => `${name}=${[x].flat().map(short).join(sign)}`);
  const quoted = (text) => (/^[\w./:=,-]+$/.test(text) ? text : `'${text.replaceAll("'", `'\\''`)}'`);
  const parts = ["basrelief", "render", quoted(data.source)];
  for (const [name, x] of Object.entries(plain)) {
    parts.push(`--${name.replace("_", "-")}`, typeof x === "number" ? short(x) : x);
  }
  for (const each of Object.values(numbers)) {
    for (const text of values(each, "/")) parts.push("--set", text);
  }
  if (bias !== null) parts.push("--set", `bias=${short(bias)}`);
  if (tiling) parts.push("--tiling", tiling.map(short).join("x"));
  if (shift) parts.push(`--shift=${shift.map(short).join(",")}`);
  parts.push("--camera", values(camera, "/").join(","));
  for (const light of lights ?? []) {
    parts.push("--light", [light.kind, ...values(lightOf(light), "/")].join(","));
  }
  return parts.join(" ");
}

export function toPython(state, data) {
  const { plain, numbers, tiling, shift, lights, bias, camera } = told(state, data);
  const value = (x) => {
    if (typeof x === "string") return JSON.stringify(x);
    if (Array.isArray(x)) return `(${x.map(short).join(", ")})`;
    if (typeof x === "number") return short(x);
    return `{${Object.entries(x).map(([name, y]) => `"${name}": ${value(y)}`).join(", ")}}`;
  };
  const call = (name, given) =>
    `basrelief.${name}(${Object.entries(given).map(([key, x]) => `${key}=${value(x)}`).join(", ")})`;
  const given = Object.entries(plain).map(([name, x]) => `${name}=${value(x)}`);
  for (const [name, each] of Object.entries(numbers)) {
    if (Object.keys(each).length) given.push(`${name}=${value(each)}`);
  }
  if (bias !== null) given.push(`bias=${short(bias)}`);
  if (tiling) given.push(`tiling=${value(tiling)}`);
  if (shift) given.push(`shift=${value(shift)}`);
  given.push(`camera=${call("Orbit", camera)}`);
  if (lights) given.push(`lights=(${lights.map((l) => `${call(l.kind, lightOf(l))},`).join(" ")})`);
  return `basrelief.render(${JSON.stringify(data.source)}, ${given.join(", ")})`;
}
