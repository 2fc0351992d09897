// The panel: the settings of the page in sections, built from the page's data.

import { button, check, color, element, menu, number, section } from "view/controls.js";
import { maps } from "view/mappanel.js";
import { words } from "view/text.js";

/** @import { Menus, Setting } from "view/data" */
/** @import { Child, NumberOptions, Option, Path } from "view/controls.js" */
/** @import { ViewerPage } from "view/main.js" */

/** @typedef {Omit<NumberOptions, "label">} Range */
/** @typedef {(value: string) => void} MenuAction */

const TILES = { low: 0.1, high: 32, step: 0.1, soft: true };
const SHIFT = { low: -1, high: 1, step: 0.01, soft: true };
/**
 * Conditions under which settings have an effect, by record and name; others always have one.
 * @type {{ [setting: string]: (view: ViewerPage) => boolean }}
 */
const ACTS = {
  "surface_parameters.cutoff": ({ state }) => state.alpha === "mask",
  "surface_parameters.layer_color": ({ state }) => state.layer,
  "surface_parameters.layer_normal": ({ state }) => state.layer,
  "surface_parameters.emission": ({ pictures }) => Boolean(pictures.emission),
  "shading.diffuse": ({ state }) => state.shading_model === "phong",
  "shading.specular": ({ state }) => state.shading_model === "phong",
  "shading.shininess": ({ state }) => state.shading_model === "phong",
  "shading.directional_occlusion": ({ state }) => state.occlusion_kind === "directional",
  "fog.fog_density": ({ state }) => state.fog_mode !== "linear",
  "fog.fog_start": ({ state }) => state.fog_mode === "linear",
  "fog.fog_end": ({ state }) => state.fog_mode === "linear",
};

/**
 * Rows for the settings of a record that have an effect, one for each component of a colour.
 * @param {ViewerPage} view
 * @param {Path} path
 * @param {Setting[]} settings
 */
function rows(view, path, settings) {
  const acting = settings.filter(({ name }) => ACTS[`${path[0]}.${name}`]?.(view) ?? true);
  return acting.flatMap((each) => {
    const own = [...path, each.name];
    const label = words(each.name);
    if (!Array.isArray(each.default)) return number(view, own, { ...each, label });
    if (each.name.endsWith("color")) return color(view, own, label, each.doc);
    const range = { ...each, high: each.high ?? 2 };
    return each.default.map((_, k) =>
      number(view, [...own, k], { ...range, label: `${label} ${"rgb"[k]}` }),
    );
  });
}

/** @type {(...made: Child[]) => HTMLElement} */
const buttons = (...made) => element("div", { class: "buttons" }, made);

/**
 * Build the panel, anew where a choice changes the available settings.
 * @param {ViewerPage} view
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
    ...[technique, relief, light, camera, surface, fog, maps, picture, share].map((make) =>
      make(view),
    ),
  );
  for (const made of panel.querySelectorAll("details")) {
    made.open = opened.get(made.id) ?? made.open;
  }
  if (!inside) return;
  // where the focused control is gone, focus one nearby, or its section
  const places = [name, near].map((it) => it && panel.elements.namedItem(it));
  const again = places.find(Boolean) ?? panel.querySelector(`#${within} summary`);
  /** @type {HTMLElement | null} */ (again)?.focus();
}

/**
 * @param {ViewerPage} view
 * @returns {Option[]}
 */
function techniques(view) {
  return view.data.menus.technique.map((name) => {
    const why = !view.hasHeights && name !== "flat" ? "needs heights" : "";
    return [name, words(name), !why, why];
  });
}

