// Types of the data that Python writes into a page as JSON: `viewer.state`, `viewer.printed`,
// `viewer.layouts`, `viewer.maps`, `viewer.names` and `viewer.bakes`. A test checks the data of a page
// against them.

export type Pair = [number, number];
export type Vec3 = [number, number, number];

// --- the state

export type Projection = "full" | "biased" | "limited";
export type Heights = "sharp" | "smooth" | "mip";
export type Show = "color" | "reads" | "missed" | "depth";

/** Numbers and vectors of a record by field. */
export type Values = { [field: string]: number | number[] };

export type Tiling = { tiles: Pair; shift: Pair };

/** Angles in degrees, azimuth 0 looks from +z. `distance` null frames the shape. */
export type Orbit = {
  azimuth: number;
  elevation: number;
  distance: number | null;
  target: Vec3;
  field_of_view: number;
  orthographic_height: number | null;
};

/** A light with the numbers of all kinds; angles in degrees. The page names those that it computes. */
export type Light = {
  kind: string;
  position: Vec3;
  azimuth: number;
  elevation: number;
  color: Vec3;
  intensity: number;
  angle: number;
  softness: number;
  [number: string]: string | number | number[];
};

/** The state of a scene: `state_of`. Choices that only programs and menus use have no type here. */
export type SceneState = {
  technique: string;
  shape: string;
  projection: Projection;
  heights: Heights;
  edge: "wrap" | "clamp" | "clip";
  alpha: string;
  surface: string;
  shadows: string;
  shading_model: string;
  occlusion_kind: string;
  fog_mode: string;
  [choice: string]: unknown;
  scale: number;
  reference_height: number;
  bias: number;
  fades: boolean;
  fade: Pair;
  tiling: Pair;
  shift: Pair;
  opening: number | null;
  apart: boolean;
  tilings: { [map: string]: Tiling };
  layer: boolean;
  layer_tiling: Tiling;
  settings: { [technique: string]: Values };
  surface_parameters: { [surface: string]: Values };
  smoothing: Values;
  shading: Values;
  shadowing: Values;
  fog: Values & { fog_start: number; fog_end: number };
  background: Vec3;
  lights: Light[];
  camera: Orbit;
};

// --- what can be set

/** A setting of a record; an end of its range is null where the range is open. */
export type Setting = {
  name: string;
  doc: string;
  low: number | null;
  high: number | null;
  default: number | number[];
  whole: boolean;
};

/** The control of a setting outside records: `soft` where numbers beyond the slider are allowed. */
export type Control = {
  kind: "choice" | "number" | "pair" | "triple";
  group: string;
  doc: string;
  low: number | null;
  high: number | null;
  step?: number;
  soft: boolean;
};

export type Controls = { [name: string]: Control };

export type Technique = {
  doc: string;
  commandName: string;
  reference_height: number;
  projection: Projection;
  mostReads: number;
  bake: string | null;
  columns: boolean;
  exact: boolean;
  heights: Heights[];
  settings: Setting[];
};

/** The placement of a shape and how far it reaches: the ball around it, the corners of its hull. */
export type ShapeData = {
  origin: Vec3;
  to_object: number[];
  tiling: Pair;
  flat: boolean;
  lying: boolean; // flat on the ground
  radius: number;
  outline: Vec3[];
  world: number[][] | null;
  placement: { stretch?: string; turn?: string } | null; // the same as options, if they suffice
};

/** A preset as a state, or the reason why the page cannot draw it. */
export type Preset = {
  about: string;
  state?: SceneState;
  shapes?: { [shape: string]: object }; // what differs on a shape
  why?: string;
};

export type Menus = { heights: Heights[]; [choice: string]: string[] };

export type Limits = {
  numbers: { [name: string]: Pair };
  lights: { [name: string]: Pair };
  camera: { [name: string]: Pair };
  least: number;
  most: number;
};

// --- maps

/** A map that a picture can be used as; "packed" is several in one. */
export type Slot = string;

/** Which of the page's pictures holds it, in which channels, and whether as light. */
export type Slots = { [slot: Slot]: { texture: string; channels: number[]; light: boolean } };

