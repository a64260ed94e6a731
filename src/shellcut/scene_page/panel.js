// The controls around a scene: frame, field, colour scale, parts, and what is read at a place.
const PER_SECOND = 12;
const RULER = 150; // pixels of the longest scale bar
const CLICK = 5; // pixels that a pointer may move and still pick

class Panel {
  static async open(figure) {
    const panel = new Panel(figure);
    try {
      await panel.start();
    } catch (error) {
      panel.say(`The scene cannot be shown: ${error.message}`);
    }
    figure.panel = panel; // for a look from the browser's console
    figure.dataset.ready = "yes";
  }

  constructor(figure) {
    this.part = (name) => figure.querySelector(`.${name}`);
    this.figure = figure;
    this.content = JSON.parse(this.part("content").textContent);
    this.tables = new Tables(figure, this.content.tables);
    this.frame = this.content.frames.length - 1;
    this.picked = null;
  }

  say(text) {
    this.part("hint").textContent = text;
    this.part("hint").hidden = !text;
  }

  async start() {
    if (!window.DecompressionStream) throw new Error("it needs a browser of 2023 or later.");
    if (!document.createElement("canvas").getContext("webgl2")) {
      throw new Error("this browser draws no WebGL 2 here.");
    }
    this.say("unpacking");
    const names = ["points", "quads", "flanks", "cables", "states"];
    const tables = await Promise.all(names.map((name) => this.tables.get(name)));
    this.of = Object.fromEntries(names.map((name, k) => [name, tables[k]]));
    this.view = new SceneView(this.part("canvas"), this.content);
    this.view.drawn = () => this.showRuler();
    this.addControls();
    this.addLegend();
    this.listen();
    this.view.resize();
    this.reset();
    const first = this.content.fields.findIndex(({ name }) => name === this.content.look.field);
    this.part("field").value = first;
    await this.chooseField(first);
    this.say("");
    new ResizeObserver(() => this.view.resize()).observe(this.part("canvas"));
  }

  // ---------------------------------------------------------------- what is shown

  showFrame(k) {
    this.frame = k;
    const { caption, number, pose } = this.content.frames[k];
    const { points, quads, flanks, cables, states } = this.of;
    this.view.show({
      points: points.numbers(k),
      quads: quads.ids(k),
      width: quads.columns,
      flanks: flanks.ids(k),
      cables: cables.numbers(k),
      states: states.ids(k),
      pose,
    });
    this.part("slider").value = k;
    this.part("which").textContent = `frame ${number}`;
    this.part("caption").textContent = caption.join("   ");
    this.showColors();
  }

  async chooseField(number) {
    this.field = this.content.fields[number];
    this.values = await this.tables.get(this.field.table);
    [this.part("low").value, this.part("high").value] = this.field.limits;
    this.part("unit").textContent = pretty(this.field.unit);
    this.showFrame(this.frame);
  }

  showColors() {
    const [low, high] = ["low", "high"].map((name) => Number(this.part(name).value));
    const { colors, smooth } = this.content.look;
    const colorOf = (value) => between(colors, (value - low) / (high - low || 1));
    this.view.film.color(this.values.numbers(this.frame), this.field.of, colorOf, smooth);
    const stops = Array.from({ length: 25 }, (_, k) => colorOf(low + (k / 24) * (high - low)));
    const names = stops.map(style);
    this.part("ramp").style.background = `linear-gradient(to right, ${names.join(", ")})`;
    this.readPicked();
    this.view.draw();
  }

  // A bar of 1, 2 or 5 times a power of ten in the unit shown, as long as it is drawn.
  showRuler() {
    const [unit, of] = this.content.length;
    const each = this.view.pixels() / of;
    const power = 10 ** Math.floor(Math.log10(RULER / each));
    const length = power * [5, 2, 1].find((n) => n * power * each <= RULER);
    this.part("ruler").style.width = `${length * each}px`;
    this.part("ruler").textContent = `${digits(length, power)} ${pretty(unit)}`;
  }

  reset() {
    const last = this.content.frames.length - 1;
    const shown = [0, last >> 1, last].map((k) => this.of.points.numbers(k));
    this.view.look(shown.flatMap((points) => Array.from(points)), ...this.content.look.camera);
  }

  // ---------------------------------------------------------------- controls

  addControls() {
    const { frames, fields } = this.content;
    this.part("slider").max = frames.length - 1;
    this.part("field").append(...fields.map((field, k) => new Option(field.label, k)));
    this.part("play").hidden = frames.length < 2;
  }

  addLegend() {
    const { colors, smooth, hide } = this.content.look;
    const film = { name: "film", part: "film", color: colors[32], area: true };
    const mesh = { name: "mesh", part: "mesh", color: [0.6, 0.6, 0.65] };
    const even = { name: "smooth colours", part: "smooth", color: colors[48], area: true };
    const hidden = smooth ? hide : [...hide, "smooth"];
    for (const entry of [film, mesh, ...this.content.legend, even]) {
      const { name, part, color, area } = entry;
      const button = document.createElement("button");
      const key = document.createElement("span");
      key.className = area ? "swatch area" : "swatch";
      key.style.background = style(color);
      button.type = "button";
      button.title = "show or hide";
      const turn = (shown) => {
        button.setAttribute("aria-pressed", String(shown));
        if (part === "smooth") {
          this.content.look.smooth = shown;
          if (this.values) this.showColors();
        } else this.view.switch(entry.switch || part, shown);
      };
      button.append(key, name);
      button.addEventListener("click", () => turn(button.getAttribute("aria-pressed") !== "true"));
      turn(!hidden.includes(part));
      this.part("legend").append(button);
    }
  }

