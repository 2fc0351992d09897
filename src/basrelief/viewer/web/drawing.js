// The drawing: programs of the picture, and their arguments.

import { Bakes, Cancelled } from "view/bakes.js";
import { framing, orbit, travelling } from "view/camera.js";
import { Frames, REST } from "view/frames.js";
import { Job } from "view/gpu.js";
import { linked } from "view/link.js";
import { channelLevels, hasHoles, heightLevels, single } from "view/maps.js";
import { MissedHits } from "view/missed.js";
import { opened } from "view/opened.js";
import { firstLine, words } from "view/text.js";

/** @import { Data, Heights, Light, Pair, Tiling, Values } from "view/data" */
/** @import { PlacedOrbit } from "view/camera.js" */
/** @import { Figures } from "view/colors.js" */
/** @import { Pictures } from "view/dropped.js" */
/** @import { Gpu, ProgramValues } from "view/gpu.js" */
/** @import { Choices, Edge } from "view/link.js" */
/** @import { Level, Picture } from "view/maps.js" */
/** @import { State } from "view/state.js" */

/**
 * News of a drawing: the properties that changed.
 * @typedef {object} News
 * @property {string} [error]
 * @property {string} [busy] the work in progress, "" when there is none
 * @property {{ technique: string, compare: string }} [drawn]
 * @property {{ left: Figures, right?: Figures, missed: boolean } | null} [figures]
 * @property {number} [milliseconds]
 * @property {number | null} [gpuMilliseconds] by timestamp queries, null without
 * @property {Pair} [timedAt] the size of the timed frame
 * @property {Pair} [size]
 * @property {number} [samples]
 */
/** @typedef {"left" | "right" | "truth" | "right_truth"} SideName */
/** @typedef {{ left: State } & { [side in SideName]?: State }} SideStates */
/** @typedef {{ state: State, job: Job }} Side */
/** @typedef {{ left: Side } & { [side in SideName]?: Side }} Shown */
/**
 * What a program depends on.
 * @typedef {Choices & { technique: string, "map.filter": string, normal_map: boolean }}
 *   ProgramChoices
 */

const JOBS = 8; // programs that keep their values, besides those that are shown
const NOTHING = single([0, 0, 0, 65535]);
/** @type {{ [name: string]: Picture }} */
const MISSING = {
  field: single([65535]),
  distances: single([65535]),
  unbaked: single([0, 0, 0, 0]),
};
const HEIGHTS = ["field", "distances"];

export class Drawing {
  /**
   * @param {Gpu} gpu
   * @param {Data} data
   * @param {HTMLCanvasElement} canvas
   * @param {(news: News) => void} onNews
   */
  constructor(gpu, data, canvas, onNews) {
    this.gpu = gpu;
    this.data = data;
    // errors of a lost device are not reported
    /** @type {(news: News) => void} */
    this.onNews = (news) => this.paused || onNews(news);
    this.paused = false;
    /** @type {Pictures} */
    this.sources = {}; // those of the page, before a hole opens
    /** @type {number | null} */
    this.opening = null; // of the hole in the current pictures
    /** @type {Promise<void>} */
    this.setting = Promise.resolve(); // pictures are set one after another
    /** @type {Pictures} */
    this.pictures = {}; // those that are drawn
    /** @type {{ [name: string]: Picture }} */
    this.current = {}; // with placeholders for missing ones
    /** @type {Pair} */
    this.texels = [1, 1]; // of the heights
    this.highest = 1; // of the heights
    /** @type {Map<string, Bakes>} */
    this.bakes = new Map(); // by edge; those of normals are separate
    /** @type {string | null} */
    this.bakedFor = null; // the scale and edge of the current normals
    /** @type {string | null} */
    this.awaited = null; // those of the normals to come
    /** @type {number | null} */
    this.resting = null;
    this.renewing = 0;
    /** @type {Promise<void>} */
    this.making = Promise.resolve();
    /** @type {{ [name: string]: GPUTexture }} */
    this.textures = {};
    /** @type {Map<string, Job>} */
    this.jobs = new Map();
    /** @type {State | null} */
    this.latest = null; // the state that is requested
    /** @type {State | null} */
    this.state = null; // the state that is shown
    /** @type {Promise<void> | null} */
    this.compiling = null;
    /** @type {unknown} */
    this.failed = null;
    /** @type {Set<string>} */
    this.reported = new Set(); // failures that were reported
    /** @type {Shown | null} */
    this.shown = null; // the state and the job of each side
    this.measured = ""; // the key of the figures
    /** @type {MissedHits | null} */
    this.missed = null; // the program that finds missed hits
    this.missedKey = ""; // its key
    this.frames = new Frames(this, canvas);
  }

