// The panel: native controls for everything in the state, made from what the page knows of it.

import { decoded, encoded } from "view/srgb.js";

const WRITING = 800; // milliseconds between the letters of a name
let count = 0;

function element(name, attributes = {}, ...children) {
  const made = document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) {
    if (key in made && typeof value !== "string") made[key] = value;
    else made.setAttribute(key, value);
  }
  made.append(...children);
  return made;
}

const words = (name) => name.replaceAll("_", " ");

// Where a value lies in the state: ["settings", "relief", "max_steps"], ["tiling", 0].
const at = (state, path) => path.reduce((value, key) => value[key], state);
function set(state, path, value) {
  at(state, path.slice(0, -1))[path.at(-1)] = value;
}

// A slider and a number for one value. Wide ranges of numbers above 0 go by powers. Where `soft` the
// range is that of the slider alone, and grows to hold what the value is.
export function number(view, path, { label, doc = "", low, high, whole = false, step = null, soft = false }) {
  const id = `control-${(count += 1)}`;
  const start = at(view.state, path);
  const ends = [low ?? Math.min(0, 2 * start), high ?? Math.max(4 * Math.abs(start), 2)];
  const [least, most] = soft ? [Math.min(ends[0], start), Math.max(ends[1], start)] : ends;
  const [lowest, highest] = soft ? [null, null] : [low, high];
  const wide = most > 128 && least >= 0;
  const offset = least > 0 ? least : 1;
  const span = Math.log((most - least + offset) / offset);
  const toSlider = (x) => (wide ? Math.log((x - least + offset) / offset) / span : x);
  const fromSlider = (x) => (wide ? least - offset + offset * Math.exp(x * span) : x);
  const fine = whole ? 1 : (step ?? 10 ** Math.floor(Math.log10((most - least) / 100)));
  const slider = element("input", {
    type: "range",
    id: `${id}-slider`,
    min: String(wide ? 0 : least),
    max: String(wide ? 1 : most),
    step: String(wide ? 0.002 : fine),
    "aria-label": `${label}, slider`,
  });
  const field = element("input", {
    type: "number",
    id,
    name: path.join("."),
    step: whole ? "1" : "any",
    ...(lowest != null && { min: String(lowest) }),
    ...(highest != null && { max: String(highest) }),
  });
  const rounded = (x) => {
    if (whole) return Math.round(x);
    return Number(x.toPrecision(wide ? 3 : 6));
  };
  const show = () => {
    const value = at(view.state, path);
    if (!wide && value > Number(slider.max)) slider.max = String(value);
    if (!wide && value < Number(slider.min)) slider.min = String(value);
    slider.value = String(toSlider(value));
    slider.setAttribute("aria-valuetext", String(value));
    if (document.activeElement !== field) field.value = String(Number(value.toPrecision(4)));
  };
  const take = (value) => {
    if (!Number.isFinite(value)) return;
    let held = Math.max(lowest ?? -Infinity, Math.min(highest ?? Infinity, value));
    if (whole) held = Math.round(held);
    set(view.state, path, held);
    view.changed();
  };
  // by powers a key goes to the next number that differs
  slider.addEventListener("keydown", (event) => {
    const way = { ArrowRight: 1, ArrowUp: 1, ArrowLeft: -1, ArrowDown: -1 }[event.key];
    if (!wide || !way) return;
    event.preventDefault();
    const value = at(view.state, path);
    const next = rounded(fromSlider(toSlider(value) + way * 0.01));
    take(whole && next === value ? value + way : next);
  });
  slider.addEventListener("input", () => take(rounded(fromSlider(Number(slider.value)))));
  field.addEventListener("input", () => {
    if (field.value !== "") take(Number(field.value));
  });
  field.addEventListener("blur", show);
  view.shows.push(show);
  const row = element(
    "div",
    { class: "number", title: doc },
    element("label", { for: id }, label),
    slider,
    field,
  );
  show();
  return row;
}

