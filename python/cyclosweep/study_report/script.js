// Link the points of the front with its rows, sort the rows, and walk through them by keyboard.
"use strict";
const table = document.querySelector("table.front");
const said = document.querySelector(".chosen-row");
if (table) {
  const body = table.tBodies[0];
  const heads = Array.from(table.tHead.rows[0].cells);
  const rows = () => Array.from(body.rows);
  const dots = new Map();
  for (const dot of document.querySelectorAll(".dot")) {
    dots.set(dot.dataset.variant, dot);
    dot.addEventListener("click", () => choose(dot.dataset.variant, false));
  }
  function choose(variant, focus) {
    for (const row of rows()) {
      const on = row.dataset.variant === variant;
      row.classList.toggle("on", on);
      row.tabIndex = on ? 0 : -1;
      if (on) {
        if (focus) row.focus();
        row.scrollIntoView({ block: "nearest", inline: "nearest" });
        if (said) {
          said.textContent = Array.from(row.cells)
            .map((cell, place) => heads[place].innerText.trim() + " " + cell.textContent)
            .join(" · ");
        }
      }
    }
    for (const [name, dot] of dots) dot.classList.toggle("on", name === variant);
    const dot = dots.get(variant);
    if (dot) dot.parentNode.append(dot);
  }
  body.addEventListener("click", (event) => {
    const row = event.target.closest("tr");
    if (row) choose(row.dataset.variant, true);
  });
  table.parentNode.addEventListener("keydown", (event) => {
    const step = { ArrowDown: 1, ArrowUp: -1, Home: -Infinity, End: Infinity }[event.key];
    if (step === undefined || event.target.closest("button")) return;
    event.preventDefault();
    const all = rows();
    const at = all.findIndex((row) => row.classList.contains("on"));
    const next = Math.min(Math.max(at + step, 0), all.length - 1);
    choose(all[next].dataset.variant, true);
  });
  heads.forEach((head, place) => {
    head.querySelector("button").addEventListener("click", () => {
      const down = head.getAttribute("aria-sort") === "ascending";
      for (const other of heads) other.removeAttribute("aria-sort");
      head.setAttribute("aria-sort", down ? "descending" : "ascending");
      const key = (row) => Number(row.cells[place].dataset.value);
      const sorted = rows().sort((a, b) => (down ? key(b) - key(a) : key(a) - key(b)));
      body.append(...sorted);
    });
  });
  if (body.rows.length) body.rows[0].tabIndex = 0;
}
window.addEventListener("beforeprint", () => {
  for (const part of document.querySelectorAll("details")) part.open = true;
});
document.documentElement.dataset.ready = "yes";
