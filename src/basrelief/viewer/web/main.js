// The page: reads its data and connects the panel, the picture and the user.

import { across, framing, framingHeight } from "view/camera.js";
import { copyOf, merged, validated } from "view/checks.js";
import { afterPress, byId } from "view/controls.js";
import { Drawing } from "view/drawing.js";
import { pictureOf, replaced, varies, without } from "view/dropped.js";
import { Gpu } from "view/gpu.js";
import { Host } from "view/host.js";
import { listen } from "view/input.js";
import { PACKED, slotName } from "view/mappanel.js";
import { bytesOf, inflated, unpacked } from "view/maps.js";
import { meaningOf } from "view/names.js";
import { OPENING } from "view/opened.js";
import { build } from "view/panel.js";
import { Scroll } from "view/scroll.js";
import { difference, fromHash, toCommand, toHash, toPython, withChanges } from "view/state.js";
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
const MESSAGES = 8; // shown at once
const READ = 8000; // milliseconds for which a notice stays
const AS_NAMED = { channel: "luminance", polarity: "", green: "" };
const FURTHEST = 20; // largest distance of zooming, in widths of a shape

/**
 * Degrees as −180 to 180.
 * @type {(degrees: number) => number}
 */
const wrapped = (degrees) => degrees - 360 * Math.floor((degrees + 180) / 360);

export async function start() {
  const view = new ViewerPage();
  window.viewer = view;
  view.ready = view.open();
  await view.ready;
}

