// Scrolling of all maps over the shape while you look, as `scene.motion.Scrolling` does in a film.

import { copyOf } from "view/checks.js";

/** @import { Tiling } from "view/data" */
/** @import { ViewerPage } from "view/main.js" */
/** @import { State } from "view/state.js" */

const LONGEST = 0.1; // seconds of a step, so that nothing jumps after a pause of the browser

export class Scroll {
  /** @param {ViewerPage} view */
  constructor(view) {
    this.view = view;
    this.requested = false;
    /** @type {number | null} */
    this.last = null; // milliseconds of the step before, null at rest
  }

  // Scroll from the next frame of the browser on, until the state has no speed.
  wake() {
    if (this.requested || !this.view.state.scroll.some(Boolean)) return;
    this.requested = true;
    requestAnimationFrame((now) => {
      this.requested = false;
      this.step(now);
      if (!this.requested) this.last = null;
    });
  }

  /** @param {number} now in milliseconds */
  step(now) {
    const { state, shows, drawing } = this.view;
    if (!state.scroll.some(Boolean)) return;
    // what a lost device does not draw is not scrolled by
    if (this.last !== null && !drawing.paused) {
      scrolled(state, Math.min(LONGEST, (now - this.last) / 1000));
      for (const show of shows) show();
      drawing.show(copyOf(state));
    }
    this.last = now;
    this.wake();
  }
}

/**
 * Shift all maps by their speed during some seconds, as `Object.scrolled` does. Whole tiles change
 * nothing where the maps repeat, and are dropped.
 * @param {State} state
 * @param {number} seconds
 */
export function scrolled(state, seconds) {
  /** @type {(tiling: Tiling) => Tiling["shift"]} */
  const shifted = ({ tiles, shift }) => {
    const [u, v] = shift.map((x, k) => x + tiles[k] * state.scroll[k] * seconds);
    return state.edge === "wrap" ? [u % 1, v % 1] : [u, v];
  };
  state.shift = shifted({ tiles: state.tiling, shift: state.shift });
  for (const each of [...Object.values(state.tilings), state.layer_tiling]) {
    each.shift = shifted(each);
  }
}
