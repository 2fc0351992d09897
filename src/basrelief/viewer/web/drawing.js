// The picture: which programs it takes, and what these are given.

import { Bakes, Left } from "view/bakes.js";
import { framing, orbit, travelling } from "view/camera.js";
import { Frames, REST } from "view/frames.js";
import { Job } from "view/gpu.js";
import { linked } from "view/link.js";
import { channelLevels, hasHoles, heightLevels, single } from "view/maps.js";
import { firstLine, words } from "view/text.js";

const JOBS = 8; // programs whose values are kept, beside those that are shown
const NAMES = ["base_color", "normal", "response", "emission", "layer_color", "layer_normal"];
const NOTHING = single([0, 0, 0, 65535]);
const MISSING = {
  field: single([65535]),
  distances: single([65535]),
  unbaked: single([0, 0, 0, 0]),
  ...Object.fromEntries(NAMES.map((name) => [name, NOTHING])),
};
const HEIGHTS = ["field", "distances"];

export class Drawing {
  constructor(gpu, data, canvas, heard) {
    Object.assign(this, { gpu, data });
    // what a lost device brings about is no news
    this.heard = (news) => this.held || heard(news);
    this.held = false;
    this.pictures = {};
    this.taken = {}; // and what stands for those that are missing
    this.bakes = new Map(); // by edge, those of normals apart
    this.bakedFor = null; // the numbers that the normals are made for
    this.awaited = null; // and those that they are to be made for
    this.resting = null;
    this.renewing = 0;
    this.making = Promise.resolve();
    this.textures = {};
    this.jobs = new Map();
    this.state = null;
    this.failed = null;
    this.told = new Set(); // what could not be shown, and is said already
    this.shown = null; // the state and the job of each side
    this.measured = ""; // what figures are of
    this.frames = new Frames(this, canvas);
  }

  // --- maps

  // `pictures` by name: what is in the page, or was dropped. A program has no use for one that is
  // missing, but is given a texel in its place. All or none of what changed is taken: rejects where
  // the GPU refuses one.
  async setMaps(pictures) {
    const shown = { ...MISSING, ...pictures };
    const held = this.taken;
    const changed = Object.keys(shown).filter((name) => shown[name] !== held[name]);
    const levels = Object.fromEntries(
      changed.map((name) => [name, this.levels(name, shown[name])]),
    );
    const made = await this.texturesOf(levels);
    for (const name of Object.keys(held)) {
      if (shown[name] === held[name]) continue;
      this.textures[name].destroy();
      delete this.textures[name];
    }
    Object.assign(this.textures, made);
    this.taken = shown;
    this.pictures = pictures;
    if (levels.field) this.newHeights(levels.field[0]);
    if (levels.field || levels.normal) {
      this.bakedFor = null;
      // nothing can be drawn until what it needs is baked
      this.shown = null;
    }
  }

