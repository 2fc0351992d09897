// The panel: the settings of the page in sections, built from the page's data.

import { button, check, color, element, menu, number, section } from "view/controls.js";
import { maps } from "view/mappanel.js";
import { OPENING } from "view/opened.js";
import { words } from "view/text.js";

/** @import { Control, Setting } from "view/data" */
/** @import { Child, NumberOptions, Option, Path } from "view/controls.js" */
/** @import { ViewerPage } from "view/main.js" */

/** @typedef {Omit<NumberOptions, "label">} Range */
/** @typedef {(value: string) => void} MenuAction */

/** @type {{ [name: string]: string }} */
const LABELS = {
  alpha: "Opacity",
  fog_mode: "Fog",
  occlusion_kind: "Occlusion",
  shading_model: "Shading",
};
/** @type {{ [name: string]: string }} */
const LIGHT_LABELS = { angle: "cone" };
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
  "surface_parameters.specular": ({ state }) => state.shading_model === "phong",
  "surface_parameters.shininess": ({ state }) => state.shading_model === "phong",
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
  return acting.flatMap((setting) => {
    const own = [...path, setting.name];
    const label = words(setting.name);
    if (!Array.isArray(setting.default)) return number(view, own, { ...setting, label });
    if (setting.name.endsWith("color")) return color(view, own, label, setting.doc);
    const range = { ...setting, high: setting.high ?? 2 };
    return setting.default.map((_, k) =>
      number(view, [...own, k], { ...range, label: `${label} ${"rgb"[k]}` }),
    );
  });
}

/** @type {(...made: Child[]) => HTMLElement} */
const buttons = (...made) => element("div", { class: "buttons" }, made);

/**
 * Build the panel, also again after a choice that changes the available settings. Sections stay open
 * or closed, and the focus stays where it is.
 * @param {ViewerPage} view
 * @param {HTMLFormElement} panel
 */
export function build(view, panel) {
  const wasOpen = new Map([...panel.querySelectorAll("details")].map((d) => [d.id, d.open]));
  const focused = /** @type {HTMLInputElement | null} */ (document.activeElement);
  const hadFocus = panel.contains(focused);
  const name = focused?.name || focused?.id;
  const mapButton = focused?.closest(".map")?.querySelector("button")?.id;
  const sectionId = focused?.closest("details")?.id;
  view.shows = [];
  panel.replaceChildren(
    ...[technique, relief, light, camera, surface, fog, maps, picture, share].map((make) =>
      make(view),
    ),
  );
  for (const details of panel.querySelectorAll("details")) {
    details.open = wasOpen.get(details.id) ?? details.open;
  }
  if (!hadFocus) return;
  // where the focused control is gone, focus the button of its map, or its section
  const controls = [name, mapButton].map((key) => key && panel.elements.namedItem(key));
  const next = controls.find(Boolean) ?? panel.querySelector(`#${sectionId} summary`);
  /** @type {HTMLElement | null} */ (next)?.focus();
}

/**
 * Options of a menu of techniques.
 * @param {ViewerPage} view
 * @returns {Option[]}
 */
function techniqueOptions(view) {
  return view.data.menus.technique.map((name) => {
    const why = !view.hasHeights && name !== "flat" ? "needs heights" : "";
    return [name, words(name), !why, why];
  });
}

