// The page: reads what it was made with, and puts the panel, the picture and a person together.

import { across, framing, framingHeight } from "view/camera.js";
import { copyOf, held, merged } from "view/checks.js";
import { afterPress, byId } from "view/controls.js";
import { Drawing } from "view/drawing.js";
import { pictureOf, replaced, varies, without } from "view/dropped.js";
import { Gpu } from "view/gpu.js";
import { Host } from "view/host.js";
import { listen } from "view/input.js";
import { PACKED, slotName } from "view/mappanel.js";
import { bytesOf, inflated, unpacked } from "view/maps.js";
import { meaningOf } from "view/names.js";
import { build } from "view/panel.js";
import { difference, fromHash, laidOver, toCommand, toHash, toPython } from "view/state.js";
import { firstLine, words } from "view/text.js";

/** @import { Data, Pair, Slot } from "view/data" */
/** @import { Figures } from "view/colors.js" */
/** @import { News } from "view/drawing.js" */
/** @import { FilePicture, Pictures, Reading } from "view/dropped.js" */
/** @import { State } from "view/state.js" */

/** @typedef {"python" | "command" | "link"} CopyKind */

/** @type {(id: string) => string} */
const textOf = (id) => byId(id).textContent ?? "";
const MOST_PIXELS = 1920 * 1200;
const MESSAGES = 8; // that are shown at once
const READ = 8000; // milliseconds for which a message that is only told stays
const AS_NAMED = { channel: "luminance", polarity: "", green: "" };
const FURTHEST = 20; // widths of a shape that zooming goes away

/**
 * Degrees as −180 to 180.
 * @type {(degrees: number) => number}
 */
const wrapped = (degrees) => degrees - 360 * Math.floor((degrees + 180) / 360);

export async function start() {
  const view = new View();
  window.viewer = view;
  view.ready = view.open();
  await view.ready;
}

export class View {
  // set by `open`
  /** @type {Data} */
  data;
  /** @type {State} */
  start;
  /** @type {State} */
  state;
  /** @type {boolean} */
  hasHeights;
  /** @type {Data["mapSources"]} */
  sources; // file names of the maps
  /** @type {Gpu} */
  gpu;
  /** @type {Pictures} */
  began; // as in the page
  /** @type {Pictures} */
  pictures;
  /** @type {Drawing} */
  drawing;
  /** @type {Promise<void>} */
  ready;

  constructor() {
    /** @type {(() => void)[]} */
    this.shows = [];
    /** @type {Reading} */
    this.drop = { ...AS_NAMED }; // how dropped pictures are read
    this.mapSaid = "";
    this.hashesRead = 0;
    this.canvas = /** @type {HTMLCanvasElement} */ (byId("canvas"));
    /** @type {Pair | null} */
    this.heldSize = null;
    /** @type {Promise<void>} */
    this.mapping = Promise.resolve(); // maps are changed one after another
    /** @type {News["drawn"] | null} */
    this.drawn = null; // what is on the canvas, where that is known
    /** @type {News} */
    this.news = {}; // the latest of each
    /** @type {Promise<void> | undefined} */
    this.reopening = undefined;
    this.writing = 800; // milliseconds between the letters of a name
    /** @type {number | null} */
    this.rebuilding = null;
    /** @type {number | undefined} */
    this.linking = undefined;
    this.host = Host.around(this);
  }

  async open() {
    try {
      const text = new TextDecoder().decode(await inflated(bytesOf(textOf("data"))));
      this.data = JSON.parse(text);
      this.start = { ...this.data.state, compare: "", divider: 0.5, show: "color", preset: "" };
      this.state = copyOf(this.start);
      this.hasHeights = this.data.hasHeights;
      this.sources = { ...this.data.mapSources };
    } catch (error) {
      this.say(`This page cannot be read: ${firstLine(error)}`);
      return;
    }
    this.readHash();
    try {
      this.gpu = await Gpu.open();
    } catch (error) {
      byId("without").append(` (${firstLine(error)})`);
      document.body.classList.add("without");
      return;
    }
    this.watch(this.gpu);
    document.body.classList.add("with");
    byId("panel").hidden = false;
    if (this.data.scaledTo) {
      this.say(
        `Maps are scaled to ${this.data.scaledTo.join(" × ")} so that the page stays small.`,
        true,
      );
    }
    try {
      await this.loadMaps();
    } catch (error) {
      this.say(firstLine(error));
      return;
    }
    this.rebuild();
    listen(this);
    this.fit();
    this.host?.open();
    await this.drawing.show(copyOf(this.state));
  }

