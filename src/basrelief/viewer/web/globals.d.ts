// Additions to the types of the browser.

import type { ViewerPage } from "view/main.js";

declare global {
  interface Window {
    /** The page, for tests and the console. */
    viewer: ViewerPage;
  }

  interface Array<T> {
    /** `map` of a tuple is a tuple of the same length. */
    map<U>(act: (value: T, index: number, array: T[]) => U): { [K in keyof this]: U };
  }
}
