// Input outside the panel: mouse, touch, keys on the picture, dropped files.

import { byId } from "view/controls.js";

/** @import { Pair, Slot } from "view/data" */
/** @import { ViewerPage } from "view/main.js" */

const ZOOM = 1.12; // times nearer by a key
const TURN = 0.4; // degrees a pixel
/** @type {{ [key: string]: Pair }} */
const ARROWS = {
  ArrowLeft: [-1, 0],
  ArrowRight: [1, 0],
  ArrowUp: [0, 1],
  ArrowDown: [0, -1],
};

/** @param {ViewerPage} view */
export function listen(view) {
  listenToPointers(view);
  listenToWheel(view);
  view.canvas.addEventListener("keydown", (event) => key(view, event));
  listenToDivider(view);
  listenToDrops(view);
  addEventListener("hashchange", () => {
    view.readHash();
    view.changed(true);
    view.hashesRead += 1;
  });
  new ResizeObserver(() => view.fit()).observe(byId("picture"));
}

/**
 * One finger or button orbits; Shift or the other buttons pan, Alt or Ctrl turn the light; two fingers
 * pan and zoom.
 * @param {ViewerPage} view
 */
function listenToPointers(view) {
  const { canvas } = view;
  /** @type {Map<number, Pair>} */
  const pointers = new Map();
  let apart = 0;
  canvas.addEventListener("pointerdown", (event) => {
    canvas.setPointerCapture(event.pointerId);
    pointers.set(event.pointerId, [event.clientX, event.clientY]);
    apart = 0;
    canvas.focus({ preventScroll: true });
  });
  canvas.addEventListener("pointermove", (event) => {
    const last = pointers.get(event.pointerId);
    if (!last) return;
    /** @type {Pair} */
    const move = [event.clientX - last[0], event.clientY - last[1]];
    pointers.set(event.pointerId, [event.clientX, event.clientY]);
    if (pointers.size === 2) {
      const [[ax, ay], [bx, by]] = [...pointers.values()];
      const now = Math.hypot(ax - bx, ay - by);
      if (apart) view.zoom(apart / Math.max(now, 1));
      apart = now;
      view.pan(move[0] / 2, move[1] / 2);
    } else if (event.altKey || event.ctrlKey) {
      view.turnLight(move[0] * TURN, -move[1] * TURN);
    } else if (event.shiftKey || event.buttons & 6) {
      view.pan(...move);
    } else {
      view.turn(-move[0] * TURN, move[1] * TURN);
    }
  });
  for (const name of /** @type {const} */ (["pointerup", "pointercancel"])) {
    canvas.addEventListener(name, (event) => pointers.delete(event.pointerId));
  }
  canvas.addEventListener("contextmenu", (event) => event.preventDefault());
}

/** @param {ViewerPage} view */
function listenToWheel(view) {
  view.canvas.addEventListener(
    "wheel",
    (event) => {
      // in a notebook the wheel scrolls until the picture is clicked
      if (view.host && !view.host.focused(view.canvas)) return;
      event.preventDefault();
      view.zoom(Math.exp(Math.max(-100, Math.min(100, event.deltaY)) * 0.0015));
    },
    { passive: false },
  );
}

/**
 * @param {ViewerPage} view
 * @param {KeyboardEvent} event
 */
function key(view, event) {
  const arrow = ARROWS[event.key];
  if (event.ctrlKey || event.altKey || event.metaKey) return;
  if (arrow && event.shiftKey) view.pan(-arrow[0] * 20, arrow[1] * 20);
  else if (arrow) view.turn(arrow[0] * 4, arrow[1] * 4);
  else if (event.key === "+" || event.key === "=") view.zoom(1 / ZOOM);
  else if (event.key === "-") view.zoom(ZOOM);
  else if (event.key === "0") view.frame();
  else return;
  event.preventDefault();
}

/** @param {ViewerPage} view */
function listenToDivider(view) {
  const slider = /** @type {HTMLInputElement} */ (byId("divider"));
  slider.addEventListener("input", () => view.divide(Number(slider.value)));
  const line = byId("line");
  line.addEventListener("pointerdown", (event) => line.setPointerCapture(event.pointerId));
  line.addEventListener("pointermove", (event) => {
    if (!line.hasPointerCapture(event.pointerId)) return;
    const { left, width } = view.canvas.getBoundingClientRect();
    view.divide((event.clientX - left) / width);
  });
}

/**
 * A file dropped on a map of the panel replaces it; elsewhere the name selects the map.
 * @param {ViewerPage} view
 */
function listenToDrops(view) {
  // a map takes one picture; the target may be a text node in its row
  /** @type {(event: DragEvent) => HTMLElement | null} */
  const under = ({ target, dataTransfer }) => {
    if (dataTransfer?.items.length !== 1 || !(target instanceof Node)) return null;
    const element = target instanceof Element ? target : target.parentElement;
    return element?.closest("#panel .map") ?? null;
  };
  /** @type {(event: DragEvent) => boolean} */
  const hasFiles = ({ dataTransfer }) => dataTransfer?.types.includes("Files") ?? false;
  /** @type {(row: HTMLElement | null) => void} */
  const mark = (row) => {
    for (const each of document.querySelectorAll("#panel .map.over")) each.classList.remove("over");
    row?.classList.add("over");
  };
  const done = () => {
    document.body.classList.remove("dropping");
    mark(null);
  };
  for (const name of /** @type {const} */ (["dragenter", "dragover"])) {
    document.addEventListener(name, (event) => {
      if (!hasFiles(event)) return;
      event.preventDefault();
      document.body.classList.add("dropping");
      mark(under(event));
    });
  }
  document.addEventListener("dragleave", (event) => {
    // leaving an element for another one is not leaving the page
    if (!event.relatedTarget) done();
  });
  document.addEventListener("drop", (event) => {
    if (!hasFiles(event)) return;
    event.preventDefault();
    done();
    const slot = /** @type {Slot | undefined} */ (under(event)?.dataset.slot);
    view.takeMaps([...(event.dataTransfer?.files ?? [])], slot);
  });
}
