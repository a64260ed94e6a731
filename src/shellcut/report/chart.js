// A chart drawn in the pixels there are: curves are switched by their names in the legend, a range
// is looked at closely by dragging over it, pinching, the buttons or the keys.
class Chart {
  constructor(figure, number) {
    this.data = JSON.parse(figure.querySelector("script").textContent);
    this.svg = figure.querySelector(":scope > svg");
    this.clip = `clip-${number}`;
    for (const curve of this.data.curves) curve.x = curve.x || this.data.x;
    const firsts = this.data.curves.map((c) => c.x[0]);
    const lasts = this.data.curves.map((c) => c.x[c.x.length - 1]);
    this.whole = [Math.min(...firsts), Math.max(...lasts)];
    this.view = this.whole;
    this.hidden = new Set();
    this.cursor = null;
    this.hint = number ? "" : Chart.hint;
    this.pointers = new Map();
    this.addSwitches(figure);
    this.addTools(figure);
    this.listen();
    this.draw();
    new ResizeObserver(() => {
      if (this.svg.clientWidth !== this.width) requestAnimationFrame(() => this.draw());
    }).observe(this.svg);
  }

  // ---------------------------------------------------------------- parts around the picture

  addSwitches(figure) {
    for (const item of figure.querySelectorAll(".legend li")) {
      const name = item.textContent;
      const button = document.createElement("button");
      button.type = "button";
      button.append(...item.childNodes);
      button.title = "show or hide this curve";
      button.setAttribute("aria-pressed", "true");
      button.addEventListener("click", () => {
        const shown = this.hidden.delete(name);
        if (!shown) this.hidden.add(name);
        button.setAttribute("aria-pressed", String(shown));
        this.draw();
      });
      item.append(button);
    }
  }

  addTools(figure) {
    const bar = document.createElement("div");
    bar.className = "tools";
    const tools = [
      ["left", "◀", "move the range to the left", () => this.shift(-0.25)],
      ["out", "−", "show a wider range", () => this.zoom(2)],
      ["in", "+", "show a narrower range", () => this.zoom(0.5)],
      ["right", "▶", "move the range to the right", () => this.shift(0.25)],
      ["reset", "whole range", "show the whole range", () => this.show(this.whole)],
    ];
    this.tools = {};
    for (const [key, sign, title, act] of tools) {
      const button = document.createElement("button");
      button.type = "button";
      button.textContent = sign;
      button.title = title;
      button.setAttribute("aria-label", title);
      button.addEventListener("click", act);
      bar.append(button);
      this.tools[key] = button;
    }
    this.read = document.createElement("output");
    this.read.className = "read";
    this.read.setAttribute("aria-live", "polite");
    figure.append(bar, this.read);
  }

  // ---------------------------------------------------------------- which range is shown

  show([from, to]) {
    const [first, last] = this.whole;
    const width = Math.min(Math.max(to - from, 1e-4 * (last - first)), last - first);
    const low = Math.min(Math.max(from, first), last - width);
    this.view = width > 0.9999 * (last - first) ? this.whole : [low, low + width];
    this.draw();
  }

  zoom(factor, about = this.cursor) {
    const [from, to] = this.view;
    const inside = about !== null && about >= from && about <= to;
    const fixed = inside ? about : 0.5 * (from + to);
    this.show([fixed + (from - fixed) * factor, fixed + (to - fixed) * factor]);
  }

  shift(part) {
    const way = part * (this.view[1] - this.view[0]);
    this.show([this.view[0] + way, this.view[1] + way]);
  }

  // ---------------------------------------------------------------- the picture

