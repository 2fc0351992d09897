// Cameras as in `scene.cameras` and `scene.views`, with the same order of operations.

/** @import { Orbit, Pair, Vec3 } from "view/data" */

/** @typedef {Orbit & { distance: number }} PlacedOrbit */
/**
 * A camera as programs take it: `cameras.Camera`.
 * @typedef {{ position: Vec3, corner: Vec3, right: Vec3, down: Vec3, forward: Vec3,
 *   perspective: number }} CameraRecord
 */

/** @type {(degrees: number) => number} */
const radians = (degrees) => degrees * (Math.PI / 180);
/** @type {(a: Vec3, b: Vec3) => Vec3} */
const add = (a, b) => a.map((x, k) => x + b[k]);
/** @type {(a: Vec3, b: Vec3) => Vec3} */
const subtract = (a, b) => a.map((x, k) => x - b[k]);
/** @type {(a: Vec3, s: number) => Vec3} */
const times = (a, s) => a.map((x) => x * s);
/** @type {(a: Vec3, b: Vec3) => number} */
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
/** @type {(a: Vec3, b: Vec3) => Vec3} */
const cross = (a, b) => [
  a[1] * b[2] - a[2] * b[1],
  a[2] * b[0] - a[0] * b[2],
  a[0] * b[1] - a[1] * b[0],
];
/** @type {(a: Vec3) => Vec3} */
const unit = (a) => times(a, 1 / Math.sqrt(dot(a, a)));

/**
 * The camera `distance` from `target`; angles in degrees, azimuth 0 looks from +z.
 * @param {PlacedOrbit} camera
 * @param {Pair} size
 * @returns {CameraRecord}
 */
export function orbit(camera, size) {
  const around = radians(camera.azimuth);
  const above = radians(camera.elevation);
  /** @type {Vec3} */
  const level = [Math.sin(around), 0, Math.cos(around)];
  /** @type {Vec3} */
  const y = [0, 1, 0];
  const away = add(times(level, Math.cos(above)), times(y, Math.sin(above)));
  const up = subtract(times(y, Math.cos(above)), times(level, Math.sin(above)));
  return look(add(camera.target, times(away, camera.distance)), camera.target, up, camera, size);
}

/**
 * @param {Vec3} position
 * @param {Vec3} target
 * @param {Vec3} up
 * @param {Orbit} lens
 * @param {Pair} size
 */
function look(position, target, up, lens, [width, height]) {
  const forward = unit(subtract(target, position));
  const right = unit(cross(forward, unit(up)));
  const down = cross(forward, right);
  const { orthographic_height, field_of_view } = lens;
  const parallel = orthographic_height !== null;
  const half = parallel ? orthographic_height / 2 : Math.tan(radians(field_of_view) / 2);
  const pixel = (2 * half) / height;
  const corner = times(add(times(right, width), times(down, height)), -pixel / 2);
  return {
    position,
    corner: parallel ? corner : add(corner, forward),
    right: times(right, pixel),
    down: times(down, pixel),
    forward,
    perspective: parallel ? 0 : 1,
  };
}

/**
 * The distance from which all points are visible and fill a share of the picture.
 * @param {Orbit} camera
 * @param {Vec3[]} points
 * @param {Pair} size
 * @param {number} filled
 */
export function framing(camera, points, size, filled) {
  const near = orbit({ ...camera, distance: 1 }, size);
  let needed = -Infinity;
  for (const point of points) {
    const offset = subtract(point, camera.target);
    const closer = -dot(offset, near.forward);
    if (camera.orthographic_height !== null) {
      needed = Math.max(needed, closer + 1);
      continue;
    }
    [near.right, near.down].forEach((axis, k) => {
      const half = (size[k] * filled) / 2;
      needed = Math.max(needed, closer + Math.abs(dot(offset, axis)) / dot(axis, axis) / half);
    });
  }
  return needed;
}

/**
 * The height of an orthographic view in which all points are visible and fill a share of it.
 * @param {Orbit} camera
 * @param {Vec3[]} points
 * @param {Pair} size
 * @param {number} filled
 */
export function framingHeight(camera, points, size, filled) {
  const { right, down } = orbit({ ...camera, distance: 1 }, size);
  const [across, along] = [right, down].map((axis) =>
    Math.max(...points.map((point) => Math.abs(dot(subtract(point, camera.target), unit(axis))))),
  );
  return (2 / filled) * Math.max(along, (across * size[1]) / size[0]);
}

/**
 * The direction of light from an azimuth and elevation, as in `scene.lights.directional`.
 * @param {number} azimuth
 * @param {number} elevation
 */
export function travelling(azimuth, elevation) {
  const [around, above] = [radians(azimuth), radians(elevation)];
  const c = Math.cos(above);
  return unit([-Math.sin(around) * c, -Math.sin(above), -Math.cos(around) * c]);
}

/**
 * The world directions that are right and up in the picture, for moving the target.
 * @param {PlacedOrbit} camera
 * @param {Pair} size
 */
export function across(camera, size) {
  const made = orbit(camera, size);
  return { right: unit(made.right), up: times(unit(made.down), -1) };
}