export class ViewerPage {
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
  original; // the page's own maps
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
    this.drop = { ...AS_NAMED }; // options for reading dropped pictures
    this.mapMessage = "";
    /** @type {number | undefined} */
    this.wholeScale = undefined; // before a hole was opened
    this.hashesRead = 0;
    this.canvas = /** @type {HTMLCanvasElement} */ (byId("canvas"));
    /** @type {Pair | null} */
    this.fixedSize = null;
    /** @type {Promise<void>} */
    this.mapping = Promise.resolve(); // maps are changed one after another
    /** @type {News["drawn"] | null} */
    this.drawn = null; // what is on the canvas, if known
    /** @type {News} */
    this.news = {}; // the latest value of each property
    /** @type {Promise<void> | undefined} */
    this.reopening = undefined;
    this.writing = 800; // milliseconds after which a typed name is complete
    /** @type {number | null} */
    this.rebuilding = null;
    /** @type {number | undefined} */
    this.linking = undefined;
    this.host = Host.around(this);
    this.scroll = new Scroll(this);
  }

  async open() {
    try {
      const text = new TextDecoder().decode(await inflated(bytesOf(textOf("data"))));
      this.data = JSON.parse(text);
      this.start = {
        ...this.data.state,
        compare: "",
        divider: 0.5,
        show: "color",
        preset: "",
        scroll: [0, 0],
      };
      this.state = copyOf(this.start);
      this.hasHeights = this.data.hasHeights;
      this.sources = { ...this.data.mapSources };
    } catch (error) {
      this.showMessage(`This page cannot be read: ${firstLine(error)}`);
      return;
    }
    this.readHash();
    try {
      this.gpu = await Gpu.open(this.data.programs);
    } catch (error) {
      byId("without").append(` (${firstLine(error)})`);
      document.body.classList.add("without");
      return;
    }
    this.watch(this.gpu);
    document.body.classList.add("with");
    byId("panel").hidden = false;
    if (this.data.scaledTo) {
      this.showMessage(
        `Maps are scaled to ${this.data.scaledTo.join(" × ")} so that the page stays small.`,
        true,
      );
    }
    try {
      await this.loadMaps();
    } catch (error) {
      this.showMessage(firstLine(error));
      return;
    }
    this.rebuild();
    listen(this);
    this.fit();
    this.host?.open();
    await this.drawing.show(copyOf(this.state));
    this.scroll.wake();
  }

  // Make a drawing of the current maps on the current device.
  async loadMaps() {
    this.original ??= await this.packedMaps();
    this.pictures ??= this.original;
    let drawing;
    do {
      await this.reopening;
      drawing = new Drawing(this.gpu, this.data, this.canvas, (news) => this.report(news));
      drawing.opening = this.state.opening;
      try {
        await drawing.setMaps(this.pictures);
        await drawing.frames.pace.measureLatency(this.gpu.device.queue);
      } catch (error) {
        if (!drawing.gpu.lost) throw error;
      }
    } while (drawing.gpu.lost);
    this.drawing = drawing;
  }

  /**
   * Replace the maps, after earlier changes; rejects where the drawing refuses them.
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
    for (const [name, map] of Object.entries(this.data.maps)) {
      found[name] = await unpacked(map, textOf(`map-${name}`));
    }
    return found;
  }

  /**
   * Reopen a lost device, and report errors of a device.
   * @param {Gpu} gpu
   */
  watch(gpu) {
    gpu.device.addEventListener("uncapturederror", ({ error }) =>
      this.showMessage(firstLine(error)),
    );
    gpu.device.lost.then(async ({ reason, message }) => {
      if (this.gpu !== gpu) return;
      gpu.lost = true;
      this.reopening = this.reopen();
      this.showMessage(
        `The graphics device was lost (${firstLine(message || reason)}); restarting it.`,
      );
      const { drawing } = this;
      // while the page opens, it waits for the device by itself
      if (!drawing) return;
      drawing.paused = true;
      try {
        await this.reopening;
        this.mapping = this.mapping.then(() => this.loadMaps());
        await this.mapping;
        await this.drawing.show(copyOf(this.state));
      } catch (error) {
        this.showMessage(`The device cannot be restarted (${firstLine(error)}); reload the page.`);
      }
    });
  }

  async reopen() {
    this.gpu = await Gpu.open(this.data.programs);
    this.watch(this.gpu);
  }

  // --- the state

  readHash() {
    try {
      this.state = fromHash(location.hash, this.start, this.data);
      // nothing moves by itself for those who ask for that
      if (matchMedia("(prefers-reduced-motion: reduce)").matches) this.state.scroll = [0, 0];
      this.clampCamera();
    } catch {
      this.showMessage("The link's settings cannot be read; the page uses its own.");
    }
  }

  /**
   * Update the page after a change. With `choice` the panel is rebuilt, as the available settings
   * differ; "soon" waits until the user has finished typing in it.
   * @param {boolean | "soon"} choice
   */
  changed(choice = false) {
    validated(this.state, this.start, this.data);
    if (!this.hasHeights || !this.pictures.dust) this.setOpening(null);
    this.clampCamera();
    this.clearPreset();
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
    this.host?.notify();
    this.drawing.show(copyOf(this.state));
    this.scroll.wake();
  }

  // Store the settings in the address, unless the page is embedded.
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
   * Apply settings from outside the page.
   * @param {unknown} changes
   */
  apply(changes) {
    const before = this.state;
    this.state = withChanges(before, changes, this.data);
    this.clampCamera();
    const changedFields = /** @type {object | undefined} */ (difference(this.state, before));
    if (!changedFields) {
      this.host?.notify();
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
    this.changed(
      choices.some((name) => name in changedFields) || lens(this.state) !== lens(before),
    );
  }

  rebuild() {
    clearTimeout(this.rebuilding ?? undefined);
    this.rebuilding = null;
    build(this, /** @type {HTMLFormElement} */ (byId("panel")));
    this.updateDivider();
  }

  // Rebuild the panel now, if the delayed rebuild is still due.
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

  /**
   * Open a hole, or close it with null. A scale that is the default becomes that of a hole, and the
   * scale of a hole that before it.
   * @param {number | null} opening
   */
  setOpening(opening) {
    const { state } = this;
    const { options, hole_scale } = this.data.defaults;
    const usual = Number(options.scale);
    if (opening !== null && state.opening === null) {
      this.wholeScale = state.scale;
      if (state.scale === usual) state.scale = hole_scale;
    }
    if (opening === null && state.opening !== null && state.scale === hole_scale) {
      state.scale = this.wholeScale ?? usual;
    }
    state.opening = opening;
  }

  /** @param {string} name */
  preset(name) {
    const found = this.presetState(name);
    if (!found) return;
    const { camera, shape, opening } = this.state;
    const { compare, divider, show, scroll } = this.state;
    const unchanged = { camera, shape, opening, compare, divider, show, scroll };
    this.state = { ...merged(this.start, found, this.data), preset: name, ...unchanged };
    if (shape !== found.shape) this.state.tiling = copyOf(this.data.shapes[shape].tiling);
  }

  /**
   * The state of a preset on the present shape; undefined where the page cannot draw it.
   * @param {string} name
   */
  presetState(name) {
    const { state, shapes } = this.data.presets[name] ?? {};
    return state && merged(state, shapes?.[this.state.shape], this.data);
  }

  // Clear the preset's name once its settings have changed.
  clearPreset() {
    const { preset, camera, shape, tiling, opening, ...others } = this.state;
    const { compare, divider, show, scroll, ...rest } = others;
    const found = this.presetState(preset);
    if (found && difference(rest, found)) this.state.preset = "";
  }

  /** @param {string} shape */
  reshaped(shape) {
    this.state.tiling = copyOf(this.data.shapes[shape].tiling);
    // its lengths may be those of the shape
    this.preset(this.state.preset);
    this.reframe();
  }

  frame() {
    this.reframe();
    this.changed();
  }

  // Frame the whole shape.
  reframe() {
    const { camera, shape } = this.state;
    Object.assign(camera, { distance: null, target: [0, 0, 0] });
    if (camera.orthographic_height === null) return;
    const { shapes, filled } = this.data;
    camera.orthographic_height = framingHeight(camera, shapes[shape].outline, this.size(), filled);
  }

  // Restore the page's own settings and maps.
  async reset() {
    this.state = copyOf(this.start);
    this.drop = { ...AS_NAMED };
    this.changed(true);
    let others = false;
    try {
      await this.changeMaps((pictures) => {
        others = pictures !== this.original;
        return this.original;
      });
      if (!others) return;
      this.hasHeights = this.data.hasHeights;
      this.sources = { ...this.data.mapSources };
      this.mapMessage = "";
      this.changed(true);
    } catch (error) {
      this.showMessage(firstLine(error));
    }
  }

  // --- the camera

  /** @returns {Pair} */
  size() {
    return [this.canvas.width, this.canvas.height];
  }

  // The camera with the framing distance, where it has none.
  wholeCamera() {
    return this.drawing.camera(this.state, this.size());
  }

  // The height of the view at the target.
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
   * Turn the first directional light.
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
   * Move the target by pixels of the displayed picture.
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

  // Keep the camera in front of a flat shape and outside of any shape.
  clampCamera() {
    const { camera, shape } = this.state;
    const { flat, lying, radius, outline } = this.data.shapes[shape];
    const least = lying ? 2 : -89;
    camera.elevation = Math.max(least, Math.min(89, camera.elevation));
    if (lying) camera.target[1] = Math.max(0, camera.target[1]);
    if (camera.distance !== null) {
      const away = Math.hypot(...camera.target);
      camera.distance = Math.max(camera.distance, flat ? 0.15 : radius + away + 0.05);
      // an orthographic camera cuts off what is behind it
      if (camera.orthographic_height !== null) {
        const all = framing(camera, outline, [1, 1], 1) - 1;
        camera.distance = Math.max(camera.distance, all + 0.05);
      }
    }
  }

  // --- maps

  /**
   * Use pictures as the map of a slot, or each by its name. Errors of one are reported and the
   * others are used.
   * @param {File[]} files
   * @param {Slot | ""} slot
   */
  async takeMaps(files, slot = "") {
    const messages = [];
    const slots = [];
    for (const file of files) {
      try {
        const taken = await this.takeMap(file, slot);
        messages.push(taken.message);
        slots.push(taken.slot);
      } catch (error) {
        this.showMessage(`${file.name}: ${firstLine(error)}`);
      }
    }
    if (!messages.length) return;
    this.mapMessage = messages.join("; ");
    // dust has no other use; the heights may be among the later files
    if (slots.includes("dust")) this.setOpening(this.state.opening ?? OPENING);
    this.changed(true);
  }

  /**
   * @param {File} file
   * @param {Slot | ""} wanted
   */
  async takeMap(file, wanted) {
    const { slot, ...how } = this.slotFor(file, wanted);
    const picture = await pictureOf(file, this.gpu.limits.maxTextureDimension2D);
    await this.changeMaps((pictures) =>
      this.withoutBakes(replaced(pictures, this.data.slots, slot, picture, how), slot),
    );
    for (const each of slot === "packed" ? PACKED : [slot]) this.sources[each] = file.name;
    // a base colour with opacity replaces that too
    if (slot === "base_color" && varies(picture, 3)) this.sources.opacity = file.name;
    if (slot === "height" && !this.hasHeights) {
      this.hasHeights = true;
      if (this.state.technique === "flat") this.useTechnique("relief");
    }
    return { slot, message: this.describeMap(file.name, slot, picture, how) };
  }

  /** @param {string} technique */
  useTechnique(technique) {
    const { reference_height, projection } = this.data.techniques[technique];
    Object.assign(this.state, { technique, reference_height, projection });
  }

  /**
   * The slot of a file and the options for reading it: by the panel, or else by its name.
   * @param {File} file
   * @param {Slot | ""} wanted
   * @returns {Reading & { slot: Slot }}
   */
  slotFor({ name }, wanted) {
    const found = meaningOf(name, this.data.names);
    const slot = wanted || found?.slot;
    if (!slot) {
      throw new Error("its name matches no map of the page; drop it on a map under “Maps”");
    }
    // the name of another map has no options for this one
    const reading = found?.slot === slot ? found : { polarity: "height", green: "gl" };
    const { channel, polarity, green } = this.drop;
    return {
      slot,
      channel,
      polarity: polarity || reading.polarity,
      green: green || reading.green,
    };
  }

  /**
   * Remove a map.
   * @param {Slot} slot
   */
  async removeMap(slot) {
    try {
      await this.changeMaps((pictures) =>
        this.withoutBakes(without(pictures, this.data.slots, slot), slot),
      );
    } catch (error) {
      this.showMessage(firstLine(error));
      return;
    }
    delete this.sources[slot];
    if (slot === "height") {
      this.hasHeights = false;
      Object.assign(this.state, { technique: "flat", compare: "" });
      if (this.state.show === "missed") this.state.show = "color";
    }
    this.mapMessage = `Drawn without ${slotName(slot)}.`;
    this.changed(true);
  }

  /**
   * The pictures without bakes of the page's own heights, where these are replaced.
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
  describeMap(name, slot, { width, height, bits, lost }, { polarity, green }) {
    if (lost)
      this.showMessage(`${name} is interlaced: 8 of its 16 bits per channel are read.`, true);
    if (slot === "height" && this.pictures.normal) {
      this.showMessage(
        "The normal map stays in use; remove it to derive normals from the heights.",
        true,
      );
    }
    const { proportion } = this.data.constants;
    const apart = Math.abs(width / height / proportion - 1);
    if (width * height > 1 && apart > 0.02) {
      this.showMessage(
        `${name} has other proportions than the page's material, and is stretched.`,
        true,
      );
    }
    const over = (slot === "normal" ? green === "dx" : polarity === "depth") ? ", inverted" : "";
    return `${name}: ${width} × ${height} with ${bits} bits per channel, used as ${slotName(slot)}${over}`;
  }

  // --- the picture

  /** @param {number} share */
  divide(share) {
    this.state.divider = Math.max(0, Math.min(1, share));
    if (this.drawing.state) this.drawing.state.divider = this.state.divider;
    this.updateDivider();
    this.link();
    this.host?.notify();
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

  // Give the canvas as many pixels as the screen shows.
  fit() {
    if (this.fixedSize) return;
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
    // the framing distance has changed
    for (const show of this.shows) show();
    this.drawing.frames.touched();
  }

  /**
   * Draw at a fixed size with a number of samples, for comparisons.
   * @param {number} width
   * @param {number} height
   * @param {number} samples
   */
  async draw(width, height, samples) {
    await this.mapping;
    this.fixedSize = [width, height];
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
      this.showMessage(
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
    const { width, height } = this.canvas;
    /** @type {import("view/state.js").Shown} */
    const shown = { size: [width, height], mapsChanged: this.pictures !== this.original };
    if (kind === "python") return toPython(this.state, this.data, shown);
    if (kind === "command") return toCommand(this.state, this.data, shown);
    if (kind !== "link") throw new Error(`unknown kind of copy: ${kind}`);
    return location.href.split("#")[0] + toHash(this.state, this.start);
  }

  /** @param {CopyKind} kind */
  async copy(kind) {
    const text = this.text(kind);
    const without = this.pictures === this.original ? "" : " Changed maps are not included.";
    byId("copied").textContent = text + (without && `\n${without.trim()}`);
    try {
      await navigator.clipboard.writeText(text);
      this.showMessage(
        `Copied as ${{ python: "Python", command: "a command", link: "a link" }[kind]}.${without}`,
        true,
      );
    } catch {
      this.showMessage(`The browser blocks copying; copy the text from the panel.${without}`, true);
    }
  }

  // --- messages

  /** @param {News} news */
  report(news) {
    if (news.error) this.showMessage(news.error);
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
    // after a failure the canvas still shows the technique before
    const { drawn } = this;
    const other = drawn && drawn.technique !== this.state.technique;
    if (other) parts.push(`${words(drawn.technique)} is still shown`);
    if (figures) {
      const { left, right, missed } = figures;
      parts.push(`${reads(left)}${right ? ` | ${reads(right)}` : ""} reads per pixel`);
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
    // the end of the line is cut off first
    if (size) parts.push(`${samples} of ${this.drawing.frames.limit} samples`);
    byId("figures").textContent = byId("figures").title = parts.join(" · ");
  }

  /**
   * @param {string} message
   * @param {boolean} quiet
   */
  showMessage(message, quiet = false) {
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
    // notices make room for errors
    while (box.children.length >= MESSAGES) {
      (box.querySelector(".quiet") ?? box.firstElementChild)?.remove();
    }
    box.append(line);
    line.scrollIntoView({ block: "nearest" });
    // notices vanish; errors stay until they are closed
    if (quiet) setTimeout(() => line.remove(), READ);
  }
}