// A menu for one choice; `options` are [value, text, whether it can be had, why not].
export function menu(view, path, label, options, after = () => {}) {
  const id = `control-${(count += 1)}`;
  const select = element("select", { id, name: path.join(".") });
  for (const [value, text, there = true, why = ""] of options) {
    const option = element("option", { value }, there ? text : `${text} (${why})`);
    option.disabled = !there;
    select.append(option);
  }
  const show = () => {
    select.value = at(view.state, path);
  };
  // who writes a name is in the middle of it: another menu in this one's place would not know
  let wrote = -Infinity;
  select.addEventListener("keydown", (event) => {
    if (event.key.length === 1) wrote = performance.now();
    if (event.key !== "Tab" || !view.rebuilding) return;
    // the next control is one of the new ones
    event.preventDefault();
    view.rebuildNow();
    beside(document.activeElement, event.shiftKey ? -1 : 1)?.focus();
  });
  select.addEventListener("change", () => {
    set(view.state, path, select.value);
    after(select.value);
    view.changed(performance.now() - wrote > WRITING ? true : "soon");
  });
  select.addEventListener("blur", () => setTimeout(() => view.rebuildNow()));
  view.shows.push(show);
  show();
  return element("div", { class: "menu" }, element("label", { for: id }, label), select);
}

// A box to tick.
export function check(view, path, label) {
  const id = `control-${(count += 1)}`;
  const box = element("input", { type: "checkbox", id, name: path.join(".") });
  const show = () => {
    box.checked = at(view.state, path);
  };
  box.addEventListener("change", () => {
    set(view.state, path, box.checked);
    view.changed(true);
  });
  view.shows.push(show);
  show();
  return element("div", { class: "check" }, box, element("label", { for: id }, label));
}

// A colour, chosen as it is seen and held as light: linear, 0 to 1.
export function color(view, path, label, doc = "") {
  const id = `control-${(count += 1)}`;
  const field = element("input", { type: "color", id, name: path.join(".") });
  const show = () => {
    const codes = at(view.state, path).map((x) => Math.round(255 * encoded(Math.min(x, 1))));
    field.value = `#${codes.map((n) => n.toString(16).padStart(2, "0")).join("")}`;
  };
  field.addEventListener("input", () => {
    const codes = [1, 3, 5].map((k) => Number.parseInt(field.value.slice(k, k + 2), 16) / 255);
    set(view.state, path, codes.map((x) => Number(decoded(x).toPrecision(4))));
    view.changed();
  });
  view.shows.push(show);
  show();
  return element("div", { class: "menu", title: doc }, element("label", { for: id }, label), field);
}

// The control before or after one in the panel.
function beside(control, way) {
  const all = [...document.querySelectorAll("#panel :is(summary, input, select, button)")];
  const seen = all.filter((each) => each.offsetParent !== null && !each.disabled);
  return seen[seen.indexOf(control) + way];
}

export function button(text, act, attributes = {}) {
  const made = element("button", { type: "button", ...attributes }, text);
  made.addEventListener("click", act);
  return made;
}

function section(title, open, ...rows) {
  const made = element("details", {}, element("summary", {}, title), ...rows);
  made.open = open;
  made.id = `section-${title.toLowerCase().replaceAll(" ", "-")}`;
  return made;
}

// Rows for the settings of a record, a row for each component of a colour.
function rows(view, path, settings) {
  return settings.flatMap((each) => {
    const [start] = [each.default].flat();
    if (!Array.isArray(each.default)) {
      return [number(view, [...path, each.name], { ...each, label: words(each.name) })];
    }
    if (each.name.endsWith("color")) return [color(view, [...path, each.name], words(each.name), each.doc)];
    return each.default.map((_, k) =>
      number(view, [...path, each.name, k], {
        ...each,
        default: start,
        high: each.high ?? 2,
        label: `${words(each.name)} ${"rgb"[k]}`,
      }),
    );
  });
}