  // A drawing of the maps that there are, on the device that there is by then.
  async loadMaps() {
    this.began ??= await this.packedMaps();
    this.pictures ??= this.began;
    let made;
    do {
      await this.reopening;
      made = new Drawing(this.gpu, this.data, this.canvas, (news) => this.hear(news));
      try {
        await made.setMaps(this.pictures);
        await made.frames.pace.measureLatency(this.gpu.device.queue);
      } catch (error) {
        if (!made.gpu.lost) throw error;
      }
    } while (made.gpu.lost);
    this.drawing = made;
  }

  /**
   * Other maps, made of those that there are then; rejects where they cannot be taken.
   * @param {(pictures: Pictures) => Pictures} change
   */
  changeMaps(change) {
    const changed = this.mapping.then(async () => {
      const pictures = change(this.pictures);
      await this.drawing.setMaps(pictures);
      this.pictures = pictures;
    });
    this.mapping = changed.catch(() => {});
    return changed;
  }

  async packedMaps() {
    /** @type {Pictures} */
    const found = {};
    for (const [name, told] of Object.entries(this.data.maps)) {
      found[name] = await unpacked(told, textOf(`map-${name}`));
    }
    return found;
  }

  /**
   * A lost device is opened anew; what goes wrong within one is told.
   * @param {Gpu} gpu
   */
  watch(gpu) {
    gpu.device.addEventListener("uncapturederror", ({ error }) => this.say(firstLine(error)));
    gpu.device.lost.then(async ({ reason, message }) => {
      if (this.gpu !== gpu) return;
      gpu.lost = true;
      this.reopening = this.reopen();
      this.say(
        `The graphics device was lost (${firstLine(message || reason)}); starting it again.`,
      );
      const { drawing } = this;
      // a page that still opens waits for the device itself
      if (!drawing) return;
      drawing.held = true;
      try {
        await this.reopening;
        this.mapping = this.mapping.then(() => this.loadMaps());
        await this.mapping;
        await this.drawing.show(copyOf(this.state));
      } catch (error) {
        this.say(`It cannot be started again: ${firstLine(error)}. Load the page anew.`);
      }
    });
  }

  async reopen() {
    this.gpu = await Gpu.open();
    this.watch(this.gpu);
  }

  // --- the state

  readHash() {
    try {
      this.state = fromHash(location.hash, this.start, this.data);
      this.holdCamera();
    } catch {
      this.say("The link's settings cannot be read; the page starts with its own.");
    }
  }

  /**
   * `choice`: what can be set is another now, so the panel is made anew; "soon" when nobody writes
   * in it any more.
   * @param {boolean | "soon"} choice
   */
  changed(choice = false) {
    held(this.state, this.start, this.data);
    this.holdCamera();
    this.unname();
    if (choice === true) this.rebuild();
    else for (const show of this.shows) show();
    if (choice === "soon") {
      clearTimeout(this.rebuilding ?? undefined);
      const due = setTimeout(() => afterPress(() => this.rebuildNow(due)), this.writing);
      this.rebuilding = due;
    }
    this.link();
    this.drawn = null;
    this.updateDivider();
    this.host?.tell();
    this.drawing.show(copyOf(this.state));
  }

  // The address holds the settings, where the page has one of its own.
  link() {
    if (this.host) return;
    clearTimeout(this.linking);
    this.linking = setTimeout(() => {
      history.replaceState(
        null,
        "",
        toHash(this.state, this.start) || location.pathname + location.search,
      );
    }, 300);
  }

