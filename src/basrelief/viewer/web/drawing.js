// The picture: what the programs are given, when they run, and how fine.
//
// While something moves, whole frames are drawn, smaller where one takes over 33 ms. At rest the
// places in each pixel are gone through, row by row, so that the page stays awake.

import { Bakes, Left } from "view/bakes.js";
import { framing, orbit, travelling } from "view/camera.js";
import { Colors } from "view/colors.js";
import { Job, rowsApart } from "view/gpu.js";
import { linked } from "view/link.js";
import { channelLevels, heightLevels, single } from "view/maps.js";

const SLOW = 33; // milliseconds a frame may take while something moves
const COARSEST = 8; // times smaller that each side is at most while something moves
const REST = 150; // milliseconds after which nothing moves any more
const PLANES = 9;
const words = (name) => name.replaceAll("_", " ");
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
    Object.assign(this, { gpu, data, canvas, heard });
    this.colors = new Colors(gpu, canvas, data.colors);
    this.pictures = {};
    this.taken = {}; // and what stands for those that are missing
    this.bakes = new Map(); // by edge
    this.textures = {};
    this.jobs = new Map();
    this.sides = {};
    this.coarse = 1; // how much smaller each side is while something moves
    this.limit = data.samples.length;
    this.state = null;
    this.dirty = false;
    this.done = 0;
    this.row = 0;
    this.speed = 1e-5; // milliseconds a pixel, as last seen
    this.failed = null;
  }

  // --- maps

  // `pictures` by name: what is in the page, or was dropped. A program has no use for one that is
  // missing, but is given a texel in its place. All or none of what changed is taken.
  setMaps(pictures) {
    const shown = { ...MISSING, ...pictures };
    const held = this.taken;
    const changed = Object.keys(shown).filter((name) => shown[name] !== held[name]);
    const levels = Object.fromEntries(
      changed.map((name) => [name, this.levels(name, shown[name])]),
    );
    const made = changed.map((name) => [name, this.gpu.texture(levels[name], HEIGHTS.includes(name))]);
    for (const name of Object.keys(held)) {
      if (shown[name] === held[name]) continue;
      this.textures[name].destroy();
      delete this.textures[name];
    }
    for (const [name, texture] of made) this.textures[name] = texture;
    this.taken = shown;
    this.pictures = pictures;
    if (levels.field) this.newHeights(levels.field[0]);
    if (levels.field || levels.normal) {
      this.bakedFor = null;
      // nothing can be drawn until what it needs is baked
      this.shown = null;
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

  bakesFor(edge) {
    if (!this.bakes.has(edge)) {
      const { gpu, data, textures, highest } = this;
      this.bakes.set(edge, new Bakes(gpu, data, textures.field, highest, edge));
    }
    return this.bakes.get(edge);
  }

  // Where there is no normal map, normals are made of the heights, by the library's own program.
  async ensureNormals(state) {
    const { edge } = this.choices(state);
    const wanted = `${state.scale} ${edge}`;
    const { normal, field } = this.pictures;
    if (normal || !field || this.bakedFor === wanted) return;
    const { width, height } = field;
    const texels = await this.bakesFor(edge).normals(state.scale * width);
    // another map may have been dropped
    if (this.pictures.normal) return;
    this.textures.normal.destroy();
    this.textures.normal = this.gpu.texture(channelLevels({ width, height, texels }), false);
    this.bakedFor = wanted;
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
    // the truth fills the same space, along straight rays
    if (state.show === "missed") {
      const exactly = { technique: "exact", projection: "full", heights: "sharp" };
      found.truth = { ...state, ...exactly, shadows: "none" };
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
            this.heard({ error: `${each.technique}: ${firstLine(error)}` });
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
        this.heard({ error: `${state.technique}: ${firstLine(error)}` });
      } finally {
        this.heard({ busy: "" });
      }
    }
    if (this.shown) this.touched();
  }

  // What one picture needs: its bake and its program.
  async side(side, state) {
    if (this.bakeOf(state).name && !this.baked(state)) await this.bakeFor(state);
    const program = linked(this.data.programs, "pixel", this.choices(state));
    const known = this.gpu.pipelines.has(program.key);
    if (!known) this.heard({ busy: `compiling ${words(state.technique)} …` });
    const pipeline = await this.gpu.pipeline(program);
    const name = `${side}:${program.key}`;
    if (!this.jobs.has(name)) {
      this.jobs.set(name, new Job(this.gpu, pipeline, this.data));
      this.fresh = true;
    }
    return { state, job: this.jobs.get(name) };
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

  // Something changed: draw anew with the next frame.
  touched() {
    this.dirty = true;
    this.movedAt = performance.now();
    this.wake();
  }

  wake() {
    if (this.asked || this.held) return;
    this.asked = true;
    requestAnimationFrame(() => {
      this.asked = false;
      this.tick();
    });
  }

  get size() {
    return [this.canvas.width, this.canvas.height];
  }

  // Buffers for a picture of the canvas's size, on each side.
  room() {
    const area = this.canvas.width * this.canvas.height;
    for (const name of ["left", "right", "truth"]) {
      const needed = this.shown[name] || name === "left" ? area : 1;
      const held = this.sides[name];
      if (held && held.area >= needed && held.area <= Math.max(4 * needed, 64)) continue;
      held?.planes.destroy();
      held?.sum.destroy();
      this.sides[name] = {
        area: needed,
        planes: this.gpu.planes(PLANES, needed, 1),
        sum: this.gpu.planes(4, needed, 1),
      };
    }
  }

  async tick() {
    if (this.running || !this.shown || this.held) return;
    this.running = true;
    try {
      if (this.dirty) await this.movingFrame();
      else if (this.done < this.limit) await this.finer();
    } catch (error) {
      this.heard({ error: firstLine(error) });
      this.done = this.limit;
    } finally {
      this.running = false;
    }
    if (this.dirty || this.done < this.limit) this.wake();
  }

  async movingFrame() {
    this.dirty = false;
    const size = this.size.map((n) => Math.max(16, Math.round(n / this.coarse)));
    this.room();
    const began = performance.now();
    this.sample(size, 0, 0, size[1], true);
    this.accumulate(size, true);
    this.drawnSize = size;
    this.drawn = 1;
    this.present();
    await this.gpu.device.queue.onSubmittedWorkDone();
    if (!this.shown) return;
    const took = performance.now() - began;
    this.frames = (this.frames ?? 0) + 1;
    this.speed = took / (size[0] * size[1]);
    // the first frame of a program says how long its driver makes ready, and nothing of the next
    if (!this.fresh) {
      const wanted = this.coarse * Math.sqrt(took / SLOW);
      this.coarse = wanted < 1.2 ? 1 : Math.min(COARSEST, wanted);
    }
    this.fresh = false;
    const full = size[0] === this.size[0] && size[1] === this.size[1];
    this.done = full ? 1 : 0;
    this.row = 0;
    this.spent = [0, 0];
    const gpuMilliseconds = await this.stamped();
    this.heard({ milliseconds: took, gpuMilliseconds, timedAt: size, size, samples: this.done });
    if (full && this.shown) await this.figures();
  }

  // A part of the next sample, as many rows as fit a frame's time.
  async finer() {
    if (performance.now() - this.movedAt < REST) return;
    const size = this.size;
    this.room();
    const apart = rowsApart(size[0]);
    const rows = Math.max(apart, Math.floor(SLOW / this.speed / size[0] / apart) * apart);
    const last = Math.min(size[1], this.row + rows);
    const began = performance.now();
    this.sample(size, this.done, this.row, last, true);
    await this.gpu.device.queue.onSubmittedWorkDone();
    const took = performance.now() - began;
    this.speed = took / (size[0] * (last - this.row));
    const clock = await this.stamped();
    this.spent = [this.spent[0] + took, clock === null ? null : this.spent[1] + clock];
    if (this.dirty || !this.shown) return;
    this.row = last;
    if (last < size[1]) return;
    this.accumulate(size, this.done === 0);
    this.done += 1;
    this.row = 0;
    this.drawnSize = size;
    this.drawn = this.done;
    this.present();
    const [milliseconds, gpuMilliseconds] = this.spent;
    this.spent = [0, 0];
    this.heard({ milliseconds, gpuMilliseconds, timedAt: size, size, samples: this.done });
    if (this.done === 1) await this.figures();
  }

  sample(size, number, first, last, timed = false) {
    for (const [side, { state, job }] of Object.entries(this.shown)) {
      job.put(this.values(state, size, this.data.samples[number]));
      job.dispatch(this.sides[side].planes, size, first, last, timed && side === "left");
    }
  }

  accumulate(size, first) {
    const view = { ...this.view(), size, first };
    this.colors.accumulate(this.sides.left, view);
    if (this.shown.right) this.colors.accumulate(this.sides.right, view);
  }

  view() {
    const { state, canvas } = this;
    return {
      size: this.drawnSize,
      canvas: [canvas.width, canvas.height],
      texels: this.texels,
      background: [...state.background, 1],
      divider: state.compare ? state.divider * canvas.width : canvas.width + 1,
      show: state.show,
      samples: this.drawn,
      figures: this.found,
    };
  }

  // Put what is drawn on the canvas, with the divider where it is now.
  present() {
    if (!this.shown || !this.drawnSize) return;
    const { left, right, truth } = this.sides;
    this.colors.present(left, right, truth, this.view());
  }

  async figures() {
    const view = { ...this.view(), size: this.drawnSize };
    const { right } = this.shown;
    const found = await this.colors.figures(this.sides.left, this.sides.truth, view);
    this.found = found;
    const told = { figures: found };
    if (right) {
      told.right = await this.colors.figures(this.sides.right, this.sides.truth, view);
      this.found = { ...found, most: Math.max(found.most, told.right.most) };
    }
    this.heard(told);
    if (this.state.show !== "color" && !this.dirty) this.present();
  }

  // What the last timed dispatch took by the GPU's own clock, null where it has none.
  async stamped() {
    const { stamps } = this.gpu;
    if (!stamps) return null;
    await stamps.read.mapAsync(GPUMapMode.READ);
    const [first, last] = new BigUint64Array(stamps.read.getMappedRange());
    stamps.read.unmap();
    return Number(last - first) * 1e-6;
  }

  // Resolves when nothing is left to be drawn.
  async settled() {
    while (this.compiling || this.running || this.dirty || this.done < this.limit) {
      if (this.failed && !this.shown) throw this.failed;
      await new Promise((resolve) => setTimeout(resolve, 10));
    }
  }

  // The words of a side's planes, as they were drawn last.
  async words(side = "left") {
    const [width, height] = this.drawnSize;
    const words = await this.gpu.read(this.sides[side].planes);
    return words.slice(0, 4 * PLANES * width * height);
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

function hasHoles({ texels }) {
  for (let k = 3; k < texels.length; k += 4) if (texels[k] !== 65535) return true;
  return false;
}

export const firstLine = (error) => String(error?.message ?? error).split("\n")[0];
