// The panel: all that a person can set, by sections, made from what the page knows of it.

import { button, check, color, element, menu, number, section } from "view/controls.js";
import { maps } from "view/mappanel.js";
import { words } from "view/text.js";

/** @import { Menus, Setting } from "view/data" */
/** @import { NumberOptions, Option, Path } from "view/controls.js" */
/** @import { View } from "view/main.js" */

/** @typedef {Omit<NumberOptions, "label">} Range */
/** @typedef {(value: string) => void} MenuAction */

/**
 * Rows for the settings of a record, a row for each component of a colour.
 * @param {View} view
 * @param {Path} path
 * @param {Setting[]} settings
 * @returns {HTMLElement[]}
 */
function rows(view, path, settings) {
  return settings.flatMap((each) => {
    if (!Array.isArray(each.default)) {
      return [number(view, [...path, each.name], { ...each, label: words(each.name) })];
    }
    if (each.name.endsWith("color")) {
      return [color(view, [...path, each.name], words(each.name), each.doc)];
    }
    return each.default.map((_, k) =>
      number(view, [...path, each.name, k], {
        ...each,
        high: each.high ?? 2,
        label: `${words(each.name)} ${"rgb"[k]}`,
      }),
    );
  });
}

/**
 * The whole panel, made anew where a choice changes what can be set.
 * @param {View} view
 * @param {HTMLFormElement} panel
 */
export function build(view, panel) {
  const opened = new Map([...panel.querySelectorAll("details")].map((d) => [d.id, d.open]));
  const active = /** @type {HTMLInputElement | null} */ (document.activeElement);
  const inside = panel.contains(active);
  const name = active?.name || active?.id;
  const near = active?.closest(".map")?.querySelector("button")?.id;
  const within = active?.closest("details")?.id;
  view.shows = [];
  panel.replaceChildren(
    ...[technique, relief, light, camera, surface, air, maps, picture, share].map((make) =>
      make(view),
    ),
  );
  for (const made of panel.querySelectorAll("details")) {
    made.open = opened.get(made.id) ?? made.open;
  }
  if (!inside) return;
  // what is gone leaves the focus to what is near, or to its section
  const places = [name, near].map((it) => it && panel.elements.namedItem(it));
  const again = places.find(Boolean) ?? panel.querySelector(`#${within} summary`);
  /** @type {HTMLElement | null} */ (again)?.focus();
}

/**
 * @param {View} view
 * @returns {Option[]}
 */
function techniques(view) {
  return view.data.menus.technique.map((name) => {
    const why = !view.hasHeights && name !== "flat" ? "needs heights" : "";
    return [name, words(name), !why, why];
  });
}