  draw() {
    this.width = this.svg.clientWidth;
    const width = Math.max(this.width, 240);
    const height = Math.min(this.data.height, Math.max(0.72 * width, 150));
    const layers = this.layers();
    const zoomed = this.view !== this.whole;
    const yTicks = ticks(...this.extent(layers, zoomed), height < 200 ? 4 : 6, true);
    const left = 14 + 8 * Math.max(...yTicks.map((t) => number(t).length));
    this.box = { left, right: width - 20, top: 12, bottom: height - 28 };
    this.yRange = [yTicks[0], yTicks[yTicks.length - 1]];
    const { right, top, bottom } = this.box;
    const level = (style, y) =>
      `<line class="${style}" x1="${left}" x2="${right}" y1="${y.toFixed(1)}" y2="${y.toFixed(1)}"/>`;
    const parts = [
      `<clipPath id="${this.clip}"><rect x="${left}" y="${top - 2}" width="${right - left}" ` +
        `height="${bottom - top + 4}"/></clipPath>`,
    ];
    for (const tick of yTicks) {
      const y = this.atY(tick);
      parts.push(level("grid", y));
      parts.push(`<text class="tick y" x="${left - 6}" y="${y.toFixed(1)}">${number(tick)}</text>`);
    }
    for (const tick of ticks(...this.view, Math.max(2, Math.floor((right - left) / 55)), false)) {
      const x = this.atX(tick).toFixed(1);
      parts.push(`<text class="tick x" x="${x}" y="${height - 8}">${number(tick)}</text>`);
    }
    parts.push(`<g clip-path="url(#${this.clip})">`);
    for (const layer of layers) parts.push(this.path(layer));
    parts.push("</g>");
    if (this.yRange[0] <= 0 && this.yRange[1] >= 0) parts.push(level("axis", this.atY(0)));
    parts.push(`<rect class="chosen" y="${top}" height="${bottom - top}" width="0"/>`);
    parts.push(`<line class="cursor" y1="${top}" y2="${bottom}" x1="-9" x2="-9"/>`);
    this.svg.setAttribute("viewBox", `0 0 ${width} ${height}`);
    this.svg.innerHTML = parts.join("");
    this.tools.reset.disabled = this.tools.out.disabled = !zoomed;
    this.tools.left.disabled = this.view[0] <= this.whole[0];
    this.tools.right.disabled = this.view[1] >= this.whole[1];
    this.point(this.cursor);
  }

  // What is drawn, areas first: those shown lie on each other.
  layers() {
    const shown = this.data.curves.filter((curve) => !this.hidden.has(curve.name));
    let floor = this.data.x.map(() => 0);
    const areas = [];
    for (const curve of shown.filter((c) => c.area)) {
      const top = curve.y.map((y, k) => y + floor[k]);
      areas.push({ ...curve, y: top, floor });
      floor = top;
    }
    return [...areas, ...shown.filter((c) => !c.area)];
  }

  extent(layers, zoomed) {
    const [from, to] = this.view;
    let low = Infinity;
    let high = -Infinity;
    const take = (y) => {
      low = Math.min(low, y);
      high = Math.max(high, y);
    };
    for (const { x, y, floor } of layers) {
      for (let k = 0; k < x.length; k++) if (x[k] >= from && x[k] <= to) take(y[k]);
      for (const end of [from, to]) if (end >= x[0] && end <= x[x.length - 1]) take(at(x, y, end));
      if (floor) take(0);
    }
    if (low > high) return [0, 1];
    if (!zoomed) {
      take(0);
      if (low > -0.01 * high) low = 0; // round-off below zero gets no room of its own
    }
    return [low, high];
  }

  path({ x, y, floor, style }) {
    const place = (k, values) => `${this.atX(x[k]).toFixed(1)},${this.atY(values[k]).toFixed(1)}`;
    // one point beyond either end of the view, so that lines run out of the picture
    const first = Math.max(0, above(x, this.view[0]) - 1);
    const last = Math.min(x.length - 1, above(x, this.view[1]));
    const points = [];
    for (let k = first; k <= last; k++) points.push(place(k, y));
    if (!floor) return `<path class="line ${style}" d="M${points.join("L")}"/>`;
    for (let k = last; k >= first; k--) points.push(place(k, floor));
    return `<path class="area ${style}" d="M${points.join("L")}Z"/>`;
  }

  atX(value) {
    const { left, right } = this.box;
    return left + ((value - this.view[0]) / (this.view[1] - this.view[0])) * (right - left);
  }

  atY(value) {
    const { top, bottom } = this.box;
    const [low, high] = this.yRange;
    return bottom - ((value - low) / (high - low)) * (bottom - top);
  }

  // ---------------------------------------------------------------- reading values

