// Read coordinates under the pointer, and hide or show a series by its legend entry.
"use strict";
for (const figure of document.querySelectorAll("figure")) {
  for (const key of figure.querySelectorAll(".key")) {
    key.addEventListener("click", () => {
      const off = key.classList.toggle("off");
      for (const part of figure.querySelectorAll("." + key.dataset.for)) {
        part.style.display = off ? "none" : "";
      }
    });
  }
  for (const hit of figure.querySelectorAll(".hit")) {
    const at = hit.nextElementSibling;
    const xs = hit.dataset.x.split(" ").map(Number);
    const ys = hit.dataset.y.split(" ").map(Number);
    hit.addEventListener("pointermove", (event) => {
      const box = hit.getBoundingClientRect();
      const u = (event.clientX - box.left) / box.width;
      const v = (event.clientY - box.top) / box.height;
      const x = xs[0] + u * (xs[1] - xs[0]);
      const y = ys[1] + v * (ys[0] - ys[1]);
      at.textContent = x.toPrecision(4) + "  |  " + y.toPrecision(4);
    });
    hit.addEventListener("pointerleave", () => { at.textContent = ""; });
  }
}
document.documentElement.dataset.ready = "yes";