  listen() {
    const on = (name, event, act) => this.part(name).addEventListener(event, act);
    on("slider", "input", () => {
      this.stop();
      this.showFrame(Number(this.part("slider").value));
    });
    on("play", "click", () => (this.playing ? this.stop() : this.play()));
    on("reset", "click", () => this.reset());
    on("field", "change", () => this.chooseField(Number(this.part("field").value)));
    for (const end of ["low", "high"]) on(end, "change", () => this.showColors());
    let down = null;
    on("canvas", "pointerdown", (event) => (down = [event.clientX, event.clientY]));
    on("canvas", "pointerup", ({ clientX: x, clientY: y }) => {
      if (down && Math.hypot(x - down[0], y - down[1]) < CLICK) this.pick(x, y);
      down = null;
    });
  }

  play() {
    const last = this.content.frames.length - 1;
    if (this.frame === last) this.showFrame(0);
    this.part("play").textContent = "❚❚";
    this.part("play").setAttribute("aria-label", "pause");
    const next = () => {
      this.showFrame(this.frame + 1);
      if (this.frame === last) this.stop();
      else this.playing = setTimeout(next, 1000 / PER_SECOND); // a large film takes its time
    };
    this.playing = setTimeout(next, 1000 / PER_SECOND);
  }

  stop() {
    clearTimeout(this.playing);
    this.playing = null;
    this.part("play").textContent = "▶";
    this.part("play").setAttribute("aria-label", "play");
  }

  // ---------------------------------------------------------------- reading values

  pick(x, y) {
    const found = this.view.pick(x, y);
    this.picked = found && {
      quad: found.quad,
      corner: this.view.film.polygon(found.quad).indexOf(found.node),
    };
    this.readPicked();
    this.view.draw();
  }

  // Quads keep their number, and a corner its place, when a node is split: the mark follows them. A
  // quad that is cut has other corners, so the mark may move within it.
  readPicked() {
    const { picked, frame, field } = this;
    const quads = this.of.quads;
    if (!picked || picked.quad >= quads.rows[frame]) {
      this.view.unmark();
      this.part("read").textContent = "Click the film to read a value.";
      this.part("course").replaceChildren();
      return;
    }
    const polygon = this.view.film.polygon(picked.quad);
    const node = polygon[Math.min(picked.corner, polygon.length - 1)];
    this.view.markQuad(picked.quad, node);
    const steps = this.of.points.step;
    const [unit, of] = this.content.length;
    const at = this.view.film.at(node).toArray();
    const place = at.map((along, axis) => digits(of * along, of * steps[axis]));
    const value = this.values.number(frame, field.of === "quad" ? picked.quad : node);
    this.part("read").textContent =
      `quad ${picked.quad}, node ${node} at (${place.join(", ")}) ${unit}: ` +
      `${field.label} ${digits(value, this.values.step[0])} ${pretty(field.unit)}`;
    this.drawCourse(field.of === "quad" ? picked.quad : node);
  }

  // The value of a quad or node over the frames, the shown one marked.
  drawCourse(row) {
    const { values, frame } = this;
    const last = values.rows.length - 1;
    const course = values.rows.map((n, k) => (row < n ? values.number(k, row) : NaN));
    const known = course.filter(Number.isFinite);
    const low = Math.min(0, ...known);
    const high = Math.max(0, ...known);
    const x = (k) => (200 * k) / (last || 1);
    const y = (value) => 38 - (36 * (value - low)) / (high - low || 1);
    const line = course.map((v, k) => (Number.isFinite(v) ? `${x(k)},${y(v).toFixed(1)}` : ""));
    this.part("course").innerHTML =
      `<line class="zero" x1="0" x2="200" y1="${y(0)}" y2="${y(0)}"/>` +
      `<polyline points="${line.join(" ")}"/>` +
      `<circle cx="${x(frame)}" cy="${y(course[frame])}" r="3"/>`;
  }
}

// Red, green and blue of a screen in 0 to 1 as a style.
function style(color) {
  return `rgb(${color.map((c) => Math.round(255 * c)).join(" ")})`;
}

function between(colors, share) {
  const at = Math.min(Math.max(share, 0), 1) * (colors.length - 1);
  const k = Math.min(Math.floor(at), colors.length - 2);
  return colors[k].map((color, i) => color + (at - k) * (colors[k + 1][i] - color));
}

// A stored number as text: with no more decimals than its steps have.
function digits(value, step) {
  const decimals = Math.min(Math.max(Math.ceil(-Math.log10(step)), 0), 20);
  return String(Number(value.toFixed(decimals)) + 0).replace("-", "−");
}

function pretty(unit) {
  return unit === "-" ? "" : unit.replace("*", "·").replace("deg", "°");
}

// A scene is unpacked when it comes into sight: a long page opens as fast as without it.
const watch = new IntersectionObserver((seen) => {
  for (const { isIntersecting, target } of seen) {
    if (!isIntersecting) continue;
    watch.unobserve(target);
    Panel.open(target);
  }
});
for (const scene of document.querySelectorAll(".scene3d")) watch.observe(scene);