  // --- maps

  /**
   * Set the maps by name: those of the page, or dropped ones. A texel replaces a missing map, which
   * programs do not read. Either all changes are applied, or none: rejects where the GPU refuses one.
   * @param {Pictures} sources
   */
  setMaps(sources) {
    return this.inTurn(() => this.apply(sources, this.opening));
  }

  /**
   * Open the hole of the current maps as far as a state wants it.
   * @param {State} state
   */
  open({ opening }) {
    return this.inTurn(async () => {
      if (opening !== this.opening) await this.apply(this.sources, opening);
    });
  }

  /**
   * Act after earlier changes of the maps.
   * @param {() => Promise<void>} act
   */
  inTurn(act) {
    const set = this.setting.then(act);
    this.setting = set.catch(() => {});
    return set;
  }

  /**
   * @param {Pictures} sources
   * @param {number | null} opening
   */
  async apply(sources, opening) {
    const pictures = opened(sources, opening, this.data);
    const nothing = Object.fromEntries(this.data.programs.maps.map((name) => [name, NOTHING]));
    const shown = Object.assign({ ...MISSING, ...nothing }, pictures);
    const current = this.current;
    const changed = Object.keys(shown).filter((name) => shown[name] !== current[name]);
    const levels = Object.fromEntries(
      changed.map((name) => [name, this.levels(name, shown[name])]),
    );
    const made = await this.texturesOf(levels);
    for (const name of Object.keys(current)) {
      if (shown[name] === current[name]) continue;
      this.textures[name].destroy();
      delete this.textures[name];
    }
    Object.assign(this.textures, made);
    this.current = shown;
    Object.assign(this, { sources, opening, pictures });
    if (levels.field) this.newHeights(levels.field[0]);
    if (levels.field || levels.normal) {
      this.bakedFor = null;
      // nothing can be drawn before the normals are made
      this.shown = null;
    }
  }

  /** @param {{ [name: string]: Level<Uint16Array | Float32Array>[] }} levels */
  async texturesOf(levels) {
    /** @type {{ [name: string]: GPUTexture }} */
    const made = {};
    try {
      const { failed } = this.gpu.checked(() => {
        for (const [name, each] of Object.entries(levels)) {
          made[name] = this.gpu.texture(each, HEIGHTS.includes(name));
        }
      });
      await failed;
      return made;
    } catch (error) {
      for (const each of Object.values(made)) each.destroy();
      throw error;
    }
  }

  /**
   * @param {string} name
   * @param {Picture} picture
   * @returns {Level<Uint16Array | Float32Array>[]}
   */
  levels(name, picture) {
    if (HEIGHTS.includes(name)) return heightLevels(picture);
    const isBake = Object.values(this.data.techniques).some(({ bake }) => bake === name);
    if (name === "unbaked" || isBake) return [picture];
    return channelLevels(picture, name.endsWith("color") && hasHoles(picture));
  }

  /**
   * The table of a state's technique, from the page or baked here; undefined if there is none.
   * @param {State} state
   */
  baked(state) {
    const { name, edge } = this.bakeOf(state);
    if (edge === "wrap" && this.textures[name]) return this.textures[name];
    return this.bakes.get(edge)?.tables.get(name);
  }