  point(place) {
    this.cursor = place;
    const line = this.svg.querySelector(".cursor");
    const seen = place !== null && place >= this.view[0] && place <= this.view[1];
    const x = seen ? this.atX(place) : -9;
    line.setAttribute("x1", x);
    line.setAttribute("x2", x);
    this.read.textContent = seen ? this.values(place) : this.hint;
  }

  values(place) {
    const { xName, xUnit, unit, curves } = this.data;
    const gap = xUnit === "°" ? "" : " ";
    // Curves that share a name (the teeth) are a crowd: one reads the others.
    const single = curves.filter((c) => curves.filter((d) => d.name === c.name).length === 1);
    const read = single
      .filter(({ name, x }) => !this.hidden.has(name) && place >= x[0] && place <= x[x.length - 1])
      .map(({ name, x, y }) => `${name} ${digits(at(x, y, place), 5)} ${unit}`);
    return [`${xName} ${digits(place, 6)}${gap}${xUnit}`, ...read].join("; ");
  }

  // The row under a place, of the first curve that is shown.
  nearest(place) {
    const shown = this.data.curves.find((curve) => !this.hidden.has(curve.name));
    const x = (shown || this.data.curves[0]).x;
    const k = Math.min(above(x, place), x.length - 1);
    return k > 0 && place - x[k - 1] < x[k] - place ? k - 1 : k;
  }

  step(rows) {
    const shown = this.data.curves.find((curve) => !this.hidden.has(curve.name));
    const x = (shown || this.data.curves[0]).x;
    const k = this.cursor === null ? above(x, this.view[0]) - rows : this.nearest(this.cursor);
    const place = x[Math.max(0, Math.min(x.length - 1, k + rows))];
    const [from, to] = this.view;
    if (place < from) this.show([place, place + to - from]);
    if (place > to) this.show([place - (to - from), place]);
    this.point(place);
  }

  // ---------------------------------------------------------------- pointers and keys

  listen() {
    const svg = this.svg;
    svg.addEventListener("pointerdown", (event) => this.down(event));
    svg.addEventListener("pointermove", (event) => this.move(event));
    svg.addEventListener("pointerup", (event) => this.up(event));
    svg.addEventListener("pointercancel", (event) => this.up(event));
    svg.addEventListener("pointerleave", (event) => {
      if (!this.pointers.size && event.pointerType === "mouse") this.point(null);
    });
    svg.addEventListener("dblclick", () => this.show(this.whole));
    svg.addEventListener("keydown", (event) => this.key(event));
    // A pinch on a touch pad comes as a wheel with Ctrl; a wheel alone scrolls the page.
    svg.addEventListener(
      "wheel",
      (event) => {
        if (!event.ctrlKey) return;
        event.preventDefault();
        this.zoom(Math.exp(0.005 * event.deltaY), this.placeOf(event.clientX));
      },
      { passive: false },
    );
  }

  placeOf(clientX) {
    const outer = this.svg.getBoundingClientRect();
    const inPicture = ((clientX - outer.left) / outer.width) * this.svg.viewBox.baseVal.width;
    const { left, right } = this.box;
    const part = Math.max(0, Math.min(1, (inPicture - left) / (right - left)));
    return this.view[0] + part * (this.view[1] - this.view[0]);
  }

  down(event) {
    if (event.pointerType === "mouse" && event.button !== 0) return;
    this.pointers.set(event.pointerId, event.clientX);
    this.began = { view: this.view, x: [...this.pointers.values()] };
    if (event.isTrusted) this.svg.setPointerCapture(event.pointerId);
    this.point(this.placeOf(event.clientX));
  }

  move(event) {
    const held = this.pointers.has(event.pointerId);
    if (held) this.pointers.set(event.pointerId, event.clientX);
    if (held && event.pointerType === "mouse") this.choose(event.clientX);
    else if (this.pointers.size === 2) this.pinch();
    else if (held && this.began.view !== this.whole) this.drag(event.clientX);
    if (this.pointers.size < 2) this.point(this.placeOf(event.clientX));
  }