  async texturesOf(levels) {
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

  levels(name, picture) {
    if (HEIGHTS.includes(name)) return heightLevels(picture);
    if (name === "unbaked" || this.isBake(name)) return [picture];
    return channelLevels(picture, name.endsWith("color") && hasHoles(picture));
  }

  isBake(name) {
    return Object.values(this.data.techniques).some(({ bake }) => bake === name);
  }

  // What a state's technique has baked, undefined where it is not there: out of the page, or made
  // here.
  baked(state) {
    const { name, edge } = this.bakeOf(state);
    if (edge === "wrap" && this.textures[name]) return this.textures[name];
    return this.bakes.get(edge)?.tables.get(name);
  }

  // What a state's technique needs, as `programs` has it: "" where it needs nothing.
  bakeOf(state) {
    const { technique, heights, edge } = this.choices(state);
    const { bake } = this.data.techniques[technique];
    return { name: bake && heights === "mip" ? `mip_${bake}` : (bake ?? ""), edge };
  }

  // What was made of the heights before is of no use any more.
  newHeights({ width, height, texels }) {
    this.texels = [width, height];
    this.highest = texels.reduce((most, x) => Math.max(most, x), 0);
    for (const each of this.bakes.values()) each.destroy();
    this.bakes.clear();
  }

  bakesFor(edge, use = "") {
    const name = use + edge;
    if (!this.bakes.has(name)) {
      const { gpu, data, textures, highest, frames } = this;
      this.bakes.set(name, new Bakes(gpu, data, textures.field, highest, edge, frames.pace));
    }
    return this.bakes.get(name);
  }

  // Where there is no normal map, normals are made of the heights, by the library's own program: for
  // what numbers, null where none are needed.
  normalsFor(state) {
    const { normal, field } = this.pictures;
    if (normal || !field || !this.choices(state).normal) return null;
    return `${state.scale} ${this.choices(state).edge}`;
  }

  // The first normals are waited for; others are made once the numbers rest, and until then those
  // that there are do.
  async ensureNormals(state) {
    const wanted = this.normalsFor(state);
    if (wanted !== null && this.bakedFor === null) await this.makeNormals(state, () => true);
    const settled = wanted === null || wanted === this.bakedFor;
    if (!settled && wanted === this.awaited) return;
    clearTimeout(this.resting);
    this.awaited = settled ? null : wanted;
    this.resting = settled ? null : setTimeout(() => this.renewNormals(), REST);
  }

  async renewNormals() {
    const state = this.latest;
    const wanted = this.normalsFor(state);
    this.resting = null;
    if (wanted === null) return;
    this.renewing += 1;
    try {
      await this.makeNormals(state, () => this.normalsFor(this.latest) === wanted);
      if (this.awaited === wanted) this.awaited = null;
      if (this.shown) this.frames.touched();
    } catch (error) {
      if (!(error instanceof Left)) this.heard({ error: `normals: ${firstLine(error)}` });
      else if (this.awaited === wanted && this.bakedFor !== null) {
        // turned away and back
        this.awaited = null;
        await this.ensureNormals(this.latest);
      }
    } finally {
      this.renewing -= 1;
    }
  }

  // One after another, each unless it is made or not `needed` any more by then.
  makeNormals(state, needed) {
    const made = this.making.then(async () => {
      const wanted = this.normalsFor(state);
      if (wanted === null || wanted === this.bakedFor) return;
      const { field } = this.pictures;
      const { width, height } = field;
      const bakes = this.bakesFor(this.choices(state).edge, "normals ");
      // another map may be dropped
      const still = () =>
        this.pictures.field === field && this.normalsFor(state) === wanted && needed();
      const texels = await bakes.normals(state.scale * width, still);
      const { normal } = await this.texturesOf({ normal: channelLevels({ width, height, texels }) });
      if (!still()) {
        normal.destroy();
        throw new Left();
      }
      this.textures.normal.destroy();
      this.textures.normal = normal;
      this.bakedFor = wanted;
    });
    this.making = made.catch(() => {});
    return made;
  }

  // --- values

  camera(state, size) {
    const camera = { ...state.camera };
    if (camera.distance === null) {
      const { outline } = this.data.shapes[state.shape];
      camera.distance = framing(camera, outline, size, this.data.filled);
    }
    return camera;
  }

  // What binds the slots of a program, as `programs.choices_of` has it.
  choices(state) {
    const { pictures, data } = this;
    const technique = pictures.field ? state.technique : "flat";
    const { boxes, heights } = data.techniques[technique];
    const repeats = ({ tiles, shift }) => shift.some(Boolean) || tiles.some((n) => n <= 0 || n > 1);
    const tilings = [{ tiles: state.tiling, shift: state.shift }];
    if (state.apart) tilings.push(...Object.values(state.tilings));
    if (state.layer) tilings.push(state.layer_tiling);
    const clipped = state.edge === "clip";
    const wraps = state.edge === "wrap" || (clipped && tilings.some(repeats));
    const has = (name) => Boolean(pictures[name]);
    const layer = state.layer && data.constants.layer;
    return {
      ...state,
      technique,
      displaced: technique !== "flat",
      boxed: boxes,
      heights: heights.includes(state.heights) ? state.heights : "sharp",
      clipped,
      edge: wraps ? "wrap" : "clamp",
      base_color: has("base_color"),
      // the tops of boxes are level, whatever the heights beside them
      normal: has("normal") || (has("field") && state.scale > 0 && !boxes),
      response: has("response"),
      emission: has("emission"),
      layer,
      layer_color: layer && has("layer_color"),
      layer_normal: layer && has("layer_normal"),
      shadows_on: "relief",
      casts: false,
    };
  }

  values(state, size, sample) {
    const { data, textures } = this;
    const { technique } = this.choices(state);
    const { origin, to_object } = data.shapes[state.shape];
    const [fade_near, fade_far] = state.fades ? state.fade : [0, 0];
    const { proportion, places } = this.lying(state);
    const finish = { ...state.finish[state.surface] };
    if (finish.emission) finish.emission = finish.emission.map((x) => x * this.glow());
    return {
      view: { camera: orbit(this.camera(state, size), size), sample },
      placement: { origin, to_object, proportion, tiling: state.tiling, shift: state.shift },
      depth: { scale: state.scale, level: state.level, bias: state.bias, fade_near, fade_far },
      smoothing: state.smoothing,
      settings: state.settings[technique],
      finish,
      places,
      shading: state.shading,
      shadowing: state.shadowing,
      fog: state.air,
      lights: state.lights
        .filter((light) => light.intensity > 0)
        .map((light) => lightRecord(light, data.lightKinds)),
      views: [],
      ...textures,
      baked: this.baked(state) ?? textures.unbaked,
    };
  }

  // How much brighter than its own numbers the emission map is that the page was made with.
  glow() {
    return this.pictures.emission?.dropped ? 1 : this.data.constants.glow;
  }

  // How the maps lie beside the heights, as `Object.map_places` has it.
  lying(state) {
    const main = { tiles: state.tiling, shift: state.shift };
    const { constants } = this.data;
    const beside = ({ tiles, shift }) => {
      const ratio = tiles.map((n, k) => n / main.tiles[k]);
      return [...ratio, ...shift.map((n, k) => n - main.shift[k] * ratio[k])];
    };
    const places = {};
    for (const [name, own] of Object.entries(state.tilings)) {
      places[name] = beside(state.apart ? own : main);
    }
    const { pictures } = this;
    const own = state.apart && pictures.normal ? places.normal : [1, 1];
    const proportion = constants.proportion * Math.abs(own[0] / own[1]);
    places.layer = beside(state.layer ? state.layer_tiling : main);
    const stretch = Math.abs(places.layer[1] / places.layer[0]);
    places.layer_slant = state.layer ? (stretch * proportion) / constants.layerProportion : 1;
    return { proportion, places };
  }

  // --- what is drawn

  // The pictures that a state asks for, by where they are shown.
  wanted(state) {
    const found = { left: state };
    const other = state.compare;
    if (other) {
      const { level, projection } = this.data.techniques[other];
      const own = state.level === this.data.techniques[state.technique].level;
      found.right = { ...state, technique: other, level: own ? level : state.level, projection };
    }
    // the truth fills the same space, along straight rays; techniques that lie otherwise have their own
    if (state.show === "missed") {
      const exactly = { technique: "exact", projection: "full", heights: "sharp" };
      found.truth = { ...state, ...exactly, shadows: "none" };
      const { right } = found;
      if (right && right.level !== state.level) {
        found.right_truth = { ...found.truth, level: right.level };
      }
    }
    return found;
  }

  // Show another state; resolves when its programs are there and a frame is asked for.
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
    let state = null;
    while (state !== this.latest) {
      state = this.latest;
      const failures = new Set();
      const failing = (side, { technique }, error) => {
        const message = `${technique}: ${firstLine(error)}`;
        failures.add(`${side} ${message}`);
        if (!this.told.has(`${side} ${message}`)) this.heard({ error: message });
      };
      try {
        await this.ensureNormals(state);
        const { left, ...others } = this.wanted(state);
        const shown = { left: await this.side("left", left) };
        const lost = {};
        for (const [side, each] of Object.entries(others)) {
          try {
            shown[side] = await this.side(side, each);
          } catch (error) {
            if (error instanceof Left) throw error;
            // the rest is drawn all the same
            Object.assign(lost, side === "right" ? { compare: "" } : { show: "color" });
            failing(side, each, error);
          }
        }
        this.shown = shown;
        this.state = { ...state, ...lost };
        this.failed = null;
      } catch (error) {
        if (error instanceof Left) {
          // something else is wanted by now
          state = null;
          continue;
        }
        this.failed = error;
        failing("left", state, error);
      } finally {
        this.heard({ busy: "" });
      }
      // what could be shown meanwhile is told anew when it cannot again
      this.told = failures;
    }
    if (!this.shown) return;
    this.leaveJobs();
    // where something failed it is not what is wanted
    const { technique, compare, show } = this.state;
    const measured = [technique, compare, show].join();
    this.heard({ drawn: { technique, compare }, ...(measured !== this.measured && { figures: null }) });
    this.measured = measured;
    this.frames.touched();
  }

