// A page embedded in another one, as in a notebook's widget: both exchange their settings.
//
// The page sends {basrelief: "ready", state} once it listens, and {basrelief: "state", state} after
// changes; it receives {basrelief: "state", state}, which may be partial.

import { copyOf } from "view/checks.js";

/** @import { ViewerPage } from "view/main.js" */
/** @import { State } from "view/state.js" */

/**
 * A message from a page to its parent window.
 * @typedef {{ basrelief: "ready" | "state", state: State }} PageMessage
 */

const APART = 60; // milliseconds between messages while a slider moves

export class Host {
  /** @param {ViewerPage} view */
  static around(view) {
    return window.parent === window ? null : new Host(view);
  }

  /** @param {ViewerPage} view */
  constructor(view) {
    this.view = view;
    this.waiting = false;
    this.sentAt = -Infinity;
    document.body.classList.add("within");
  }

  open() {
    addEventListener("message", ({ source, data }) => {
      if (source === window.parent && data?.basrelief === "state") this.view.apply(data.state);
    });
    this.send("ready");
  }

  // Send the state; of quick changes the last one is always sent.
  notify() {
    if (this.waiting) return;
    this.waiting = true;
    const left = this.sentAt + APART - performance.now();
    setTimeout(
      () => {
        this.waiting = false;
        this.sentAt = performance.now();
        this.send("state");
      },
      Math.max(0, left),
    );
  }

  /** @param {PageMessage["basrelief"]} what */
  send(what) {
    // the origin of the parent is unknown, and settings are not secret
    /** @type {PageMessage} */
    const message = { basrelief: what, state: copyOf(this.view.state) };
    window.parent.postMessage(message, "*");
  }

  /**
   * Whether an element has the focus, and not the page around.
   * @param {Element} element
   */
  focused(element) {
    return document.hasFocus() && document.activeElement === element;
  }
}