  up(event) {
    if (!this.pointers.delete(event.pointerId)) return;
    const [start] = this.began.x;
    if (event.type === "pointerup" && event.pointerType === "mouse") {
      const ends = [this.placeOf(start), this.placeOf(event.clientX)].sort((a, b) => a - b);
      if (Math.abs(event.clientX - start) > 6) this.show(ends);
    }
    // who lifts one of two fingers goes on with the other
    this.began = { view: this.view, x: [...this.pointers.values()] };
    this.choose(null);
  }

  choose(clientX) {
    const chosen = this.svg.querySelector(".chosen");
    if (clientX === null) return chosen.setAttribute("width", 0);
    const ends = [this.began.x[0], clientX].map((x) => this.atX(this.placeOf(x)));
    chosen.setAttribute("x", Math.min(...ends));
    chosen.setAttribute("width", Math.abs(ends[1] - ends[0]));
  }

  // What was under a finger stays under it.
  drag(clientX) {
    const { view, x } = this.began;
    const perPixel = (view[1] - view[0]) / this.plotWidth();
    const way = (x[0] - clientX) * perPixel;
    this.show([view[0] + way, view[1] + way]);
  }

  pinch() {
    const { view, x } = this.began;
    const now = [...this.pointers.values()];
    const apart = [x, now].map(([a, b]) => Math.max(Math.abs(b - a), 10));
    const middle = [x, now].map(([a, b]) => 0.5 * (a + b));
    const outer = this.svg.getBoundingClientRect();
    const edge = outer.left + (this.box.left * outer.width) / this.svg.viewBox.baseVal.width;
    const perPixel = (view[1] - view[0]) / this.plotWidth();
    const held = view[0] + (middle[0] - edge) * perPixel;
    const scale = perPixel * (apart[0] / apart[1]);
    const from = held - (middle[1] - edge) * scale;
    this.show([from, from + scale * this.plotWidth()]);
  }

  plotWidth() {
    const outer = this.svg.getBoundingClientRect();
    const { left, right } = this.box;
    return ((right - left) * outer.width) / this.svg.viewBox.baseVal.width;
  }

  key(event) {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const part = 0.25 * (event.shiftKey ? 1 : 0);
    const acts = {
      ArrowRight: () => (part ? this.shift(part) : this.step(1)),
      ArrowLeft: () => (part ? this.shift(-part) : this.step(-1)),
      PageUp: () => this.step(20),
      PageDown: () => this.step(-20),
      "+": () => this.zoom(0.5),
      "=": () => this.zoom(0.5),
      "-": () => this.zoom(2),
      0: () => this.show(this.whole),
      Escape: () => this.show(this.whole),
    };
    if (!acts[event.key]) return;
    event.preventDefault();
    acts[event.key]();
  }
}

// Said below the first chart only.
Chart.hint =
  "Point at a curve to read values; drag over a range, or pinch, to see it closely; choose a name " +
  "in the legend to hide its curve. Keys: arrows, +, −, 0.";

// The first row at or above a place.
function above(x, place) {
  let low = 0;
  let high = x.length;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (x[middle] < place) low = middle + 1;
    else high = middle;
  }
  return low;
}

function at(x, y, place) {
  const k = Math.min(Math.max(above(x, place), 1), x.length - 1);
  const part = (place - x[k - 1]) / (x[k] - x[k - 1]);
  return y[k - 1] + Math.max(0, Math.min(1, part)) * (y[k] - y[k - 1]);
}

// Round numbers between two others; around them if the picture is to hold both.
function ticks(low, high, n, around) {
  if (!(high > low)) high = low + Math.max(Math.abs(low), 1);
  const raw = (high - low) / n;
  const unit = 10 ** Math.floor(Math.log10(raw));
  const step = unit * [1, 2, 2.5, 5, 10].find((m) => m * unit >= raw);
  const round = around ? [Math.floor, Math.ceil] : [Math.ceil, Math.floor];
  const first = round[0](low / step + (around ? 1e-9 : -1e-9));
  const last = round[1](high / step - (around ? 1e-9 : -1e-9));
  const found = [];
  for (let k = first; k <= last; k++) found.push(k * step);
  return found;
}

function digits(value, n) {
  return String(Number(value.toPrecision(n)));
}

function number(value) {
  return digits(value, 6).replace("-", "−");
}

document.querySelectorAll(".chart").forEach((figure, k) => {
  figure.chart = new Chart(figure, k);
});