  /**
   * Settings that come from outside, laid over those that there are.
   * @param {unknown} told
   */
  take(told) {
    const before = this.state;
    this.state = laidOver(before, told, this.data);
    this.holdCamera();
    const changed = /** @type {object | undefined} */ (difference(this.state, before));
    if (!changed) {
      this.host?.tell();
      return;
    }
    const choices = [
      ...Object.keys(this.data.menus),
      "compare",
      "show",
      "lights",
      "fades",
      "apart",
      "layer",
    ];
    /** @type {(state: State) => boolean} */
    const lens = ({ camera }) => camera.orthographic_height === null;
    this.changed(choices.some((name) => name in changed) || lens(this.state) !== lens(before));
  }

  rebuild() {
    clearTimeout(this.rebuilding ?? undefined);
    this.rebuilding = null;
    build(this, /** @type {HTMLFormElement} */ (byId("panel")));
    this.updateDivider();
  }

  // What was to be soon, unless it has been put off since.
  rebuildNow(due = this.rebuilding) {
    if (due && due === this.rebuilding) this.rebuild();
  }

  addLight() {
    this.state.lights.push(copyOf(this.state.lights.at(-1) ?? this.data.defaults.lights[0]));
    this.changed(true);
  }

  /** @param {number} k */
  removeLight(k) {
    this.state.lights.splice(k, 1);
    this.changed(true);
  }

  /** @param {string} name */
  preset(name) {
    const found = this.data.presets[name]?.state;
    if (!found) return;
    const { camera, shape } = this.state;
    const { compare, divider, show } = this.state;
    const kept = { camera, shape, compare, divider, show };
    this.state = { ...merged(this.start, found, this.data), preset: name, ...kept };
    if (shape !== found.shape) this.state.tiling = copyOf(this.data.shapes[shape].tiling);
  }

  // A preset that somebody has turned something of is not that preset any more.
  unname() {
    const { preset, camera, shape, tiling, compare, divider, show, ...rest } = this.state;
    const found = this.data.presets[preset]?.state;
    if (found && difference(rest, found)) this.state.preset = "";
  }

  /** @param {string} shape */
  reshaped(shape) {
    this.state.tiling = copyOf(this.data.shapes[shape].tiling);
    this.reframe();
  }

  frame() {
    this.reframe();
    this.changed();
  }

  // Let the camera show the whole shape.
  reframe() {
    const { camera, shape } = this.state;
    Object.assign(camera, { distance: null, target: [0, 0, 0] });
    if (camera.orthographic_height === null) return;
    const { shapes, filled } = this.data;
    camera.orthographic_height = framingHeight(camera, shapes[shape].outline, this.size(), filled);
  }

  // Settings and maps as the page began with.
  async reset() {
    this.state = copyOf(this.start);
    this.drop = { ...AS_NAMED };
    this.changed(true);
    let others = false;
    try {
      await this.changeMaps((held) => {
        others = held !== this.began;
        return this.began;
      });
      if (!others) return;
      this.hasHeights = this.data.hasHeights;
      this.sources = { ...this.data.mapSources };
      this.mapSaid = "";
      this.changed(true);
    } catch (error) {
      this.say(firstLine(error));
    }
  }

  // --- the camera

  /** @returns {Pair} */
  size() {
    return [this.canvas.width, this.canvas.height];
  }

  // With the distance that it frames from, where none is said.
  wholeCamera() {
    return this.drawing.camera(this.state, this.size());
  }

  // The height of the picture, where the target is.
  heightSeen() {
    const { orthographic_height, field_of_view, distance } = this.wholeCamera();
    return orthographic_height ?? 2 * Math.tan((field_of_view * Math.PI) / 360) * distance;
  }

  /**
   * @param {number} azimuth
   * @param {number} elevation
   */
  turn(azimuth, elevation) {
    const { camera } = this.state;
    camera.azimuth = wrapped(camera.azimuth + azimuth);
    camera.elevation += elevation;
    this.changed();
  }