// The whole panel, made anew where a choice changes what can be set.
export function build(view, panel) {
  const opened = new Map([...panel.querySelectorAll("details")].map((d) => [d.id, d.open]));
  const active = document.activeElement;
  const focused = panel.contains(active) && (active.name || active.id);
  const within = active.closest("details")?.id;
  view.shows = [];
  panel.replaceChildren(
    ...[technique, relief, light, surface, air, maps, picture, share].map((make) => make(view)),
  );
  for (const made of panel.querySelectorAll("details")) {
    if (opened.has(made.id)) made.open = opened.get(made.id);
  }
  if (!focused) return;
  // what is gone leaves the focus to its section
  const again = panel.elements.namedItem(focused) ?? panel.querySelector(`#${within} summary`);
  again.focus();
}

function techniques(view) {
  return view.data.menus.technique.map((name) => {
    const why = !view.hasHeights && name !== "flat" ? "needs heights" : "";
    return [name, words(name), !why, why];
  });
}

function technique(view) {
  const { data, state } = view;
  const made = data.techniques[state.technique];
  const chosen = (name) => {
    const next = data.techniques[name];
    Object.assign(state, { level: next.level, projection: next.projection });
  };
  const presets = Object.entries(data.presets).map(([name, { state: there, why }]) => [
    name,
    name,
    Boolean(there),
    why,
  ]);
  return section(
    "Technique",
    true,
    menu(view, ["technique"], "Technique", techniques(view), chosen),
    element("p", { class: "doc" }, made.doc),
    ...rows(view, ["settings", state.technique], made.settings),
    menu(view, ["compare"], "Beside it", [["", "nothing"], ...techniques(view)]),
    ...(state.compare && state.compare !== state.technique
      ? [
          element("p", { class: "doc" }, `Right of the divider: ${words(state.compare)}`),
          ...rows(view, ["settings", state.compare], data.techniques[state.compare].settings),
        ]
      : []),
    menu(view, ["preset"], "Preset", [["", "choose …"], ...presets], (name) => view.preset(name)),
    about(view),
  );
}

// What the preset is, as long as it is one.
function about(view) {
  const text = element("p", { class: "doc", id: "about-preset" });
  const show = () => {
    text.textContent = view.data.presets[view.state.preset]?.about ?? "";
  };
  view.shows.push(show);
  show();
  return text;
}

// A menu of names that mean themselves.
const named = (view, name, label, after) =>
  menu(view, [name], label, view.data.menus[name].map((each) => [each, words(each)]), after);

const pair = (view, path, label, range) =>
  [0, 1].map((k) => number(view, [...path, k], { ...range, label: `${label} ${"uv"[k]}` }));

const tiling = (view, path, label) => [
  ...pair(view, [...path, "tiles"], `${label} tiling`, { low: 0.1, high: 32, step: 0.1, soft: true }),
  ...pair(view, [...path, "shift"], `${label} shift`, { low: -1, high: 1, step: 0.01, soft: true }),
];

function relief(view) {
  const { data, state } = view;
  const able = data.techniques[state.technique].heights;
  const reads = data.menus.heights.map((name) => [
    name,
    name,
    able.includes(name),
    `not by ${words(state.technique)}`,
  ]);
  return section(
    "Relief",
    true,
    number(view, ["scale"], {
      label: "scale",
      low: 0,
      high: 0.5,
      step: 0.001,
      soft: true,
      doc: "the whole height range as a fraction of a tile's width",
    }),
    number(view, ["level"], {
      label: "level",
      low: 0,
      high: 1,
      step: 0.01,
      doc: "the height that lies on the polygon: 1 pushes the relief in",
    }),
    named(view, "projection", "Projection"),
    ...(state.projection === "biased"
      ? [number(view, ["bias"], { label: "bias", low: 0, high: 2, step: 0.01 })]
      : []),
    menu(view, ["heights"], "Heights", reads),
    ...(state.heights === "sharp" ? [] : rows(view, ["smoothing"], data.settings.smoothing)),
    named(view, "shape", "Shape", (shape) => view.reshaped(shape)),
    named(view, "edge", "Edge"),
    ...pair(view, ["tiling"], "tiling", { low: 0.1, high: 32, step: 0.1, soft: true }),
    ...pair(view, ["shift"], "shift", { low: -1, high: 1, step: 0.01, soft: true }),
    check(view, ["fades"], "Fade with the distance"),
    ...(state.fades
      ? ["fade from", "gone at"].map((label, k) =>
          number(view, ["fade", k], { label, low: 0, high: 20, step: 0.05, soft: true }),
        )
      : []),
  );
}

