// Labelled native controls for values of the state.

import { decoded, encoded } from "view/srgb.js";

/** @import { Fields } from "view/checks.js" */
/** @import { ViewerPage } from "view/main.js" */
/** @import { State } from "view/state.js" */

/**
 * Where a value lies in the state: ["settings", "relief", "max_steps"], ["tiling", 0].
 * @typedef {(string | number)[]} Path
 */
/** @typedef {HTMLElement & { disabled?: boolean }} Control */
/** @typedef {[value: string, text: string, there?: boolean, why?: string]} Option */
/** @typedef {Node | string | false} Child */
/**
 * Options of a control for a number.
 * @typedef {object} NumberOptions
 * @property {string} label
 * @property {string} [doc]
 * @property {number | null} [low]
 * @property {number | null} [high]
 * @property {boolean} [whole]
 * @property {number | null} [step]
 * @property {boolean} [soft] whether the range is the slider's alone and grows with the value
 * @property {() => number} [open] the value where the state has null
 */

/** @type {{ [key: string]: number }} */
const WAYS = { ArrowRight: 1, ArrowUp: 1, ArrowLeft: -1, ArrowDown: -1 };
let pressed = false;

/** @type {(id: string) => HTMLElement} */
export const byId = (id) => /** @type {HTMLElement} */ (document.getElementById(id));

/**
 * Act once no button is pressed, as a pressed control must still exist at its release.
 * @param {() => void} act
 */
export function afterPress(act) {
  setTimeout(() => {
    if (!pressed) act();
    else addEventListener("pointerup", () => setTimeout(act), { once: true });
  });
}
/** @type {(now: boolean) => () => void} */
const press = (now) => () => {
  pressed = now;
};
addEventListener("pointerdown", press(true), true);
addEventListener("pointerup", press(false), true);
addEventListener("pointercancel", press(false), true);

/**
 * An element with children; those that are false are omitted.
 * @template {keyof HTMLElementTagNameMap} Name
 * @param {Name} name
 * @param {{ [name: string]: string | boolean }} attributes
 * @param {(Child | Child[])[]} children
 * @returns {HTMLElementTagNameMap[Name]}
 */
export function element(name, attributes = {}, ...children) {
  const made = document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) {
    if (key in made && typeof value !== "string") Reflect.set(made, key, value);
    else made.setAttribute(key, String(value));
  }
  made.append(...children.flat().filter((child) => child !== false));
  return made;
}

/** @type {(state: State, path: Path) => unknown} */
const at = (state, path) =>
  path.reduce((value, key) => /** @type {Fields} */ (value)[key], /** @type {unknown} */ (state));

/**
 * @param {State} state
 * @param {Path} path
 * @param {unknown} value
 */
function set(state, path, value) {
  const record = /** @type {Fields} */ (at(state, path.slice(0, -1)));
  record[path[path.length - 1]] = value;
}

/**
 * A hidden text that describes controls to screen readers; false where there is nothing to say.
 * @param {string} id
 * @param {string} doc
 * @param {HTMLElement[]} controls
 */
function description(id, doc, ...controls) {
  if (!doc) return false;
  for (const control of controls) control.setAttribute("aria-describedby", `${id}-about`);
  return element("span", { id: `${id}-about`, hidden: true }, doc);
}

/**
 * A slider and a number field for one value. Wide ranges of numbers from 0 up are logarithmic.
 * @param {ViewerPage} view
 * @param {Path} path
 * @param {NumberOptions} how
 */
export function number(view, path, how) {
  const { label, doc = "", low, high, whole = false, step = null, soft = false, open } = how;
  const id = path.join(".");
  const valued = () => /** @type {number} */ (at(view.state, path) ?? open?.());
  const start = valued();
  const ends = [low ?? Math.min(0, 2 * start), high ?? Math.max(4 * Math.abs(start), 2)];
  const [least, most] = soft ? [Math.min(ends[0], start), Math.max(ends[1], start)] : ends;
  const [lowest, highest] = soft ? [null, null] : [low, high];
  const wide = most > 128 && least >= 0;
  const offset = least > 0 ? least : 1;
  const span = Math.log((most - least + offset) / offset);
  /** @type {(x: number) => number} */
  const toSlider = (x) => (wide ? Math.log((x - least + offset) / offset) / span : x);
  /** @type {(x: number) => number} */
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
    name: id,
    step: whole ? "1" : "any",
    ...(lowest != null && { min: String(lowest) }),
    ...(highest != null && { max: String(highest) }),
  });
  /** @type {(x: number) => number} */
  const rounded = (x) => {
    if (whole) return Math.round(x);
    return Number(x.toPrecision(wide ? 3 : 6));
  };
  const show = () => {
    const value = valued();
    // a slider keeps its range while it is in use
    const isActive = document.activeElement === slider;
    if (!wide) {
      slider.max = String(Math.max(isActive ? Number(slider.max) : most, value));
      slider.min = String(Math.min(isActive ? Number(slider.min) : least, value));
    }
    slider.value = String(toSlider(value));
    slider.setAttribute("aria-valuetext", String(value));
    if (document.activeElement !== field) field.value = String(Number(value.toPrecision(4)));
  };
  /** @type {(value: number) => void} */
  const take = (value) => {
    if (!Number.isFinite(value)) return;
    let clamped = Math.max(lowest ?? -Infinity, Math.min(highest ?? Infinity, value));
    if (whole) clamped = Math.round(clamped);
    set(view.state, path, clamped);
    view.changed();
  };
  // on a logarithmic slider a key moves to the next different number
  slider.addEventListener("keydown", (event) => {
    const way = WAYS[event.key];
    if (!wide || !way) return;
    event.preventDefault();
    const value = valued();
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
    description(id, doc, slider, field),
  );
  show();
  return row;
}

