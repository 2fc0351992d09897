// Native controls, each labelled, of one value in the state.

import { decoded, encoded } from "view/srgb.js";

const WRITING = 800; // milliseconds between the letters of a name
let pressed = false;

// Do something once no button is held: what was pressed must be there still when it is let go.
export function afterPress(act) {
  setTimeout(() => {
    if (!pressed) act();
    else addEventListener("pointerup", () => setTimeout(act), { once: true });
  });
}
for (const [name, now] of [
  ["pointerdown", true],
  ["pointerup", false],
  ["pointercancel", false],
]) {
  addEventListener(
    name,
    () => {
      pressed = now;
    },
    true,
  );
}

export function element(name, attributes = {}, ...children) {
  const made = document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) {
    if (key in made && typeof value !== "string") made[key] = value;
    else made.setAttribute(key, value);
  }
  made.append(...children);
  return made;
}

// Where a value lies in the state: ["settings", "relief", "max_steps"], ["tiling", 0].
const at = (state, path) => path.reduce((value, key) => value[key], state);
function set(state, path, value) {
  at(state, path.slice(0, -1))[path.at(-1)] = value;
}

// A slider and a number for one value. Wide ranges of numbers above 0 go by powers. Where `soft` the
// range is that of the slider alone, and grows to hold what the value is. `open` says what a value is
// that is left to the page: null in the state.
export function number(view, path, how) {
  const { label, doc = "", low, high, whole = false, step = null, soft = false, open } = how;
  const id = path.join(".");
  const valued = () => at(view.state, path) ?? open();
  const start = valued();
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
    name: id,
    step: whole ? "1" : "any",
    ...(lowest != null && { min: String(lowest) }),
    ...(highest != null && { max: String(highest) }),
  });
  const rounded = (x) => {
    if (whole) return Math.round(x);
    return Number(x.toPrecision(wide ? 3 : 6));
  };
  const show = () => {
    const value = valued();
    // who holds it keeps the range that it has
    const held = document.activeElement === slider;
    if (!wide) {
      slider.max = String(Math.max(held ? slider.max : most, value));
      slider.min = String(Math.min(held ? slider.min : least, value));
    }
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
  );
  show();
  return row;
}

// A menu for one choice; `options` are [value, text, whether it can be had, why not].
export function menu(view, path, label, options, after = () => {}) {
  const id = path.join(".");
  const select = element("select", { id, name: id });
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
  select.addEventListener("blur", () => afterPress(() => view.rebuildNow()));
  view.shows.push(show);
  show();
  return element("div", { class: "menu" }, element("label", { for: id }, label), select);
}

// A box to tick for a value, which is what `ticked` says then, and `not` otherwise. It needs a name of
// its own where the value has another control, too.
export function check(view, path, label, { name, ticked = () => true, not = false } = {}) {
  const id = name ?? path.join(".");
  const box = element("input", { type: "checkbox", id, name: id });
  const show = () => {
    box.checked = at(view.state, path) !== not;
  };
  box.addEventListener("change", () => {
    set(view.state, path, box.checked ? ticked() : not);
    view.changed(true);
  });
  view.shows.push(show);
  show();
  return element("div", { class: "check" }, box, element("label", { for: id }, label));
}

// A colour, chosen as it is seen and held as light: linear, 0 to 1.
export function color(view, path, label, doc = "") {
  const id = path.join(".");
  const field = element("input", { type: "color", id, name: id });
  const show = () => {
    const codes = at(view.state, path).map((x) => Math.round(255 * encoded(Math.min(x, 1))));
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

export function section(title, open, ...rows) {
  const made = element("details", {}, element("summary", {}, title), ...rows);
  made.open = open;
  made.id = `section-${title.toLowerCase().replaceAll(" ", "-")}`;
  return made;
}
