// The parts of plotly.js that the charts use: curves and points are in its core.
const Plotly = require("plotly.js/lib/core");
Plotly.register([require("plotly.js/lib/contour")]);
globalThis.Plotly = Plotly;