  /**
   * Turn the first light that comes from a direction.
   * @param {number} azimuth
   * @param {number} elevation
   */
  turnLight(azimuth, elevation) {
    const light = this.state.lights.find(({ kind }) =>
      this.data.lightKinds[kind].includes("azimuth"),
    );
    if (!light) return;
    light.azimuth = wrapped(light.azimuth + azimuth);
    light.elevation = Math.max(-90, Math.min(90, light.elevation + elevation));
    this.changed();
  }

  /** @param {number} factor */
  zoom(factor) {
    const { camera } = this.state;
    const { distance } = this.wholeCamera();
    camera.distance = Math.min(Math.max(FURTHEST, distance), distance * factor);
    if (camera.orthographic_height !== null) camera.orthographic_height *= factor;
    this.changed();
  }

  /**
   * Move the target by pixels of the picture as it is shown.
   * @param {number} x
   * @param {number} y
   */
  pan(x, y) {
    const { camera } = this.state;
    const whole = this.wholeCamera();
    const pixel = this.heightSeen() / this.canvas.clientHeight;
    const { right, up } = across(whole, this.size());
    camera.distance = whole.distance;
    camera.target = camera.target.map((t, k) => t + (up[k] * y - right[k] * x) * pixel);
    this.changed();
  }

  // Never behind a flat shape, nor within a shape.
  holdCamera() {
    const { camera, shape } = this.state;
    const { flat, radius, outline } = this.data.shapes[shape];
    const least = flat ? 2 : -89;
    camera.elevation = Math.max(least, Math.min(89, camera.elevation));
    if (flat) camera.target[1] = Math.max(0, camera.target[1]);
    if (camera.distance !== null) {
      const away = Math.hypot(...camera.target);
      camera.distance = Math.max(camera.distance, flat ? 0.15 : radius + away + 0.05);
      // an orthographic one sees nothing that is behind it
      if (camera.orthographic_height !== null) {
        const all = framing(camera, outline, [1, 1], 1) - 1;
        camera.distance = Math.max(camera.distance, all + 0.05);
      }
    }
  }

  // --- maps

  /**
   * Pictures as the map of a slot, or each as what its name says: those dropped together are a
   * material's. What is wrong with one is told, and the others are taken.
   * @param {File[]} files
   * @param {Slot | ""} slot
   */
  async takeMaps(files, slot = "") {
    const said = [];
    for (const file of files) {
      try {
        said.push(await this.takeMap(file, slot));
      } catch (error) {
        this.say(`${file.name}: ${firstLine(error)}`);
      }
    }
    if (!said.length) return;
    this.mapSaid = said.join("; ");
    this.changed(true);
  }

  /**
   * @param {File} file
   * @param {Slot | ""} wanted
   */
  async takeMap(file, wanted) {
    const { slot, ...how } = this.meant(file, wanted);
    const picture = await pictureOf(file, this.gpu.limits.maxTextureDimension2D);
    await this.changeMaps((held) =>
      this.withoutBakes(replaced(held, this.data.slots, slot, picture, how), slot),
    );
    for (const each of slot === "packed" ? PACKED : [slot]) this.sources[each] = file.name;
    // what has opacity of its own brings that too
    if (slot === "base_color" && varies(picture, 3)) this.sources.opacity = file.name;
    if (slot === "height" && !this.hasHeights) {
      this.hasHeights = true;
      if (this.state.technique === "flat") this.useTechnique("relief");
    }
    return this.tellMap(file.name, slot, picture, how);
  }

  /** @param {string} technique */
  useTechnique(technique) {
    const { reference_height, projection } = this.data.techniques[technique];
    Object.assign(this.state, { technique, reference_height, projection });
  }

  /**
   * What a file is to be used as, and how: by the panel, or else by its name.
   * @param {File} file
   * @param {Slot | ""} wanted
   * @returns {Reading & { slot: Slot }}
   */
  meant({ name }, wanted) {
    const found = meaningOf(name, this.data.names);
    const slot = wanted || found?.slot;
    if (!slot) {
      throw new Error(
        "its name says no map that the page takes; under “Maps”, drop it on the one that it is to be",
      );
    }
    // a name of another map says nothing of this one
    const said = found?.slot === slot ? found : { polarity: "height", green: "gl" };
    const { channel, polarity, green } = this.drop;
    return {
      slot,
      channel,
      polarity: polarity || said.polarity,
      green: green || said.green,
    };
  }