/** @param {ViewerPage} view */
function technique(view) {
  const { data, state } = view;
  const chosen = data.techniques[state.technique];
  /** @type {Option[]} */
  const presets = Object.entries(data.presets).map(([name, preset]) => [
    name,
    name,
    Boolean(preset.state),
    preset.why,
  ]);
  return section(
    "Technique",
    true,
    menu(view, ["technique"], "Technique", techniqueOptions(view), (name) =>
      view.useTechnique(name),
    ),
    element("p", { class: "doc" }, chosen.doc),
    rows(view, ["settings", state.technique], chosen.settings),
    menu(view, ["compare"], "Compare with", [["", "none"], ...techniqueOptions(view)]),
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
 * Controls of two numbers, along u and v.
 * @type {(view: ViewerPage, path: Path, label: string, range: Range) => HTMLElement[]}
 */
const pair = (view, path, label, range) =>
  [0, 1].map((k) => number(view, [...path, k], { ...range, label: `${label} ${"uv"[k]}` }));

/**
 * Controls of the tiles and the shift of a map or a layer.
 * @type {(view: ViewerPage, path: Path, label: string) => HTMLElement[]}
 */
const tiling = (view, path, label) => {
  const { tiles, shift } = view.data.controls.tiling;
  return [
    ...pair(view, [...path, "tiles"], `${label} tiling`, tiles),
    ...pair(view, [...path, "shift"], `${label} shift`, shift),
  ];
};

/**
 * Rows of settings that need more than a control of their kind.
 * @type {{ [name: string]: (view: ViewerPage, control: Control) => Child | Child[] }}
 */
const ROWS = {
  bias: (view, control) => view.state.projection === "biased" && controlOf(view, "bias", control),
  heights: (view, { doc }) => [
    menu(view, ["heights"], "Heights", heightsOptions(view), undefined, doc),
    ...(view.state.heights === "sharp"
      ? []
      : rows(view, ["smoothing"], view.data.settings.smoothing)),
  ],
  opening: (view, control) => {
    // a material without heights has nothing to open, and one without dust nothing to open it by
    if (!view.hasHeights || !view.pictures.dust) return [];
    const { doc } = control;
    const ticked = () => OPENING;
    /** @type {(opening: unknown) => void} */
    const take = (opening) => view.setOpening(/** @type {number | null} */ (opening));
    return [
      check(view, ["opening"], "Hole", { name: "hole", ticked, not: null, doc, take }),
      ...(view.state.opening === null
        ? []
        : [number(view, ["opening"], { ...control, label: "opening" })]),
    ];
  },
  shape: (view, { doc }) => choice(view, "shape", doc, (shape) => view.reshaped(shape)),
  fade: (view, control) => [
    check(view, ["fades"], "Distance fade", { doc: control.doc }),
    ...(view.state.fades
      ? ["fade start", "fade end"].map((label, k) =>
          number(view, ["fade", k], { ...control, label }),
        )
      : []),
  ],
  shadows: (view, { doc }) => [
    choice(view, "shadows", doc),
    ...(view.state.shadows === "none"
      ? []
      : rows(view, ["shadowing"], view.data.settings.shadowing)),
  ],
  fog_mode: (view, { doc }) => [
    choice(view, "fog_mode", doc),
    ...(view.state.fog_mode === "none" ? [] : rows(view, ["fog"], view.data.settings.fog)),
  ],
  background: (view, { doc }) => color(view, ["background"], "background", doc),
  layer_offset: (view, { doc }) => (view.state.layer ? choice(view, "layer_offset", doc) : []),
  surface: (view, { doc }) => [
    choice(view, "surface", doc),
    ...rows(
      view,
      ["surface_parameters", view.state.surface],
      view.data.settings.surface_parameters[view.state.surface],
    ),
  ],
};

/**
 * The rows of the settings of a group, in the order of their declarations.
 * @param {ViewerPage} view
 * @param {string} group
 * @returns {Child[]}
 */
const settings = (view, group) =>
  Object.entries(view.data.controls.scene)
    .filter(([name, control]) => control.group === group && name in view.state)
    .flatMap(([name, control]) =>
      name in ROWS ? ROWS[name](view, control) : controlOf(view, name, control),
    );

/**
 * A control of the kind of a setting.
 * @param {ViewerPage} view
 * @param {string} name
 * @param {Control} control
 * @returns {Child | Child[]}
 */
function controlOf(view, name, control) {
  if (control.kind === "choice") return choice(view, name, control.doc);
  if (control.kind === "pair") return pair(view, [name], words(name), control);
  return number(view, [name], { ...control, label: words(name) });
}

/**
 * A menu whose values are their own labels.
 * @param {ViewerPage} view
 * @param {string} name
 * @param {string} doc
 * @param {MenuAction} [after]
 */
function choice(view, name, doc, after) {
  const text = words(name);
  const label = LABELS[name] ?? text[0].toUpperCase() + text.slice(1);
  return menu(
    view,
    [name],
    label,
    view.data.menus[name].map((each) => [each, words(each)]),
    after,
    doc,
  );
}

/**
 * Options of the menu of heights, disabled where the technique does not read them.
 * @param {ViewerPage} view
 * @returns {Option[]}
 */
function heightsOptions({ data, state }) {
  const supported = data.techniques[state.technique].heights;
  return data.menus.heights.map((name) => [
    name,
    name,
    supported.includes(name),
    `not with ${words(state.technique)}`,
  ]);
}

/** @param {ViewerPage} view */
const relief = (view) => section("Relief", true, settings(view, "Relief"));

/**
 * Rows for a light; `k` counts from 0. A target is set by the angles of its direction.
 * @param {ViewerPage} view
 * @param {number} k
 */
function lightRows(view, k) {
  const kinds = view.data.lightKinds;
  const { lights } = view.data.controls;
  const path = ["lights", k];
  const name = `light ${k + 1}`;
  /** @type {(part: string, label: string, rest?: Path) => Child} */
  const row = (part, label, rest = []) =>
    number(view, [...path, part, ...rest], { ...lights[part], label: `${name} ${label}` });
  const parts = kinds[view.state.lights[k].kind].flatMap((part) =>
    part === "target" ? ["azimuth", "elevation"] : [part],
  );
  return [
    menu(
      view,
      [...path, "kind"],
      `Light ${k + 1}`,
      Object.keys(kinds).map((kind) => [kind, kind]),
    ),
    ...parts.flatMap((part) => {
      if (part.endsWith("color")) {
        return color(view, [...path, part], `${name} ${words(part)}`, lights[part].doc);
      }
      if (lights[part].kind === "number") return row(part, LIGHT_LABELS[part] ?? words(part));
      return [0, 1, 2].map((c) => row(part, "xyz"[c], [c]));
    }),
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
    state.lights.flatMap((_, k) => lightRows(view, k)),
    buttons(button("Add light", () => view.addLight(), { id: "add-light" })),
    settings(view, "Light"),
    rows(view, ["shading"], data.settings.shading),
  );
}

/** @param {ViewerPage} view */
function camera(view) {
  /** @type {(name: string) => Path} */
  const path = (name) => ["camera", name];
  const controls = view.data.controls.camera;
  const isOrthographic = view.state.camera.orthographic_height !== null;
  return section(
    "Camera",
    false,
    element(
      "p",
      { class: "doc" },
      "Drag: orbit. Shift or right button: pan. Alt or Ctrl: turn the first directional light. Wheel: zoom.",
    ),
    number(view, path("azimuth"), { ...controls.azimuth, label: "camera azimuth" }),
    number(view, path("elevation"), {
      ...controls.elevation,
      label: "camera elevation",
      ...(view.data.shapes[view.state.shape].lying && { low: 2 }),
    }),
    number(view, path("distance"), {
      ...controls.distance,
      label: "distance",
      open: () => view.wholeCamera().distance,
    }),
    check(view, path("orthographic_height"), "Orthographic", {
      name: "orthographic",
      ticked: () => view.heightSeen(),
      not: null,
    }),
    isOrthographic
      ? number(view, path("orthographic_height"), {
          ...controls.orthographic_height,
          label: "view height",
        })
      : number(view, path("field_of_view"), { ...controls.field_of_view, label: "field of view" }),
  );
}

/** @param {ViewerPage} view */
const fog = (view) => section("Fog", false, settings(view, "Fog"));

/** @param {ViewerPage} view */
function surface(view) {
  const { data, state } = view;
  return section(
    "Surface",
    false,
    settings(view, "Surface"),
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
    pair(view, ["scroll"], "scroll", view.data.controls.scroll.u),
  );
}

/** @param {ViewerPage} view */
function share(view) {
  const actions = buttons(
    button("Copy as Python", () => view.copy("python"), { id: "copy-python" }),
    button("Copy as command", () => view.copy("command"), { id: "copy-command" }),
    !view.host && button("Copy link", () => view.copy("link"), { id: "copy-link" }),
    button("Save picture", () => view.save(), { id: "save" }),
    button("Frame", () => view.frame(), { id: "frame" }),
    button("Reset", () => view.reset(), { id: "reset" }),
  );
  return section("Export", true, actions, element("output", { id: "copied" }));
}