  /**
   * The table that a state's technique needs, as in `rendering.programs`; the name is "" for none.
   * @param {State} state
   */
  bakeOf(state) {
    const choices = this.choices(state);
    const { bake } = this.data.techniques[choices.technique];
    const name = bake && choices["map.filter"] === "mip" ? `mip_${bake}` : (bake ?? "");
    return { name, edge: choices["map.edge"] };
  }

  /**
   * Discard the bakes of the heights before.
   * @param {Level<Uint16Array | Float32Array>} heights
   */
  newHeights({ width, height, texels }) {
    this.texels = [width, height];
    this.highest = 0;
    for (const height of texels) this.highest = Math.max(this.highest, height);
    for (const each of this.bakes.values()) each.destroy();
    this.bakes.clear();
  }

  /**
   * @param {Edge} edge
   * @param {string} use
   */
  bakesFor(edge, use = "") {
    const name = use + edge;
    const known = this.bakes.get(name);
    if (known) return known;
    const { gpu, data, textures, highest, frames } = this;
    const made = new Bakes(gpu, data, textures.field, highest, edge, frames.pace);
    this.bakes.set(name, made);
    return made;
  }

  /**
   * The scale and edge of the normals that a state needs; null if it needs none. Without a normal
   * map, the library's own program derives normals from the heights.
   * @param {State} state
   */
  normalsFor(state) {
    const { normal, field } = this.pictures;
    const choices = this.choices(state);
    if (normal || !field || !choices.normal_map) return null;
    return `${state.scale} ${choices["map.edge"]}`;
  }

  /**
   * Wait for the first normals; make others once the numbers rest, and use the old ones until then.
   * @param {State} state
   */
  async ensureNormals(state) {
    const wanted = this.normalsFor(state);
    if (wanted !== null && this.bakedFor === null) await this.makeNormals(state, () => true);
    const settled = wanted === null || wanted === this.bakedFor;
    if (!settled && wanted === this.awaited) return;
    clearTimeout(this.resting ?? undefined);
    this.awaited = settled ? null : wanted;
    this.resting = settled ? null : setTimeout(() => this.renewNormals(), REST);
  }

  async renewNormals() {
    this.resting = null;
    const state = this.latest;
    if (!state) return;
    const wanted = this.normalsFor(state);
    if (wanted === null) return;
    this.renewing += 1;
    try {
      await this.makeNormals(state, () => this.normalsFor(this.latest ?? state) === wanted);
      if (this.awaited === wanted) this.awaited = null;
      if (this.shown) this.frames.touched();
    } catch (error) {
      if (!(error instanceof Cancelled)) this.onNews({ error: `normals: ${firstLine(error)}` });
      else if (this.awaited === wanted && this.bakedFor !== null) {
        // the numbers changed and changed back
        this.awaited = null;
        await this.ensureNormals(this.latest ?? state);
      }
    } finally {
      this.renewing -= 1;
    }
  }

  /**
   * Make normals after earlier ones, unless they exist by then or are no longer `needed`.
   * @param {State} state
   * @param {() => boolean} needed
   */
  makeNormals(state, needed) {
    const made = this.making.then(async () => {
      const wanted = this.normalsFor(state);
      const { field } = this.pictures;
      if (!field || wanted === null || wanted === this.bakedFor) return;
      const { width, height } = field;
      const bakes = this.bakesFor(this.choices(state)["map.edge"], "normals ");
      // another map may have been dropped
      const still = () =>
        this.pictures.field === field && this.normalsFor(state) === wanted && needed();
      const texels = await bakes.normals(state.scale * width, still);
      const { normal } = await this.texturesOf({
        normal: channelLevels({ width, height, texels }),
      });
      if (!still()) {
        normal.destroy();
        throw new Cancelled();
      }
      this.textures.normal.destroy();
      this.textures.normal = normal;
      this.bakedFor = wanted;
    });
    this.making = made.catch(() => {});
    return made;
  }

