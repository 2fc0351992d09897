// Show the viewer in place of a still picture, where the browser draws with WebGPU.

navigator.gpu?.requestAdapter().then((adapter) => {
  if (!adapter) return;
  for (const figure of document.querySelectorAll("figure.live")) {
    const frame = figure.querySelector("iframe");
    frame.src = frame.dataset.src;
    frame.hidden = false;
    figure.querySelector("img").hidden = true;
  }
});
