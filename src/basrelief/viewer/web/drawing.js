// The picture: what the programs are given, when they run, and how fine.
//
// While something moves, whole frames are drawn, smaller where one is slow. At rest the places in
// each pixel are gone through, row by row, so that the page stays awake.

import { Bakes, Left } from "view/bakes.js";
import { framing, orbit, travelling } from "view/camera.js";
import { Colors } from "view/colors.js";
import { Job, rowsApart } from "view/gpu.js";
import { linked } from "view/link.js";
import { channelLevels, hasHoles, heightLevels, single } from "view/maps.js";
import { Pace } from "view/pace.js";

const REST = 150; // milliseconds after which nothing moves any more
const PLANES = 9;
const JOBS = 8; // programs whose values are kept, beside those that are shown
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
    Object.assign(this, { gpu, data, canvas });
    // what a lost device brings about is no news
    this.heard = (news) => this.held || heard(news);
    this.held = false;
    this.colors = new Colors(gpu, canvas, data.colors);
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
    this.sides = {};
    this.pace = new Pace();
    this.frames = 0; // that were drawn while something moved
    this.reporting = false; // whether something is read back of a frame, while others may be drawn
    this.unreported = null; // the frame that it is to be read of next
    this.timing = false; // whether the GPU's clock is not read yet
    this.limit = data.samples.length;
    this.state = null;
    this.dirty = false;
    this.done = 0;
    this.row = 0;
    this.failed = null;
    this.told = new Set(); // what could not be shown, and is said already
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
      const { gpu, data, textures, highest, pace } = this;
      this.bakes.set(name, new Bakes(gpu, data, textures.field, highest, edge, pace));
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
      if (this.shown) this.touched();
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
    this.touched();
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
    this.fresh ||= !this.jobs.has(name);
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
    try {
      if (this.dirty) {
        if (this.pace.free) this.movingFrame();
      } else if (this.done < this.limit && this.still) {
        this.running = true;
        await this.finer();
      }
    } catch (error) {
      this.heard({ error: firstLine(error) });
      this.done = this.limit;
    } finally {
      this.running = false;
    }
    this.goOn();
  }

  // Frames that are on their way come here when they have landed.
  goOn() {
    if (this.dirty ? this.pace.free : this.done < this.limit && this.still) this.wake();
  }

  // Whether nothing is on its way, to the GPU or back.
  get still() {
    return !this.pace.flying && !this.reporting;
  }

  movingFrame() {
    const { pace, fresh } = this;
    const size = pace.moving(this.size);
    const full = size[0] === this.size[0] && size[1] === this.size[1];
    this.dirty = false;
    this.room();
    const frame = { began: performance.now(), size, full, fresh, alone: !pace.flying };
    frame.timed = this.sample(size, 0, 0, size[1]);
    this.accumulate(size, true);
    this.drawnSize = size;
    this.drawn = 1;
    this.present();
    this.fresh = false;
    this.frames += 1;
    this.done = full ? 1 : 0;
    this.row = 0;
    this.spent = [0, 0];
    pace.flying += 1;
    this.gpu.device.queue.onSubmittedWorkDone().then(() => this.landed(frame));
  }

  landed(frame) {
    const { pace } = this;
    pace.flying -= 1;
    if (!this.shown || this.held) {
      if (frame.timed) this.timing = false;
      return;
    }
    this.report({ ...frame, work: pace.work(performance.now() - frame.began) });
    this.goOn();
  }

  // Tell of a frame what has to be read back. The next do not wait for that, and of those that come
  // meanwhile only the last is told of.
  async report(frame) {
    if (this.unreported?.timed) this.timing = false;
    this.unreported = frame;
    if (this.reporting) return;
    this.reporting = true;
    try {
      while (this.unreported) await this.read(this.unreported);
    } catch (error) {
      this.heard({ error: firstLine(error) });
    } finally {
      this.reporting = false;
    }
    this.goOn();
  }

  async read({ size, work, timed, full, alone, fresh }) {
    this.unreported = null;
    const clock = timed ? await this.stamped() : null;
    // by the GPU's own clock where it has one: it alone knows what one of several took
    if (this.gpu.stamps ? timed : alone) {
      const milliseconds = Math.max(alone ? work : 0, clock ?? 0);
      // the first of a program says how long its driver makes ready, and nothing of the next
      if (!fresh) this.pace.note(milliseconds, size[0] * size[1]);
      this.heard({ milliseconds, gpuMilliseconds: clock, timedAt: size });
    }
    this.heard({ size, samples: full ? 1 : 0 });
    if (full && this.shown) await this.figures();
  }

  // A part of the next sample, as many rows as fit a frame's time.
  async finer() {
    if (performance.now() - this.movedAt < REST) return;
    const { size, pace } = this;
    this.room();
    const last = Math.min(size[1], this.row + pace.rows(size[0], rowsApart(size[0])));
    const began = performance.now();
    const timed = this.sample(size, this.done, this.row, last);
    const [clock] = await Promise.all([
      timed ? this.stamped() : null,
      this.gpu.device.queue.onSubmittedWorkDone(),
    ]);
    const cost = Math.max(pace.work(performance.now() - began), clock ?? 0);
    pace.note(cost, size[0] * (last - this.row));
    this.spent = [this.spent[0] + cost, clock === null ? null : this.spent[1] + clock];
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

  // Draw rows of a sample, on each side; returns whether the GPU's clock is asked for it.
  sample(size, number, first, last) {
    const timed = Boolean(this.gpu.stamps) && !this.timing;
    const shown = Object.entries(this.shown);
    shown.forEach(([side, { state, job }], k) => {
      job.put(this.values(state, size, this.data.samples[number]));
      job.dispatch(this.sides[side].planes, size, first, last, { stamp: timed ? k : null });
    });
    if (timed) this.gpu.resolveStamps(shown.length);
    this.timing ||= timed;
    return timed;
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
    if (!this.shown || !this.drawnSize || this.held) return;
    const { left, right, truth } = this.sides;
    this.colors.present(left, right, truth, this.view());
  }

  // What is measured on the picture; what another is drawn instead of by then is not told.
  async figures() {
    const { measured } = this;
    const view = { ...this.view(), size: this.drawnSize };
    const { sides, shown } = this;
    // both are asked for before anything else is drawn
    const [left, right] = await Promise.all([
      this.colors.figures(sides.left, sides.truth, view),
      shown.right && this.colors.figures(sides.right, sides.truth, view),
    ]);
    if (!this.shown || this.measured !== measured) return;
    this.found = { ...left, most: Math.max(left.most, right?.most ?? 0) };
    this.heard({ figures: { left, right, missed: Boolean(shown.truth) } });
    if (this.state.show !== "color" && !this.dirty) this.present();
  }

  // What the programs took that were timed last, by the GPU's own clock.
  async stamped() {
    try {
      return await this.gpu.readStamps();
    } finally {
      this.timing = false;
    }
  }

  // Resolves when nothing is left to be drawn.
  async settled() {
    const normals = () => this.resting !== null || this.renewing;
    const drawing = () => this.running || this.dirty || this.done < this.limit || !this.still;
    while (this.compiling || drawing() || normals()) {
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

export const firstLine = (error) => String(error?.message ?? error).split("\n")[0];
