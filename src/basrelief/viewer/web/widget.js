// The viewer's page as a notebook's widget: a frame, and what its two sides tell each other.
//
// What the page and the model both have by the same name is kept the same. Each side is told only
// what it does not know yet, so that nothing goes round.

const TOGETHER = 20; // milliseconds: settings that follow one another from Python are one change
// the page's name for a setting where the model has another
const MODEL_NAMES = { settings: "settings_of", finish: "finish_of" };

const nameOf = (name) => MODEL_NAMES[name] ?? name;
const same = (a, b) => a === b || (bothObjects(a, b) && sameParts(a, b));
const bothObjects = (a, b) => [a, b].every((x) => x !== null && typeof x === "object");
function sameParts(a, b) {
  const names = Object.keys(a);
  return names.length === Object.keys(b).length && names.every((name) => same(a[name], b[name]));
}

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
  const address = URL.createObjectURL(new Blob([model.get("_page")], { type: "text/html" }));
  frame.src = address;

  let known = null; // the page's settings as it has said or heard them last; null until it listens
  let telling;
  const tell = () => {
    if (!known) return;
    const news = {};
    for (const name of Object.keys(known)) {
      const value = model.get(nameOf(name));
      if (!same(value, known[name])) news[name] = known[name] = value;
    }
    if (Object.keys(news).length) {
      frame.contentWindow?.postMessage({ basrelief: "state", state: news }, "*");
    }
  };
  const hear = ({ source, data }) => {
    if (!source || source !== frame.contentWindow || !data?.basrelief) return;
    if (data.basrelief === "ready") {
      const shared = ([name]) => model.get(nameOf(name)) !== undefined;
      // a frame that a notebook moves loads its page anew: that listens already
      const first = known === null;
      known = Object.fromEntries(Object.entries(data.state).filter(shared));
      if (first) for (const name of Object.keys(known)) model.on(`change:${nameOf(name)}`, changed);
      tell();
      return;
    }
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

// The page within follows the colour scheme of its frame, which is that of what is behind it.
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

function darkBehind(element) {
  for (let at = element; at; at = at.parentElement ?? at.getRootNode().host) {
    const [r, g, b, alpha] = bytesOf(getComputedStyle(at).backgroundColor);
    if (alpha > 127) return 0.2126 * r + 0.7152 * g + 0.0722 * b < 128;
  }
  return matchMedia("(prefers-color-scheme: dark)").matches;
}

// Styles write colours in many ways, and a canvas reads them all.
const probe = document.createElement("canvas").getContext("2d", { willReadFrequently: true });
function bytesOf(color) {
  probe.clearRect(0, 0, 1, 1);
  probe.fillStyle = color;
  probe.fillRect(0, 0, 1, 1);
  return probe.getImageData(0, 0, 1, 1).data;
}

export default { render };
