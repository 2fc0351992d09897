// The viewer's page as a notebook's widget: an iframe, synchronised with the widget's model.
//
// Settings that page and model have by the same name are kept equal. Each side receives only values
// that it does not have, so that no change is echoed.

/** @typedef {{ [name: string]: unknown }} Settings */
/**
 * A message from the page.
 * @typedef {{ basrelief: "ready" | "state", state: Settings }} Message
 */
/**
 * The model of the widget, as anywidget provides it.
 * @typedef {object} Model
 * @property {(name: string) => unknown} get
 * @property {(name: string, value: unknown) => void} set
 * @property {(event: string, act: () => void) => void} on
 * @property {(event: string, act: () => void) => void} off
 * @property {() => void} save_changes
 */

const TOGETHER = 20; // milliseconds within which settings from Python are one change
// the page's name for a setting where the model has another
/** @type {{ [name: string]: string | undefined }} */
const MODEL_NAMES = { settings: "settings_of", surface_parameters: "all_surface_parameters" };

/** @type {(name: string) => string} */
const nameOf = (name) => MODEL_NAMES[name] ?? name;
/** @type {(a: unknown, b: unknown) => boolean} */
const same = (a, b) =>
  a === b ||
  (bothObjects(a, b) && sameParts(/** @type {Settings} */ (a), /** @type {Settings} */ (b)));
/** @type {(a: unknown, b: unknown) => boolean} */
const bothObjects = (a, b) => [a, b].every((x) => x !== null && typeof x === "object");
/**
 * @param {Settings} a
 * @param {Settings} b
 */
function sameParts(a, b) {
  const names = Object.keys(a);
  return names.length === Object.keys(b).length && names.every((name) => same(a[name], b[name]));
}

/**
 * @param {{ model: Model, el: HTMLElement }} widget
 * @returns {() => void} the cleanup
 */
function render({ model, el }) {
  const frame = document.createElement("iframe");
  frame.title = "basrelief viewer";
  frame.allow = "clipboard-write; fullscreen";
  frame.style.cssText =
    "display: block; box-sizing: border-box; width: 100%; border: 1px solid #8884; border-radius: 6px;";
  const fit = () => {
    frame.style.height = `${model.get("height")}px`;
  };
  fit();
  const address = URL.createObjectURL(
    new Blob([/** @type {BlobPart} */ (model.get("_page"))], { type: "text/html" }),
  );
  frame.src = address;

  /** @type {Settings | null} */
  let known = null; // the last settings that the page sent or received; null until it listens
  /** @type {number | undefined} */
  let telling;
  const tell = () => {
    if (!known) return;
    /** @type {Settings} */
    const news = {};
    for (const name of Object.keys(known)) {
      const value = model.get(nameOf(name));
      if (!same(value, known[name])) news[name] = known[name] = value;
    }
    if (Object.keys(news).length) {
      frame.contentWindow?.postMessage({ basrelief: "state", state: news }, "*");
    }
  };
  /** @type {(event: MessageEvent<Message | null>) => void} */
  const hear = ({ source, data }) => {
    if (!source || source !== frame.contentWindow || !data?.basrelief) return;
    if (data.basrelief === "ready") {
      const shared = Object.entries(data.state).filter(
        ([name]) => model.get(nameOf(name)) !== undefined,
      );
      // an iframe that a notebook moves reloads its page: listeners exist already
      const first = known === null;
      known = Object.fromEntries(shared);
      if (first) for (const name of Object.keys(known)) model.on(`change:${nameOf(name)}`, changed);
      tell();
      return;
    }
    if (!known) return;
    for (const name of Object.keys(known)) {
      if (same(data.state[name], known[name])) continue;
      known[name] = data.state[name];
      if (!same(known[name], model.get(nameOf(name)))) model.set(nameOf(name), known[name]);
    }
    model.save_changes();
  };
  const changed = () => {
    clearTimeout(telling);
    telling = setTimeout(tell, TOGETHER);
  };
  window.addEventListener("message", hear);
  model.on("change:height", fit);
  el.append(frame);
  const unwatch = followScheme(frame);
  return () => {
    clearTimeout(telling);
    unwatch();
    window.removeEventListener("message", hear);
    for (const name of Object.keys(known ?? {})) model.off(`change:${nameOf(name)}`, changed);
    model.off("change:height", fit);
    URL.revokeObjectURL(address);
    frame.remove();
  };
}

// --- light and dark ------------------------------------------------------------------------------

/**
 * Set the colour scheme of the iframe, which its page follows, by the background behind it.
 * @param {HTMLElement} frame
 */
function followScheme(frame) {
  const follow = () => {
    if (frame.isConnected) frame.style.colorScheme = darkBehind(frame) ? "dark" : "light";
  };
  const watcher = new MutationObserver(follow);
  for (const node of [document.documentElement, document.body]) {
    watcher.observe(node, { attributes: true });
  }
  frame.addEventListener("load", follow);
  return () => watcher.disconnect();
}

/** @param {Element} element */
function darkBehind(element) {
  /** @type {Element | null} */
  let at = element;
  for (; at; at = parentOf(at)) {
    const [r, g, b, alpha] = bytesOf(getComputedStyle(at).backgroundColor);
    if (alpha > 127) return 0.2126 * r + 0.7152 * g + 0.0722 * b < 128;
  }
  return matchMedia("(prefers-color-scheme: dark)").matches;
}

/**
 * Out of a shadow tree, too.
 * @param {Element} element
 * @returns {Element | null}
 */
function parentOf(element) {
  const root = element.getRootNode();
  return element.parentElement ?? (root instanceof ShadowRoot ? root.host : null);
}

// Styles write colours in many ways, and a canvas reads them all.
const probe = /** @type {CanvasRenderingContext2D} */ (
  document.createElement("canvas").getContext("2d", { willReadFrequently: true })
);
/** @param {string} color */
function bytesOf(color) {
  probe.clearRect(0, 0, 1, 1);
  probe.fillStyle = color;
  probe.fillRect(0, 0, 1, 1);
  return probe.getImageData(0, 0, 1, 1).data;
}

export default { render };