/** @param {ViewerPage} view */
function technique(view) {
  const { data, state } = view;
  const made = data.techniques[state.technique];
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
    menu(view, ["technique"], "Technique", techniques(view), (name) => view.useTechnique(name)),
    element("p", { class: "doc" }, made.doc),
    rows(view, ["settings", state.technique], made.settings),
    menu(view, ["compare"], "Compare with", [["", "none"], ...techniques(view)]),
    state.compare !== "" &&
      state.compare !== state.technique && [
        element("p", { class: "doc" }, `Right of the divider: ${words(state.compare)}`),
        ...rows(view, ["settings", state.compare], data.techniques[state.compare].settings),
      ],
    menu(view, ["preset"], "Preset", [["", "choose …"], ...presets], (name) => view.preset(name)),
    about(view),
  );
}

/**
 * The description of the preset, while the settings are its own.
 * @param {ViewerPage} view
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
 * A menu whose values are their own labels.
 * @type {(view: ViewerPage, name: keyof Menus, label: string, after?: MenuAction) => HTMLElement}
 */
const named = (view, name, label, after) =>
  menu(
    view,
    [name],
    label,
    view.data.menus[name].map((each) => [each, words(each)]),
    after,
  );

/** @type {(view: ViewerPage, path: Path, label: string, range: Range) => HTMLElement[]} */
const pair = (view, path, label, range) =>
  [0, 1].map((k) => number(view, [...path, k], { ...range, label: `${label} ${"uv"[k]}` }));

/** @type {(view: ViewerPage, path: Path, label: string) => HTMLElement[]} */
const tiling = (view, path, label) => [
  ...pair(view, [...path, "tiles"], `${label} tiling`, TILES),
  ...pair(view, [...path, "shift"], `${label} shift`, SHIFT),
];

/** @param {ViewerPage} view */
function relief(view) {
  const { data, state } = view;
  const able = data.techniques[state.technique].heights;
  /** @type {Option[]} */
  const reads = data.menus.heights.map((name) => [
    name,
    name,
    able.includes(name),
    `not with ${words(state.technique)}`,
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
      doc: "height range as a fraction of a tile's width",
    }),
    number(view, ["reference_height"], {
      label: "reference height",
      low: 0,
      high: 1,
      step: 0.01,
      doc: "height that lies on the polygon; 1 pushes the relief in",
    }),
    named(view, "projection", "Projection"),
    state.projection === "biased" &&
      number(view, ["bias"], { label: "bias", low: 0, high: 2, step: 0.01 }),
    menu(view, ["heights"], "Heights", reads),
    state.heights !== "sharp" && rows(view, ["smoothing"], data.settings.smoothing),
    named(view, "shape", "Shape", (shape) => view.reshaped(shape)),
    named(view, "edge", "Edge"),
    pair(view, ["tiling"], "tiling", TILES),
    pair(view, ["shift"], "shift", SHIFT),
    check(view, ["fades"], "Distance fade"),
    state.fades &&
      ["fade start", "fade end"].map((label, k) =>
        number(view, ["fade", k], { label, low: 0, high: 20, step: 0.05, soft: true }),
      ),
  );
}

/**
 * Rows for a light; `k` counts from 0.
 * @param {ViewerPage} view
 * @param {number} k
 */
function lamp(view, k) {
  const kinds = view.data.lightKinds;
  const numbers = kinds[view.state.lights[k].kind];
  const path = ["lights", k];
  const name = `light ${k + 1}`;
  // a row, where the light's kind has this number
  /** @type {(part: string, range: Range, label?: string, by?: string[], rest?: Path) => Child} */
  const row = (part, range, label = part, by = [part], rest = []) =>
    by.some((each) => numbers.includes(each)) &&
    number(view, [...path, part, ...rest], { ...range, label: `${name} ${label}` });
  const aimed = ["azimuth", "target"];
  const place = { low: -4, high: 4, step: 0.05, soft: true };
  return [
    menu(
      view,
      [...path, "kind"],
      `Light ${k + 1}`,
      Object.keys(kinds).map((each) => [each, each]),
    ),
    row("azimuth", { low: -180, high: 180, step: 1 }, "azimuth", aimed),
    row("elevation", { low: -90, high: 90, step: 1 }, "elevation", aimed),
    ...[0, 1, 2].map((c) => row("position", place, "xyz"[c], ["position"], [c])),
    row("falloff", { low: 0, high: 8, step: 0.1 }),
    row("angle", { low: 1, high: 179, step: 1 }, "cone"),
    row("softness", { low: 0, high: 1, step: 0.01 }),
    row("intensity", { low: 0, high: 10, step: 0.1, soft: true }),
    color(view, [...path, "color"], `${name} color`),
    buttons(
      button(`Remove light ${k + 1}`, () => view.removeLight(k), { id: `remove-light-${k + 1}` }),
    ),
  ];
}