export type Green = "gl" | "dx";

/** The slot, "" for none, and whether the values are inverted. */
export type Meaning = [slot: Slot | "", inverted: boolean];

/** Tables for reading file names: `material.conventions`. */
export type Names = {
  meanings: { [words: string]: Meaning | undefined };
  unreal: { [letter: string]: string | undefined };
  green: { [word: string]: Green };
  inverted: string[];
  formats: string[];
  resolutions: string[];
  longest: number;
  word: string;
  sizes: string;
};

/** A channel of a packed map: a constant, a copy of an earlier one, or differences. */
export type PackedChannel = { constant?: number; palette?: number[]; same?: number };

export type PackedMap = { width: number; height: number; channels: PackedChannel[] };

// --- programs

/** A static condition: a field and the values for which it holds, or conditions put together. */
export type Condition =
  | [field: string, values: unknown[]]
  | ["not", Condition]
  | ["and" | "or", Condition, Condition];

/** `access` is WebGPU's type of the buffer, sampler or samples. */
export type Binding = { name: string; type: string } & (
  | { kind: "map"; access: GPUTextureSampleType }
  | { kind: "sampler"; access: GPUSamplerBindingType }
  | { kind: "run" | "planes" | "uniform" | "buffer"; access: GPUBufferBindingType }
);

export type Programs = {
  pieces: { [name: string]: string };
  slots: { [slot: string]: { [bound: string]: string } };
  entries: { [entry: string]: string };
  conditions: Condition[];
  bindings: { [entry: string]: Binding[] };
  bound: { [menu: string]: { [chosen: string]: { [slot: string]: string } } };
  maps: string[];
  group: Pair;
  run: ("width" | "first_row" | "last_row" | "plane_row" | "plane_stride")[];
  formats: { [map in "HeightField" | "Texture"]: [texels: GPUTextureFormat, texelBytes: number] };
};

/** Sizes and offsets in words of four bytes. */
export type Layout = {
  words: number;
  align: number;
  fields: [name: string, type: string, offset: number][];
  scalars?: number[];
};

export type Layouts = { [record: string]: Layout };

// --- bakes

export type Sector = { record: { [direction: string]: Pair }; ends: [Pair, Pair] };

export type BakeNumbers = {
  bounds: {
    block: number;
    reach: number;
    farBlock: number;
    farReach: number;
    farWindows: [window: string, width: number][];
  };
  cones: { blocks: number; sectors: Sector[] };
};

// --- the page

export type DebugColors = { heat: Vec3[]; short: Vec3; passed: Vec3 };

export type Data = {
  programs: Programs;
  records: Layouts;
  name: string;
  version: string;
  source: string;
  reading: { [option: string]: string | number | boolean };
  lengths: string[]; // options of reading that a scale replaces
  layerSource: string;
  omitted: string[]; // what the sources do not say about the materials
  relative: string[]; // the sources that are relative paths
  scaledTo: Pair | null;
  hasHeights: boolean;
  mapSources: { [slot: Slot]: string | undefined };
  slots: Slots;
  bakes: BakeNumbers;
  menus: Menus;
  techniques: { [technique: string]: Technique };
  shapes: { [shape: string]: ShapeData };
  settings: {
    surface_parameters: { [surface: string]: Setting[] };
    shading: Setting[];
    shadowing: Setting[];
    smoothing: Setting[];
    fog: Setting[];
  };
  controls: {
    scene: Controls;
    tiling: Controls;
    camera: Controls;
    lights: Controls;
    scroll: Controls;
  };
  constants: {
    proportion: number;
    layer: boolean;
    layerProportion: number;
    glow: number;
    dust_strength: number;
    hole_softness: number;
  };
  filled: number;
  samples: Pair[];
  state: SceneState;
  defaults: {
    options: { [name: string]: string | number };
    hole_scale: number;
    background: Vec3;
    lights: Light[];
    camera: Orbit;
  };
  colors: DebugColors;
  presets: { [preset: string]: Preset };
  shows: Show[];
  lightKinds: { [kind: string]: string[] }; // the numbers that make a light
  limits: Limits;
  names: Names;
  maps: { [map: string]: PackedMap };
};