// What one light is; `k` counts from 0.
function lamp(view, k) {
  const { kind } = view.state.lights[k];
  const path = ["lights", k];
  const name = `light ${k + 1}`;
  const degrees = (part, label, low, high) =>
    number(view, [...path, part], { label: `${name} ${label}`, low, high, step: 1 });
  const made = [
    menu(
      view,
      [...path, "kind"],
      `Light ${k + 1}`,
      view.data.lightKinds.map((each) => [each, each]),
    ),
  ];
  if (kind !== "point") {
    made.push(degrees("azimuth", "angle", -180, 180), degrees("elevation", "height", -90, 90));
  }
  if (kind !== "directional") {
    for (const c of [0, 1, 2]) {
      const range = { label: `${name} ${"xyz"[c]}`, low: -4, high: 4, step: 0.05, soft: true };
      made.push(number(view, [...path, "position", c], range));
    }
    made.push(
      number(view, [...path, "falloff"], { label: `${name} falloff`, low: 0, high: 8, step: 0.1 }),
    );
  }
  if (kind === "spot") {
    made.push(
      degrees("angle", "cone", 1, 179),
      number(view, [...path, "softness"], { label: `${name} softness`, low: 0, high: 1, step: 0.01 }),
    );
  }
  made.push(
    number(view, [...path, "intensity"], {
      label: `${name} strength`,
      low: 0,
      high: 10,
      step: 0.1,
      soft: true,
    }),
    color(view, [...path, "color"], `${name} color`),
    element("div", { class: "buttons" }, button(`Remove light ${k + 1}`, () => view.removeLight(k), { id: `remove-light-${k + 1}` })),
  );
  return made;
}

function light(view) {
  const { data, state } = view;
  const shown = ({ name }) =>
    name === "ambient" ||
    (name === "directional_occlusion"
      ? state.occlusion_kind === "directional"
      : state.shading_model === "phong");
  return section(
    "Light",
    true,
    named(view, "shadows", "Shadows"),
    ...(state.shadows === "none" ? [] : rows(view, ["shadowing"], data.settings.shadowing)),
    ...state.lights.flatMap((_, k) => lamp(view, k)),
    element(
      "div",
      { class: "buttons" },
      button("Add a light", () => view.addLight(), { id: "add-light" }),
    ),
    named(view, "shading_model", "Shading"),
    named(view, "occlusion_kind", "Occlusion"),
    ...rows(view, ["shading"], data.settings.shading.filter(shown)),
  );
}

const USED = {
  fog_color: () => true,
  fog_density: (kind) => kind !== "linear",
  fog_start: (kind) => kind === "linear",
  fog_end: (kind) => kind === "linear",
};

function air(view) {
  const { data, state } = view;
  const used = data.settings.air.filter(({ name }) => USED[name]?.(state.fog) ?? true);
  return section(
    "Air",
    false,
    named(view, "fog", "Fog"),
    ...(state.fog === "none" ? [] : rows(view, ["air"], used)),
    color(view, ["background"], "background"),
  );
}

// The numbers of a surface that have nothing to act on are left away.
const ACTS = {
  cutoff: ({ state }) => state.alpha === "mask",
  layer_color: ({ state }) => state.layer,
  layer_normal: ({ state }) => state.layer,
  emission: ({ pictures }) => Boolean(pictures.emission),
};