  // --- values

  /**
   * @param {State} state
   * @param {Pair} size
   * @returns {PlacedOrbit}
   */
  camera(state, size) {
    const { camera } = state;
    const { outline } = this.data.shapes[state.shape];
    const distance = camera.distance ?? framing(camera, outline, size, this.data.filled);
    return { ...camera, distance };
  }

  /**
   * The choices that a program depends on, as in `programs.variant_of`, with technique and maps.
   * @param {State} state
   * @returns {ProgramChoices}
   */
  choices(state) {
    const { pictures, data } = this;
    const technique = pictures.field ? state.technique : "flat";
    const { columns, exact, heights } = data.techniques[technique];
    /** @type {(tiling: Tiling) => boolean} */
    const repeats = ({ tiles, shift }) => shift.some(Boolean) || tiles.some((n) => n <= 0 || n > 1);
    const tilings = [{ tiles: state.tiling, shift: state.shift }];
    if (state.apart) tilings.push(...Object.values(state.tilings));
    if (state.layer) tilings.push(state.layer_tiling);
    const wraps = state.edge === "wrap" || (state.edge === "clip" && tilings.some(repeats));
    const filter = heights.includes(state.heights) ? state.heights : "sharp";
    /** @type {(name: string) => boolean} */
    const has = (name) => Boolean(pictures[name]);
    const layer = state.layer && data.constants.layer;
    const there = data.programs.maps.map((name) => [
      `${name}_map`,
      has(name) && (layer || !name.startsWith("layer_")),
    ]);
    return {
      ...state,
      technique,
      displaced: technique !== "flat",
      shadows: technique === "flat" ? "none" : state.shadows,
      columns,
      exact_shadows: exact && state.shadows === "hard",
      "map.edge": wraps ? "wrap" : "clamp",
      "map.filter": columns ? "columns" : filter,
      own_tilings: state.apart,
      layer,
      ...Object.fromEntries(there),
      // the tops of columns are level, whatever the heights beside them
      normal_map: has("normal") || (has("field") && state.scale > 0 && !columns),
      shadows_on: "relief",
      shadow_maps: false,
      depth_only: false,
    };
  }

  /**
   * @param {State} state
   * @param {Pair} size
   * @param {Pair} sample
   * @returns {ProgramValues}
   */
  values(state, size, sample) {
    const { data, textures } = this;
    const { technique } = this.choices(state);
    const { origin, to_object } = data.shapes[state.shape];
    const [fade_near, fade_far] = state.fades ? state.fade : [0, 0];
    const { proportion, tilings } = this.mapPlacements(state);
    const surface_parameters = { ...state.surface_parameters[state.surface] };
    // the page's own emission map is normalised by its maximum
    const glow = this.pictures.emission?.dropped ? 1 : data.constants.glow;
    const { emission } = surface_parameters;
    if (Array.isArray(emission)) surface_parameters.emission = emission.map((x) => x * glow);
    return {
      sample: { camera: orbit(this.camera(state, size), size), offset: sample },
      placement: { origin, to_object, proportion, tiling: state.tiling, shift: state.shift },
      relief: {
        scale: state.scale,
        reference_height: state.reference_height,
        bias: state.bias,
        fade_near,
        fade_far,
      },
      smoothing: state.smoothing,
      settings: state.settings[technique],
      surface_parameters,
      tilings,
      shading: state.shading,
      shadowing: state.shadowing,
      fog: state.fog,
      lights: state.lights
        .filter((light) => light.intensity > 0)
        .map((light) => lightRecord(light, Object.keys(data.lightKinds))),
      views: [],
      geometry_vertices: [],
      ...textures,
      baked: this.baked(state) ?? textures.unbaked,
    };
  }