/**
 * A menu for one choice; `options` are [value, text, whether it is available, why not].
 * @param {ViewerPage} view
 * @param {Path} path
 * @param {string} label
 * @param {Option[]} options
 * @param {(value: string) => void} after
 * @param {string} doc
 */
export function menu(view, path, label, options, after = () => {}, doc = "") {
  const id = path.join(".");
  const select = element("select", { id, name: id });
  for (const [value, text, there = true, why = ""] of options) {
    const shown = there ? text : `${text} (${why})`;
    select.append(element("option", { value, disabled: !there }, shown));
  }
  const show = () => {
    select.value = String(at(view.state, path));
  };
  // while the user types a name, the menu must not be replaced
  let wrote = -Infinity;
  select.addEventListener("keydown", (event) => {
    if (event.key.length === 1) wrote = performance.now();
    if (event.key !== "Tab" || !view.rebuilding) return;
    // the next control is one of the rebuilt panel
    event.preventDefault();
    view.rebuildNow();
    beside(document.activeElement, event.shiftKey ? -1 : 1)?.focus();
  });
  select.addEventListener("change", () => {
    set(view.state, path, select.value);
    after(select.value);
    view.changed(performance.now() - wrote > view.writing ? true : "soon");
  });
  select.addEventListener("blur", () => {
    const due = view.rebuilding;
    afterPress(() => view.rebuildNow(due));
  });
  view.shows.push(show);
  show();
  return element(
    "div",
    { class: "menu", title: doc },
    element("label", { for: id }, label),
    select,
    description(id, doc, select),
  );
}

/**
 * A checkbox for a value, which is `ticked()` if checked and `not` otherwise, and which `take` sets. It
 * needs a separate name if the value has another control.
 * @param {ViewerPage} view
 * @param {Path} path
 * @param {string} label
 * @param {{ name?: string, ticked?: () => unknown, not?: unknown, doc?: string,
 *   take?: (value: unknown) => void }} options
 */
export function check(
  view,
  path,
  label,
  { name, ticked = () => true, not = false, doc = "", take } = {},
) {
  const put = take ?? ((/** @type {unknown} */ value) => set(view.state, path, value));
  const id = name ?? path.join(".");
  const box = element("input", { type: "checkbox", id, name: id });
  const show = () => {
    box.checked = at(view.state, path) !== not;
  };
  box.addEventListener("change", () => {
    put(box.checked ? ticked() : not);
    view.changed(true);
  });
  view.shows.push(show);
  show();
  return element(
    "div",
    { class: "check", title: doc },
    box,
    element("label", { for: id }, label),
    description(id, doc, box),
  );
}

/**
 * A colour field in sRGB for a linear value, 0 to 1.
 * @param {ViewerPage} view
 * @param {Path} path
 * @param {string} label
 * @param {string} doc
 */
export function color(view, path, label, doc = "") {
  const id = path.join(".");
  const field = element("input", { type: "color", id, name: id });
  const show = () => {
    const light = /** @type {number[]} */ (at(view.state, path));
    const codes = light.map((x) => Math.round(255 * encoded(Math.min(x, 1))));
    field.value = `#${codes.map((n) => n.toString(16).padStart(2, "0")).join("")}`;
  };
  field.addEventListener("input", () => {
    const codes = [1, 3, 5].map((k) => Number.parseInt(field.value.slice(k, k + 2), 16) / 255);
    set(
      view.state,
      path,
      codes.map((x) => Number(decoded(x).toPrecision(4))),
    );
    view.changed();
  });
  view.shows.push(show);
  show();
  return element(
    "div",
    { class: "menu", title: doc },
    element("label", { for: id }, label),
    field,
    description(id, doc, field),
  );
}

/**
 * The control before or after another in the panel.
 * @param {Element | null} control
 * @param {1 | -1} way
 */
function beside(control, way) {
  const all = /** @type {NodeListOf<Control>} */ (
    document.querySelectorAll("#panel :is(summary, input, select, button)")
  );
  const seen = [...all].filter((each) => each.offsetParent !== null && !each.disabled);
  return seen[seen.indexOf(/** @type {Control} */ (control)) + way];
}

/**
 * @param {string} text
 * @param {() => void} act
 * @param {{ [name: string]: string }} attributes
 */
export function button(text, act, attributes = {}) {
  const made = element("button", { type: "button", ...attributes }, text);
  made.addEventListener("click", act);
  return made;
}

/**
 * @param {string} title
 * @param {boolean} open
 * @param {(Child | Child[])[]} rows
 */
export function section(title, open, ...rows) {
  const id = `section-${title.toLowerCase().replaceAll(" ", "-")}`;
  return element("details", { id, open }, element("summary", {}, title), ...rows);
}
