"use strict";
document.documentElement.classList.add("js");

// Values under the pointer, or stepped through by the arrow keys.
for (const figure of document.querySelectorAll(".chart")) {
  const svg = figure.querySelector(":scope > svg");
  const cursor = svg.querySelector(".cursor");
  const read = figure.querySelector(".read");
  const data = JSON.parse(figure.querySelector("script").textContent);
  const first = data.x[0];
  const range = data.x[data.x.length - 1] - first;
  const gap = data.xUnit === "°" ? "" : " ";
  const hint = "Point at the curve, or use the arrow keys, to read values.";
  let row = 0;

  function show(k) {
    row = Math.max(0, Math.min(data.x.length - 1, k));
    const at = data.left + ((data.x[row] - first) / range) * data.width;
    cursor.setAttribute("x1", at);
    cursor.setAttribute("x2", at);
    const values = data.curves.map((c) => `${c.name} ${c.values[row]} ${data.unit}`);
    read.textContent = [`${data.xName} ${data.x[row]}${gap}${data.xUnit}`, ...values].join("; ");
  }

  function nearest(event) {
    const box = svg.getBoundingClientRect();
    const inPicture = ((event.clientX - box.left) / box.width) * svg.viewBox.baseVal.width;
    const wanted = first + ((inPicture - data.left) / data.width) * range;
    let low = 0;
    let high = data.x.length - 1;
    while (high - low > 1) {
      const middle = (low + high) >> 1;
      if (data.x[middle] > wanted) high = middle;
      else low = middle;
    }
    return wanted - data.x[low] < data.x[high] - wanted ? low : high;
  }

  function clear() {
    cursor.setAttribute("x1", -9);
    cursor.setAttribute("x2", -9);
    read.textContent = hint;
  }

  clear();
  svg.addEventListener("pointermove", (event) => show(nearest(event)));
  svg.addEventListener("pointerdown", (event) => show(nearest(event)));
  svg.addEventListener("pointerleave", clear);
  svg.addEventListener("keydown", (event) => {
    const step = { ArrowRight: 1, ArrowLeft: -1, PageUp: 20, PageDown: -20 }[event.key];
    if (step === undefined) return;
    event.preventDefault();
    show(row + step);
  });
}

// The snapshots one at a time, turned by a slider.
for (const figure of document.querySelectorAll(".slides")) {
  const images = figure.querySelectorAll("img");
  const slider = figure.querySelector("input");
  const label = figure.querySelector("output");

  function turn() {
    const k = Number(slider.value);
    images.forEach((image, i) => image.classList.toggle("now", i === k));
    label.textContent = `${k + 1} of ${images.length}`;
  }

  slider.addEventListener("input", turn);
  turn();
}