  /**
   * The placements of maps relative to the heights, as in `Object.map_tilings`.
   * @param {State} state
   */
  mapPlacements(state) {
    const main = { tiles: state.tiling, shift: state.shift };
    const { constants } = this.data;
    /** @type {(tiling: Tiling) => number[]} */
    const beside = ({ tiles, shift }) => {
      const ratio = tiles.map((n, k) => n / main.tiles[k]);
      return [...ratio, ...shift.map((n, k) => n - main.shift[k] * ratio[k])];
    };
    /** @type {Values} */
    const tilings = {};
    for (const [name, own] of Object.entries(state.tilings)) {
      tilings[name] = beside(state.apart ? own : main);
    }
    const { pictures } = this;
    const own = state.apart && pictures.normal ? beside(state.tilings.normal) : [1, 1];
    const proportion = constants.proportion * Math.abs(own[0] / own[1]);
    const layer = beside(state.layer ? state.layer_tiling : main);
    const stretch = Math.abs(layer[1] / layer[0]);
    tilings.layer = layer;
    tilings.layer_normal_stretch = state.layer
      ? (stretch * proportion) / constants.layerProportion
      : 1;
    return { proportion, tilings };
  }

  // --- pictures

  /**
   * The states of the pictures that a state needs, by side.
   * @param {State} state
   * @returns {SideStates}
   */
  sideStates(state) {
    /** @type {SideStates} */
    const found = { left: state };
    const other = state.compare;
    if (other) {
      const { reference_height, projection } = this.data.techniques[other];
      const own = state.reference_height === this.data.techniques[state.technique].reference_height;
      found.right = {
        ...state,
        technique: other,
        reference_height: own ? reference_height : state.reference_height,
        projection,
      };
    }
    // the truth has straight rays and the same reference height; another height has its own truth
    if (state.show === "missed") {
      const { right } = found;
      /** @type {State} */
      const truth = {
        ...state,
        technique: "exact",
        projection: "full",
        heights: "sharp",
        shadows: "none",
      };
      found.truth = truth;
      if (right && right.reference_height !== state.reference_height) {
        found.right_truth = { ...truth, reference_height: right.reference_height };
      }
    }
    return found;
  }

  /**
   * Show another state; resolves when its programs are ready and a frame is requested.
   * @param {State} state
   * @returns {Promise<void>}
   */
  async show(state) {
    this.latest = state;
    if (this.compiling) return this.compiling;
    this.compiling = this.prepare();
    try {
      await this.compiling;
    } finally {
      this.compiling = null;
    }
  }

  async prepare() {
    /** @type {State | null} */
    let state = null;
    while (state !== this.latest) {
      state = /** @type {State} */ (this.latest);
      /** @type {Set<string>} */
      const failures = new Set();
      /** @type {(side: string, state: State, error: unknown) => void} */
      const failing = (side, { technique }, error) => {
        const message = `${technique}: ${firstLine(error)}`;
        failures.add(`${side} ${message}`);
        if (!this.reported.has(`${side} ${message}`)) this.onNews({ error: message });
      };
      try {
        await this.open(state);
        await this.ensureNormals(state);
        const { left, ...others } = this.sideStates(state);
        /** @type {Shown} */
        const shown = { left: await this.side("left", left) };
        /** @type {Partial<State>} */
        const lost = {};
        for (const [side, each] of Object.entries(others)) {
          try {
            shown[/** @type {SideName} */ (side)] = await this.side(side, each);
          } catch (error) {
            if (error instanceof Cancelled) throw error;
            // the other pictures are drawn
            if (side === "right") lost.compare = "";
            else lost.show = "color";
            failing(side, each, error);
          }
        }
        if (shown.truth) await this.ensureMissed(shown.truth.state);
        // if another state is requested by now, keep the current picture
        if (state !== this.latest) continue;
        this.shown = shown;
        this.state = { ...state, ...lost };
        this.failed = null;
      } catch (error) {
        if (error instanceof Cancelled) {
          // another state is requested by now
          state = null;
          continue;
        }
        this.failed = error;
        failing("left", state, error);
      } finally {
        this.onNews({ busy: "" });
      }
      // a failure is reported again if it recurs after a success
      this.reported = failures;
    }
    if (!this.shown || !this.state) return;
    this.dropJobs();
    // after a failure this is not the requested state
    const { technique, compare, show } = this.state;
    const measured = [technique, compare, show].join();
    this.onNews({
      drawn: { technique, compare },
      ...(measured !== this.measured && { figures: null }),
    });
    this.measured = measured;
    this.frames.touched();
  }

