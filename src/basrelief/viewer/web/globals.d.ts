// Additions to the types of the browser.

import type { View } from "view/main.js";

declare global {
  interface Window {
    /** The view, for tests and for the console. */
    viewer: View;
  }

  interface Array<T> {
    /** `map` of a tuple is a tuple of the same length. */
    map<U>(act: (value: T, index: number, array: T[]) => U): { [K in keyof this]: U };
  }
}
