"use strict";
document.documentElement.classList.add("js");

// The snapshots one at a time, turned by a slider.
for (const figure of document.querySelectorAll(".slides")) {
  const slides = figure.querySelectorAll(".slide");
  const slider = figure.querySelector("input");
  const label = figure.querySelector("output");

  function turn() {
    const k = Number(slider.value);
    slides.forEach((slide, i) => slide.classList.toggle("now", i === k));
    label.textContent = `${k + 1} of ${slides.length}`;
  }

  slider.addEventListener("input", turn);
  turn();
}