function surface(view) {
  const { data, state } = view;
  const finish = data.settings.finish[state.surface].filter(({ name }) => ACTS[name]?.(view) ?? true);
  return section(
    "Surface",
    false,
    named(view, "surface", "Surface"),
    ...rows(view, ["finish", state.surface], finish),
    named(view, "mapping", "Colour laid on"),
    named(view, "alpha", "Opacity"),
    check(view, ["apart"], "Maps with tilings of their own"),
    ...(state.apart
      ? Object.keys(state.tilings).flatMap((name) => tiling(view, ["tilings", name], words(name)))
      : []),
    ...(view.hasLayer
      ? [
          check(view, ["layer"], "Second layer"),
          ...(state.layer ? tiling(view, ["layer_tiling"], "layer") : []),
        ]
      : []),
  );
}

// --- maps ---------------------------------------------------------------------------------------

export const SLOTS = {
  height: "heights",
  base_color: "colour",
  opacity: "opacity",
  normal: "normals",
  roughness: "roughness",
  metallic: "metal",
  occlusion: "occlusion",
  packed: "occlusion, roughness, metal in r, g, b",
  emission: "emission",
};

function maps(view) {
  const list = (name, label, options) => {
    const id = `map-${name}`;
    const select = element("select", { id, name: id });
    for (const [value, text] of options) select.append(element("option", { value }, text));
    select.value = view.drop[name];
    select.addEventListener("change", () => {
      view.drop[name] = select.value;
    });
    return element("div", { class: "menu" }, element("label", { for: id }, label), select);
  };
  const file = element("input", { type: "file", accept: "image/*", id: "map-file", multiple: true });
  file.addEventListener("change", () => {
    view.takeMaps([...file.files]);
    file.value = "";
  });
  return section(
    "Maps",
    false,
    element("p", { class: "doc" }, "Drop pictures on the page, or choose them."),
    list("slot", "Use it as", [["", "what its name says"], ...Object.entries(SLOTS)]),
    list("channel", "Channel", [["luminance", "luminance"], ...[..."rgba"].map((c) => [c, c])]),
    list("polarity", "White is", [["height", "high, or as it is"], ["depth", "deep: turn it over"]]),
    list("green", "Green is", [["gl", "up (OpenGL)"], ["dx", "down (DirectX)"]]),
    element("div", { class: "menu" }, element("label", { for: "map-file" }, "Pictures"), file),
    element("p", { class: "doc", id: "map-said" }, view.mapSaid),
    ...(view.hasHeights && view.pictures.normal
      ? [button("Make normals of the heights", () => view.leaveNormals(), { id: "leave-normals" })]
      : []),
  );
}

function picture(view) {
  const shows = [
    ["color", "the picture"],
    ["reads", "reads"],
    ["missed", "missed hits", view.hasHeights, "needs heights"],
    ["depth", "depth"],
  ];
  const meaning = {
    color: "",
    reads: "Heights read, from none (dark) to the most of a pixel (pale).",
    missed: "Against exact: orange passed through a feature, blue stopped short.",
    depth: "Near is pale, far is dark.",
  };
  return section(
    "Show",
    true,
    menu(view, ["show"], "Show", shows),
    element("p", { class: "doc" }, meaning[view.state.show]),
  );
}

function share(view) {
  const buttons = element(
    "div",
    { class: "buttons" },
    button("Copy as Python", () => view.copy("python"), { id: "copy-python" }),
    button("Copy as command", () => view.copy("command"), { id: "copy-command" }),
    ...(view.host ? [] : [button("Copy link", () => view.copy("link"), { id: "copy-link" })]),
    button("Save picture", () => view.save(), { id: "save" }),
    button("Frame it", () => view.frame(), { id: "frame" }),
    button("As at the start", () => view.reset(), { id: "reset" }),
  );
  return section("Take away", true, buttons, element("output", { id: "copied" }));
}