/** @param {ViewerPage} view */
function light(view) {
  const { data, state } = view;
  return section(
    "Light",
    true,
    named(view, "shadows", "Shadows"),
    state.shadows !== "none" && rows(view, ["shadowing"], data.settings.shadowing),
    state.lights.flatMap((_, k) => lamp(view, k)),
    buttons(button("Add light", () => view.addLight(), { id: "add-light" })),
    named(view, "shading_model", "Shading"),
    named(view, "occlusion_kind", "Occlusion"),
    rows(view, ["shading"], data.settings.shading),
  );
}

/**
 * The section of the camera.
 * @param {ViewerPage} view
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
      "Drag: orbit. Shift or right button: pan. Alt or Ctrl: turn the first directional light. Wheel: zoom.",
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
          label: "view height",
          low: 0.05,
          high: 10,
          step: 0.01,
          soft: true,
        })
      : number(view, path("field_of_view"), { label: "field of view", low: 1, high: 120, step: 1 }),
  );
}

/** @param {ViewerPage} view */
function fog(view) {
  const { data, state } = view;
  return section(
    "Fog",
    false,
    named(view, "fog_mode", "Fog"),
    state.fog_mode !== "none" && rows(view, ["fog"], data.settings.fog),
    color(view, ["background"], "background"),
  );
}

/** @param {ViewerPage} view */
function surface(view) {
  const { data, state } = view;
  return section(
    "Surface",
    false,
    named(view, "surface", "Surface"),
    rows(
      view,
      ["surface_parameters", state.surface],
      data.settings.surface_parameters[state.surface],
    ),
    named(view, "mapping", "Mapping"),
    named(view, "alpha", "Opacity"),
    check(view, ["apart"], "Separate tilings"),
    state.apart &&
      Object.keys(state.tilings).flatMap((name) => tiling(view, ["tilings", name], words(name))),
    data.constants.layer && check(view, ["layer"], "Second layer"),
    data.constants.layer && state.layer && tiling(view, ["layer_tiling"], "layer"),
  );
}

/** @param {ViewerPage} view */
function picture(view) {
  /** @type {Option[]} */
  const shows = [
    ["color", "colour"],
    ["reads", "reads"],
    ["missed", "missed hits", view.hasHeights, "needs heights"],
    ["depth", "depth"],
  ];
  const meaning = {
    color: "",
    reads: "Heights read in each pixel, from none (dark) to the maximum (pale).",
    missed: "Compared with exact: orange passed through a feature, blue stopped short.",
    depth: "Near is pale, far is dark.",
  };
  return section(
    "Show",
    true,
    menu(view, ["show"], "Show", shows),
    element("p", { class: "doc" }, meaning[view.state.show]),
  );
}

/** @param {ViewerPage} view */
function share(view) {
  const made = buttons(
    button("Copy as Python", () => view.copy("python"), { id: "copy-python" }),
    button("Copy as command", () => view.copy("command"), { id: "copy-command" }),
    !view.host && button("Copy link", () => view.copy("link"), { id: "copy-link" }),
    button("Save picture", () => view.save(), { id: "save" }),
    button("Frame", () => view.frame(), { id: "frame" }),
    button("Reset", () => view.reset(), { id: "reset" }),
  );
  return section("Export", true, made, element("output", { id: "copied" }));
}