  // What one picture needs: its bake and its program.
  async side(side, state) {
    if (this.bakeOf(state).name && !this.baked(state)) await this.bakeFor(state);
    const program = linked(this.data.programs, "pixel", this.choices(state));
    const known = this.gpu.pipelines.has(program.key);
    if (!known) this.heard({ busy: `compiling ${words(state.technique)} …` });
    const pipeline = await this.gpu.pipeline(program);
    const name = `${side}:${program.key}`;
    const job = this.jobs.get(name) ?? new Job(this.gpu, pipeline, this.data);
    this.frames.fresh ||= !this.jobs.has(name);
    // the one that was used last is at the end
    this.jobs.delete(name);
    this.jobs.set(name, job);
    return { state, job };
  }

  // Of the programs that are not shown only the last keep their values.
  leaveJobs() {
    const shown = Object.values(this.shown).map(({ job }) => job);
    const others = [...this.jobs].filter(([, job]) => !shown.includes(job));
    for (const [name, job] of others.slice(0, Math.max(0, others.length - JOBS))) {
      this.jobs.delete(name);
      job.destroy();
    }
  }

  async bakeFor(state) {
    const { name, edge } = this.bakeOf(state);
    const tell = (share) => {
      const percent = share ? ` ${Math.floor(100 * share)} %` : "";
      this.heard({ busy: `baking ${words(name)} for ${words(state.technique)} …${percent}` });
    };
    // who has turned to another technique need not wait for this one
    const needed = () =>
      Object.values(this.wanted(this.latest)).some((each) => {
        const other = this.bakeOf(each);
        return other.name === name && other.edge === edge;
      });
    tell(0);
    await this.bakesFor(edge).table(name, tell, needed);
  }

  // Resolves when nothing is left to be drawn.
  async settled() {
    const normals = () => this.resting !== null || this.renewing;
    while (this.compiling || this.frames.busy || normals()) {
      if (this.failed && !this.shown) throw this.failed;
      await new Promise((resolve) => setTimeout(resolve, 10));
    }
  }
}

// A light as `scene.lights` makes it.
function lightRecord(light, kinds) {
  const half = ((light.angle / 2) * Math.PI) / 180;
  const spot = light.kind === "spot";
  return {
    kind: kinds.indexOf(light.kind),
    position: light.position,
    direction: light.kind === "point" ? [0, -1, 0] : travelling(light.azimuth, light.elevation),
    color: light.color.map((c) => c * light.intensity),
    falloff: light.falloff,
    cos_inner: spot ? Math.cos(half * (1 - light.softness)) : 1,
    cos_outer: spot ? Math.cos(half) : 0,
  };
}