/** @param {View} view */
function technique(view) {
  const { data, state } = view;
  const made = data.techniques[state.technique];
  /** @type {(name: string) => void} */
  const chosen = (name) => {
    const next = data.techniques[name];
    Object.assign(state, { level: next.level, projection: next.projection });
  };
  /** @type {Option[]} */
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

/**
 * What the preset is, as long as it is one.
 * @param {View} view
 */
function about(view) {
  const text = element("p", { class: "doc", id: "about-preset" });
  const show = () => {
    text.textContent = view.data.presets[view.state.preset]?.about ?? "";
  };
  view.shows.push(show);
  show();
  return text;
}

/**
 * A menu of names that mean themselves.
 * @type {(view: View, name: keyof Menus, label: string, after?: MenuAction) => HTMLElement}
 */
const named = (view, name, label, after) =>
  menu(
    view,
    [name],
    label,
    view.data.menus[name].map((each) => [each, words(each)]),
    after,
  );

/** @type {(view: View, path: Path, label: string, range: Range) => HTMLElement[]} */
const pair = (view, path, label, range) =>
  [0, 1].map((k) => number(view, [...path, k], { ...range, label: `${label} ${"uv"[k]}` }));

/** @type {(view: View, path: Path, label: string) => HTMLElement[]} */
const tiling = (view, path, label) => [
  ...pair(view, [...path, "tiles"], `${label} tiling`, {
    low: 0.1,
    high: 32,
    step: 0.1,
    soft: true,
  }),
  ...pair(view, [...path, "shift"], `${label} shift`, { low: -1, high: 1, step: 0.01, soft: true }),
];

/** @param {View} view */
function relief(view) {
  const { data, state } = view;
  const able = data.techniques[state.technique].heights;
  /** @type {Option[]} */
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

/**
 * What one light is; `k` counts from 0.
 * @param {View} view
 * @param {number} k
 */
function lamp(view, k) {
  const kinds = view.data.lightKinds;
  const numbers = kinds[view.state.lights[k].kind];
  const path = ["lights", k];
  const name = `light ${k + 1}`;
  // a row where a light is made by such a number
  /** @type {(part: string, range: Range, label?: string, by?: string[], rest?: Path) => HTMLElement[]} */
  const row = (part, range, label = part, by = [part], rest = []) =>
    by.some((each) => numbers.includes(each))
      ? [number(view, [...path, part, ...rest], { ...range, label: `${name} ${label}` })]
      : [];
  const aimed = ["azimuth", "target"];
  const place = { low: -4, high: 4, step: 0.05, soft: true };
  return [
    menu(
      view,
      [...path, "kind"],
      `Light ${k + 1}`,
      Object.keys(kinds).map((each) => [each, each]),
    ),
    ...row("azimuth", { low: -180, high: 180, step: 1 }, "azimuth", aimed),
    ...row("elevation", { low: -90, high: 90, step: 1 }, "elevation", aimed),
    ...[0, 1, 2].flatMap((c) => row("position", place, "xyz"[c], ["position"], [c])),
    ...row("falloff", { low: 0, high: 8, step: 0.1 }),
    ...row("angle", { low: 1, high: 179, step: 1 }, "cone"),
    ...row("softness", { low: 0, high: 1, step: 0.01 }),
    ...row("intensity", { low: 0, high: 10, step: 0.1, soft: true }),
    color(view, [...path, "color"], `${name} color`),
    element(
      "div",
      { class: "buttons" },
      button(`Remove light ${k + 1}`, () => view.removeLight(k), { id: `remove-light-${k + 1}` }),
    ),
  ];
}

/** @param {View} view */
function light(view) {
  const { data, state } = view;
  /** @type {(setting: Setting) => boolean} */
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

/**
 * Where it is seen from.
 * @param {View} view
 */
function camera(view) {
  /** @type {(name: string) => Path} */
  const path = (name) => ["camera", name];
  const degrees = { step: 1, soft: true };
  const parallel = view.state.camera.orthographic_height !== null;
  return section(
    "Camera",
    false,
    element(
      "p",
      { class: "doc" },
      "Drag turns; with Shift, or the right button, it moves; with Alt or Ctrl it turns the first directional light. The wheel zooms.",
    ),
    number(view, path("azimuth"), { ...degrees, label: "camera azimuth", low: -180, high: 180 }),
    number(view, path("elevation"), {
      ...degrees,
      label: "camera elevation",
      low: view.data.shapes[view.state.shape].flat ? 2 : -89,
      high: 89,
    }),
    number(view, path("distance"), {
      label: "distance",
      low: 0.1,
      high: 20,
      step: 0.01,
      soft: true,
      open: () => view.wholeCamera().distance,
    }),
    check(view, path("orthographic_height"), "Orthographic", {
      name: "orthographic",
      ticked: () => view.heightSeen(),
      not: null,
    }),
    parallel
      ? number(view, path("orthographic_height"), {
          label: "height seen",
          low: 0.05,
          high: 10,
          step: 0.01,
          soft: true,
        })
      : number(view, path("field_of_view"), { label: "field of view", low: 1, high: 120, step: 1 }),
  );
}

/** @type {{ [setting: string]: (kind: string) => boolean }} */
const USED = {
  fog_color: () => true,
  fog_density: (kind) => kind !== "linear",
  fog_start: (kind) => kind === "linear",
  fog_end: (kind) => kind === "linear",
};

/** @param {View} view */
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

/**
 * The numbers of a surface that have nothing to act on are left away.
 * @type {{ [setting: string]: (view: View) => boolean }}
 */
const ACTS = {
  cutoff: ({ state }) => state.alpha === "mask",
  layer_color: ({ state }) => state.layer,
  layer_normal: ({ state }) => state.layer,
  emission: ({ pictures }) => Boolean(pictures.emission),
};

/** @param {View} view */
function surface(view) {
  const { data, state } = view;
  const finish = data.settings.finish[state.surface].filter(
    ({ name }) => ACTS[name]?.(view) ?? true,
  );
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

/** @param {View} view */
function picture(view) {
  /** @type {Option[]} */
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

/** @param {View} view */
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
