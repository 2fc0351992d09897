// The panel's section of maps: thumbnails on which pictures can be dropped.

import { button, element, section } from "view/controls.js";
import { words } from "view/text.js";
import { thumbnail } from "view/thumbs.js";

/** @import { Slot } from "view/data" */
/** @import { Option } from "view/controls.js" */
/** @import { Reading } from "view/dropped.js" */
/** @import { ViewerPage } from "view/main.js" */

/** @type {Slot[]} */
export const PACKED = ["occlusion", "roughness", "metallic"];
/** @type {{ [slot: Slot]: string }} */
const NAMES = {
  base_color: "colour",
  height: "heights",
  normal: "normals",
  metallic: "metal",
  packed: "packed (ORM)",
};

/**
 * The name of a map in the panel.
 * @param {Slot} slot
 */
export const slotName = (slot) => NAMES[slot] ?? words(slot);

/**
 * Options for reading dropped pictures; "" takes the file's name into account.
 * @type {{ [Name in keyof Reading]: [label: string, options: Option[]] }}
 */
const HOW = {
  channel: ["Channel", ["luminance", ..."rgba"].map((c) => [c, c])],
  polarity: [
    "White",
    [
      ["", "by file name"],
      ["height", "high (as stored)"],
      ["depth", "low (inverted)"],
    ],
  ],
  green: [
    "Green",
    [
      ["", "by file name"],
      ["gl", "up (OpenGL)"],
      ["dx", "down (DirectX)"],
    ],
  ],
};

/** @param {ViewerPage} view */
export function maps(view) {
  const file = element("input", {
    type: "file",
    accept: "image/*",
    id: "map-file",
    multiple: true,
  });
  // the packed map follows the last map in it
  const slots = Object.keys(view.data.slots).flatMap((slot) =>
    slot === PACKED.at(-1) ? [slot, "packed"] : [slot],
  );
  const readings = /** @type {(keyof Reading)[]} */ (Object.keys(HOW));
  file.addEventListener("change", () => {
    view.takeMaps([...(file.files ?? [])]);
    file.value = "";
  });
  return section(
    "Maps",
    false,
    element(
      "p",
      { class: "doc" },
      "Drop a picture on the map to replace. Several pictures at once are assigned by their names.",
    ),
    slots.map((slot) => row(view, slot)),
    element("div", { class: "menu" }, element("label", { for: "map-file" }, "Pictures"), file),
    element("p", { class: "doc" }, "Reading of dropped pictures:"),
    readings.map((name) => choice(view, name, ...HOW[name])),
    element("p", { class: "doc", id: "map-message" }, view.mapMessage),
  );
}

/**
 * @param {ViewerPage} view
 * @param {Slot} slot
 */
function row(view, slot) {
  const { texture } = view.data.slots[slot] ?? view.data.slots[PACKED[0]];
  const { channels, light } = view.data.slots[slot] ?? { channels: [0, 1, 2], light: false };
  const name = slotName(slot);
  const picture = view.pictures[texture];
  const source = view.sources[slot] ?? "";
  // a map without a file is a default channel of another map
  const shown =
    picture && (source || (slot === "packed" && PACKED.some((each) => view.sources[each])));
  const frame = element("span", { class: "thumb" });
  if (shown) frame.append(thumbnail(picture, channels, light));
  const size = shown ? `${picture.width} × ${picture.height}` : instead(view, slot);
  return element(
    "div",
    { class: "map", "data-slot": slot },
    frame,
    element(
      "span",
      { class: "about" },
      element("span", {}, name, " ", element("span", { class: "doc" }, size)),
      source !== "" && element("span", { class: "doc" }, source),
    ),
    element(
      "span",
      { class: "acts" },
      button("Choose …", () => choose(view, slot), {
        id: `choose-${slot}`,
        "aria-label": `Choose a picture for ${name}`,
      }),
      source !== "" &&
        button("×", () => view.removeMap(slot), {
          id: `remove-${slot}`,
          title: `Draw without ${name}`,
          "aria-label": `Draw without ${name}`,
        }),
    ),
  );
}

/**
 * @param {ViewerPage} view
 * @param {Slot} slot
 */
function instead(view, slot) {
  if (slot === "normal" && view.hasHeights) return "from the heights";
  if (slot === "dust" && view.pictures.dust) return "sample:dust";
  return slot === "packed" ? "occlusion, roughness, metal in R, G, B" : "none";
}

/**
 * @param {ViewerPage} view
 * @param {Slot} slot
 */
function choose(view, slot) {
  const file = element("input", { type: "file", accept: "image/*" });
  file.addEventListener("change", () => view.takeMaps([...(file.files ?? [])], slot));
  file.click();
}

/**
 * @param {ViewerPage} view
 * @param {keyof Reading} name
 * @param {string} label
 * @param {Option[]} options
 */
function choice(view, name, label, options) {
  const id = `map-${name}`;
  const select = element("select", { id, name: id });
  for (const [value, text] of options) select.append(element("option", { value }, text));
  select.value = view.drop[name];
  select.addEventListener("change", () => {
    view.drop[name] = select.value;
  });
  return element("div", { class: "menu" }, element("label", { for: id }, label), select);
}