  /**
   * Draw without a map.
   * @param {Slot} slot
   */
  async leaveMap(slot) {
    try {
      await this.changeMaps((held) =>
        this.withoutBakes(without(held, this.data.slots, slot), slot),
      );
    } catch (error) {
      this.say(firstLine(error));
      return;
    }
    delete this.sources[slot];
    if (slot === "height") {
      this.hasHeights = false;
      Object.assign(this.state, { technique: "flat", compare: "" });
      if (this.state.show === "missed") this.state.show = "color";
    }
    this.mapSaid = `Drawn without ${slotName(slot)}.`;
    this.changed(true);
  }

  /**
   * What the page has baked is of its own heights.
   * @param {Pictures} pictures
   * @param {Slot} slot
   */
  withoutBakes(pictures, slot) {
    const left = { ...pictures };
    if (slot !== "height") return left;
    for (const { bake } of Object.values(this.data.techniques)) if (bake) delete left[bake];
    return left;
  }

  /**
   * @param {string} name
   * @param {Slot} slot
   * @param {FilePicture} picture
   * @param {Reading} how
   */
  tellMap(name, slot, { width, height, bits, lost }, { polarity, green }) {
    if (lost) this.say(`${name} is interlaced: 8 of its 16 bits a channel are read.`, true);
    if (slot === "height" && this.pictures.normal) {
      this.say(
        "The normals are still those of the normal map; without it they are made of the heights.",
        true,
      );
    }
    const { proportion } = this.data.constants;
    const apart = Math.abs(width / height / proportion - 1);
    if (width * height > 1 && apart > 0.02) {
      this.say(`${name} has other proportions than the page's material, and is stretched.`, true);
    }
    const over = (slot === "normal" ? green === "dx" : polarity === "depth") ? ", turned over" : "";
    return `${name}: ${width} × ${height} with ${bits} bits a channel, used as ${slotName(slot)}${over}`;
  }

  // --- the picture

  /** @param {number} share */
  divide(share) {
    this.state.divider = Math.max(0, Math.min(1, share));
    if (this.drawing.state) this.drawing.state.divider = this.state.divider;
    this.updateDivider();
    this.link();
    this.host?.tell();
    this.drawing.frames.present();
  }

  updateDivider() {
    const { divider } = this.state;
    const { technique, compare } = this.drawn ?? this.state;
    byId("line").hidden = !compare;
    byId("divider-row").hidden = !compare;
    /** @type {HTMLInputElement} */ (byId("divider")).value = String(divider);
    byId("line").style.left = `${divider * 100}%`;
    byId("line-left").textContent = words(technique);
    byId("line-right").textContent = words(compare);
  }

  // The canvas gets as many pixels as it is shown with.
  fit() {
    if (this.heldSize) return;
    const { clientWidth, clientHeight } = byId("picture");
    const fine = Math.min(
      devicePixelRatio,
      Math.sqrt(MOST_PIXELS / Math.max(1, clientWidth * clientHeight)),
    );
    this.resize(
      Math.max(16, Math.round(clientWidth * fine)),
      Math.max(16, Math.round(clientHeight * fine)),
    );
  }

  /**
   * @param {number} width
   * @param {number} height
   */
  resize(width, height) {
    if (this.canvas.width === width && this.canvas.height === height) return;
    this.canvas.width = width;
    this.canvas.height = height;
    // a distance that frames is another now
    for (const show of this.shows) show();
    this.drawing.frames.touched();
  }

  /**
   * Draw at a size and so many samples, whatever the page's: for pictures that are compared.
   * @param {number} width
   * @param {number} height
   * @param {number} samples
   */
  async draw(width, height, samples) {
    await this.mapping;
    this.heldSize = [width, height];
    this.drawing.frames.limit = samples;
    this.resize(width, height);
    await this.drawing.show(copyOf(this.state));
    await this.drawing.settled();
  }

