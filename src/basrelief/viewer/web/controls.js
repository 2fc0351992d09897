// The panel: native controls for everything in the state, made from what the page knows of it.

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

// A slider and a number for one value. Wide ranges of numbers above 0 go by powers.
export function number(view, path, { label, doc = "", low, high, whole = false, step = null }) {
  const id = `control-${(count += 1)}`;
  const start = at(view.state, path);
  const [least, most] = [low ?? Math.min(0, 2 * start), high ?? Math.max(4 * Math.abs(start), 2)];
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
    ...(low != null && { min: String(low) }),
    ...(high != null && { max: String(high) }),
  });
  const rounded = (x) => {
    if (whole) return Math.round(x);
    return Number(x.toPrecision(wide ? 3 : 6));
  };
  const show = () => {
    const value = at(view.state, path);
    slider.value = String(toSlider(value));
    slider.setAttribute("aria-valuetext", String(value));
    if (document.activeElement !== field) field.value = String(Number(value.toPrecision(5)));
  };
  const take = (value) => {
    if (!Number.isFinite(value)) return;
    let held = Math.max(low ?? -Infinity, Math.min(high ?? Infinity, value));
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
  select.addEventListener("change", () => {
    set(view.state, path, select.value);
    after(select.value);
    view.changed(true);
  });
  view.shows.push(show);
  show();
  return element("div", { class: "menu" }, element("label", { for: id }, label), select);
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
  const focused = document.activeElement?.name;
  view.shows = [];
  panel.replaceChildren(
    ...[technique, relief, light, surface, maps, picture, share].map((make) => make(view)),
  );
  for (const made of panel.querySelectorAll("details")) {
    if (opened.has(made.id)) made.open = opened.get(made.id);
  }
  if (focused) panel.elements.namedItem(focused)?.focus?.();
}

function techniques(view) {
  return view.data.choices.technique.map((name) => {
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
    element("p", { class: "doc" }, data.presets[state.preset]?.about ?? ""),
  );
}

function relief(view) {
  const { data } = view;
  const pair = (name, label, range) =>
    [0, 1].map((k) => number(view, [name, k], { ...range, label: `${label} ${"uv"[k]}` }));
  return section(
    "Relief",
    true,
    number(view, ["scale"], {
      label: "scale",
      low: 0,
      high: 0.5,
      step: 0.001,
      doc: "the whole height range as a fraction of a tile's width",
    }),
    number(view, ["level"], {
      label: "level",
      low: 0,
      high: 1,
      step: 0.01,
      doc: "the height that lies on the polygon: 1 pushes the relief in",
    }),
    menu(
      view,
      ["projection"],
      "Projection",
      data.choices.projection.map((name) => [name, name]),
    ),
    ...(view.state.projection === "biased"
      ? [number(view, ["bias"], { label: "bias", low: 0, high: 2, step: 0.01 })]
      : []),
    menu(
      view,
      ["shape"],
      "Shape",
      data.choices.shape.map((name) => [name, name]),
      (shape) => view.reshaped(shape),
    ),
    ...pair("tiling", "tiling", { low: 0.1, high: 16, step: 0.1 }),
    ...pair("shift", "shift", { low: -1, high: 1, step: 0.01 }),
  );
}

function light(view) {
  const { data, state } = view;
  const lamps = state.lights.flatMap((lamp, k) => {
    const path = ["lights", k];
    const name = `light ${k + 1}`;
    const place =
      lamp.kind === "directional"
        ? [
            number(view, [...path, "azimuth"], { label: `${name} angle`, low: -180, high: 180, step: 1 }),
            number(view, [...path, "elevation"], { label: `${name} height`, low: 0, high: 90, step: 1 }),
          ]
        : [0, 1, 2].map((c) =>
            number(view, [...path, "position", c], {
              label: `${name} ${"xyz"[c]}`,
              low: -4,
              high: 4,
              step: 0.05,
            }),
          );
    const strength = { label: `${name} strength`, low: 0, high: 10, step: 0.1 };
    return [...place, number(view, [...path, "intensity"], strength)];
  });
  const options = (name) => data.choices[name].map((each) => [each, each]);
  return section(
    "Light",
    true,
    menu(view, ["shadows"], "Shadows", options("shadows")),
    ...(state.shadows === "none" ? [] : rows(view, ["shadowing"], data.settings.shadowing)),
    ...lamps,
    menu(view, ["shading_model"], "Shading", options("shading_model")),
    ...rows(
      view,
      ["shading"],
      data.settings.shading.filter(
        ({ name }) => name === "ambient" || (state.shading_model === "phong" && !/^dir/.test(name)),
      ),
    ),
  );
}

function surface(view) {
  const used = ["base_color", "normal_strength", "roughness", "metallic", "occlusion", "emission"];
  const settings = view.data.settings.finish.filter(({ name }) => used.includes(name));
  return section("Surface", false, ...rows(view, ["finish"], settings));
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
  const file = element("input", { type: "file", accept: "image/*", id: "map-file" });
  file.addEventListener("change", () => {
    if (file.files[0]) view.takeMap(file.files[0]);
    file.value = "";
  });
  return section(
    "Maps",
    false,
    element("p", { class: "doc" }, "Drop a picture on the page, or choose one."),
    list("slot", "Use it as", Object.entries(SLOTS)),
    list("channel", "Channel", [["luminance", "luminance"], ...[..."rgba"].map((c) => [c, c])]),
    list("polarity", "White is", [["height", "high, or as it is"], ["depth", "deep: turn it over"]]),
    list("green", "Green is", [["gl", "up (OpenGL)"], ["dx", "down (DirectX)"]]),
    element("div", { class: "menu" }, element("label", { for: "map-file" }, "Picture"), file),
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
    button("Copy link", () => view.copy("link"), { id: "copy-link" }),
    button("Save picture", () => view.save(), { id: "save" }),
    button("Frame it", () => view.frame(), { id: "frame" }),
    button("As at the start", () => view.reset(), { id: "reset" }),
  );
  return section("Take away", true, buttons, element("output", { id: "copied" }));
}