  /**
   * Prepare one picture: its bake and its program.
   * @param {string} side
   * @param {State} state
   * @returns {Promise<Side>}
   */
  async side(side, state) {
    if (this.bakeOf(state).name && !this.baked(state)) await this.bakeFor(state);
    const program = linked(this.data.programs, "pixel", this.choices(state));
    const known = this.gpu.pipelines.has(program.key);
    if (!known) this.onNews({ busy: `compiling ${words(state.technique)} …` });
    const pipeline = await this.gpu.pipeline(program);
    const name = `${side}:${program.key}`;
    const job = this.jobs.get(name) ?? new Job(this.gpu, pipeline, this.data);
    this.frames.fresh ||= !this.jobs.has(name);
    // the most recently used job is the last
    this.jobs.delete(name);
    this.jobs.set(name, job);
    return { state, job };
  }

  /**
   * The program that finds the missed hits of pictures with this truth.
   * @param {State} truth
   */
  async ensureMissed(truth) {
    const program = linked(this.data.programs, "missed_hit", this.choices(truth));
    if (this.missedKey === program.key) return;
    const made = await this.gpu.pipeline(program);
    this.missed?.destroy();
    this.missed = new MissedHits(this.gpu, new Job(this.gpu, made, this.data));
    this.missedKey = program.key;
  }

  // Drop all but the most recent jobs that are not shown.
  dropJobs() {
    const shown = Object.values(this.shown ?? {}).map(({ job }) => job);
    const others = [...this.jobs].filter(([, job]) => !shown.includes(job));
    for (const [name, job] of others.slice(0, Math.max(0, others.length - JOBS))) {
      this.jobs.delete(name);
      job.destroy();
    }
  }

  /** @param {State} state */
  async bakeFor(state) {
    const { name, edge } = this.bakeOf(state);
    /** @type {(share: number) => void} */
    const report = (share) => {
      const percent = share ? ` ${Math.floor(100 * share)} %` : "";
      this.onNews({ busy: `baking ${words(name)} for ${words(state.technique)} …${percent}` });
    };
    // not needed if another technique is selected by now
    const needed = () =>
      Object.values(this.sideStates(this.latest ?? state)).some((each) => {
        const other = this.bakeOf(each);
        return other.name === name && other.edge === edge;
      });
    report(0);
    await this.bakesFor(edge).table(name, report, needed);
  }

  // Resolves when all is drawn.
  async settled() {
    const normals = () => this.resting !== null || this.renewing;
    while (this.compiling || this.frames.busy || normals()) {
      if (this.failed && !this.shown) throw this.failed;
      await new Promise((resolve) => setTimeout(resolve, 10));
    }
  }
}

/**
 * A light as `scene.lights` makes it: numbers of its record, and those that are computed. Shaders
 * ignore the numbers of other kinds.
 * @param {Light} light
 * @param {string[]} kinds
 */
function lightRecord({ kind, ...light }, kinds) {
  const half = ((light.angle / 2) * Math.PI) / 180;
  const numbers = /** @type {Values} */ (light);
  return {
    ...numbers,
    kind: kinds.indexOf(kind),
    direction: travelling(light.azimuth, light.elevation),
    color: light.color.map((c) => c * light.intensity),
    cos_inner: Math.cos(half * (1 - light.softness)),
    cos_outer: Math.cos(half),
  };
}