  async save() {
    this.drawing.frames.present();
    /** @type {Blob | null} */
    const blob = await new Promise((resolve) => this.canvas.toBlob(resolve, "image/png"));
    if (!blob) {
      this.say(
        "The browser makes no picture of the canvas; make the window smaller and try again.",
      );
      return;
    }
    const link = document.createElement("a");
    link.href = URL.createObjectURL(blob);
    link.download = `${this.data.name}-${this.state.technique}.png`;
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 1000);
  }

  /** @param {CopyKind} kind */
  text(kind) {
    if (kind === "python") return toPython(this.state, this.data);
    if (kind === "command") return toCommand(this.state, this.data);
    if (kind !== "link") throw new Error(`nothing is copied as ${kind}`);
    return location.href.split("#")[0] + toHash(this.state, this.start);
  }

  /** @param {CopyKind} kind */
  async copy(kind) {
    const text = this.text(kind);
    const without =
      this.pictures === this.began ? "" : " The maps that were changed are not in it.";
    byId("copied").textContent = text + (without && `\n${without.trim()}`);
    try {
      await navigator.clipboard.writeText(text);
      this.say(
        `Copied as ${{ python: "Python", command: "a command", link: "a link" }[kind]}.${without}`,
        true,
      );
    } catch {
      this.say(`The browser does not let the page copy: take it from the panel.${without}`, true);
    }
  }

  // --- what is said

  /** @param {News} news */
  hear(news) {
    if (news.error) this.say(news.error);
    if (news.busy !== undefined) byId("busy").textContent = news.busy;
    this.news = { ...this.news, ...news };
    if (news.drawn) {
      this.drawn = news.drawn;
      this.updateDivider();
    }
    const { milliseconds, gpuMilliseconds, timedAt, size, samples, figures } = this.news;
    /** @type {(f: Figures) => string} */
    const reads = (f) => (f.hits ? (f.reads / f.hits).toFixed(1) : "0");
    const parts = [];
    // what has failed is not what is seen and measured
    const { drawn } = this;
    const other = drawn && drawn.technique !== this.state.technique;
    if (other) parts.push(`${words(drawn.technique)} is still shown`);
    if (figures) {
      const { left, right, missed } = figures;
      parts.push(`${reads(left)}${right ? ` | ${reads(right)}` : ""} reads a pixel`);
      /** @type {(f: Figures) => string} */
      const share = (f) => ((100 * f.missed) / f.hits).toFixed(2);
      if (missed && left.hits) {
        parts.push(`missed ${share(left)}${right?.hits ? ` | ${share(right)}` : ""} %`);
      }
    }
    if (milliseconds !== undefined && timedAt) {
      const clock = gpuMilliseconds == null ? "" : ` (programs ${gpuMilliseconds.toFixed(1)})`;
      parts.push(`${milliseconds.toFixed(1)} ms${clock}`, timedAt.join(" × "));
    }
    // the end is cut off where there is no room
    if (size) parts.push(`${samples} of ${this.drawing.frames.limit} samples`);
    byId("figures").textContent = byId("figures").title = parts.join(" · ");
  }

  /**
   * @param {string} message
   * @param {boolean} quiet
   */
  say(message, quiet = false) {
    const line = document.createElement("p");
    line.textContent = message;
    if (quiet) line.className = "quiet";
    const close = document.createElement("button");
    close.type = "button";
    close.textContent = "×";
    close.setAttribute("aria-label", "Close this message");
    close.addEventListener("click", () => line.remove());
    line.append(close);
    const box = byId("messages");
    // what is only told makes room for what went wrong
    while (box.children.length >= MESSAGES) {
      (box.querySelector(".quiet") ?? box.firstElementChild)?.remove();
    }
    box.append(line);
    line.scrollIntoView({ block: "nearest" });
    // what is only told goes by itself; what went wrong stays until it is read
    if (quiet) setTimeout(() => line.remove(), READ);
  }
}
