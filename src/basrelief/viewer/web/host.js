// A page within another one, as in a notebook's widget: each tells the other what is set.
//
// The page says {basrelief: "ready", state} once it listens, and {basrelief: "state", state} after
// changes; it hears {basrelief: "state", state}, which may be a part of one.

import { copyOf } from "view/checks.js";

/** @import { View } from "view/main.js" */
/** @import { State } from "view/state.js" */

/**
 * A message from a page to its parent window.
 * @typedef {{ basrelief: "ready" | "state", state: State }} PageMessage
 */

const APART = 60; // milliseconds between what is told, for sliders on the move

export class Host {
  /** @param {View} view */
  static around(view) {
    return window.parent === window ? null : new Host(view);
  }

  /** @param {View} view */
  constructor(view) {
    this.view = view;
    this.waiting = false;
    this.toldAt = -Infinity;
    document.body.classList.add("within");
  }

  open() {
    addEventListener("message", ({ source, data }) => {
      if (source === window.parent && data?.basrelief === "state") this.view.take(data.state);
    });
    this.send("ready");
  }

  // The last of quick changes is always told.
  tell() {
    if (this.waiting) return;
    this.waiting = true;
    const left = this.toldAt + APART - performance.now();
    setTimeout(
      () => {
        this.waiting = false;
        this.toldAt = performance.now();
        this.send("state");
      },
      Math.max(0, left),
    );
  }

  /** @param {PageMessage["basrelief"]} what */
  send(what) {
    // where the page around is served from is not for this one to know, and the settings no secret
    /** @type {PageMessage} */
    const message = { basrelief: what, state: copyOf(this.view.state) };
    window.parent.postMessage(message, "*");
  }

  /**
   * Whether a person is at an element, and not somewhere in the page around.
   * @param {Element} element
   */
  focused(element) {
    return document.hasFocus() && document.activeElement === element;
  }
}
