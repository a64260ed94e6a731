"use strict";
document.documentElement.classList.add("js");

// The charts: plotly.js draws the numbers beside each. A finger that drags scrolls the page.
const FINGER = matchMedia("(pointer: coarse)").matches;
const LAYOUT = {
  dragmode: FINGER ? false : "zoom",
  font: { family: getComputedStyle(document.body).fontFamily, size: 13, color: "#1b1f24" },
  hoverlabel: { bgcolor: "#f5f7f9", font: { color: "#1b1f24" } },
  legend: { orientation: "h", x: 0, y: 1.02, yanchor: "bottom" },
  margin: { l: 10, r: 12, t: 8, b: 24 },
  modebar: { bgcolor: "transparent" },
  paper_bgcolor: "transparent",
  plot_bgcolor: "transparent",
  showlegend: false,
};
const AXIS = { automargin: true, exponentformat: "power", ticklabelstandoff: 4, zeroline: false };
const CONFIG = {
  displaylogo: false,
  modeBarButtonsToRemove: ["sendChartToCloud", "select2d", "lasso2d", "autoScale2d"],
  responsive: true,
};

for (const figure of document.querySelectorAll(".chart")) {
  const plot = figure.querySelector("div");
  const [traces, own] = JSON.parse(figure.querySelector("script").textContent);
  const layout = { ...LAYOUT, ...own, xaxis: { ...AXIS, ...own.xaxis } };
  layout.yaxis = { ...AXIS, zeroline: true, ...own.yaxis };
  const displayModeBar = figure.classList.contains("small") ? false : FINGER || "hover";
  Plotly.newPlot(plot, traces, layout, { ...CONFIG, displayModeBar });
  const legend = plot.querySelector(".legend");
  if (legend) Plotly.relayout(plot, { height: own.height + legend.getBBox().height });
}
