// What a reader does with the page of a report, and what is there then: posted to the frame around.
addEventListener("load", () => {
  const figure = document.querySelector(".chart");
  const chart = figure.chart;
  const svg = figure.querySelector(":scope > svg");
  const read = figure.querySelector(".read");
  const found = { wrong: window.wrong, hint: read.textContent };

  const box = () => svg.getBoundingClientRect();
  const at = (share) => box().left + chart.box.left + share * (chart.box.right - chart.box.left);
  const pointer = (type, share, more) =>
    svg.dispatchEvent(
      new PointerEvent(type, {
        clientX: at(share),
        clientY: box().top + 20,
        pointerType: "mouse",
        pointerId: 1,
        bubbles: true,
        ...more,
      }),
    );
  const key = (name) => svg.dispatchEvent(new KeyboardEvent("keydown", { key: name, bubbles: true }));
  const ticks = () =>
    [...svg.querySelectorAll(".tick.x")].map((tick) => [
      Number(tick.textContent.replace("−", "-")),
      (Number(tick.getAttribute("x")) - chart.box.left) / (chart.box.right - chart.box.left),
    ]);
  const tools = [...figure.querySelectorAll(".tools button")];
  const [left, out, closer, right, reset] = tools;
  const looked = (back) => {
    const seen = { view: chart.view, ticks: ticks() };
    back();
    return { ...seen, back: chart.view };
  };

  // Values.
  pointer("pointermove", 0.6);
  found.read = read.textContent;
  key("ArrowRight");
  found.next = read.textContent;
  found.whole = chart.view;
  found.disabled = [left, out, reset].map((button) => button.disabled);

  // Curves off and on.
  const switches = [...figure.querySelectorAll(".legend button")];
  const total = switches.find((button) => button.textContent === "total");
  found.pressed = [];
  found.totals = [];
  found.tops = [];
  const look = () => {
    found.pressed.push(total.getAttribute("aria-pressed"));
    found.totals.push(svg.querySelectorAll(".line.total").length);
    found.tops.push(chart.yRange[1]);
  };
  look();
  total.click();
  look();
  found.readWithout = read.textContent;
  total.click();
  look();
  switches.forEach((button) => button.click());
  found.none = svg.querySelectorAll(".line").length;
  switches.forEach((button) => button.click());

  // Ranges.
  chart.point(null);
  pointer("pointerdown", 0.4);
  pointer("pointermove", 0.5);
  pointer("pointermove", 0.6);
  pointer("pointerup", 0.6);
  found.drag = looked(() => key("0"));
  chart.point(null);
  const touch = (type, id, share) => pointer(type, share, { pointerType: "touch", pointerId: id });
  touch("pointerdown", 2, 0.4);
  touch("pointerdown", 3, 0.6);
  touch("pointermove", 2, 0.3);
  touch("pointermove", 3, 0.7);
  touch("pointerup", 2, 0.3);
  touch("pointerup", 3, 0.7);
  found.pinch = looked(() => svg.dispatchEvent(new MouseEvent("dblclick", { bubbles: true })));
  chart.point(null);
  key("+");
  key("+");
  found.keys = looked(() => key("Escape"));
  closer.click();
  const before = chart.view;
  found.buttons = looked(() => {});
  right.click();
  found.moved = (chart.view[0] - before[0]) / (before[1] - before[0]);
  for (let k = 0; k < 5; k++) right.click();
  found.atTheEnd = [right.disabled, left.disabled];
  reset.click();
  found.buttons.back = chart.view;
  svg.dispatchEvent(
    new WheelEvent("wheel", { deltaY: -100, ctrlKey: true, clientX: at(0.5), cancelable: true }),
  );
  found.wheel = looked(() => reset.click());

  // Snapshots.
  const slider = document.querySelector(".slides input");
  found.slides = [0, 5].map((k) => {
    slider.value = k;
    slider.dispatchEvent(new Event("input"));
    const shown = [...document.querySelectorAll(".slide")].map((slide) => slide.offsetHeight > 0);
    return shown.filter(Boolean).length === 1 ? shown.indexOf(true) : shown;
  });

  // What does not fit: numbers in the charts, tables that must be pushed aside, words over the edge.
  const inside = (inner, outer) => inner.left >= outer.left - 1 && inner.right <= outer.right + 1;
  const cut = [];
  for (const one of document.querySelectorAll(".chart > svg")) {
    for (const tick of one.querySelectorAll("text")) {
      if (!inside(tick.getBoundingClientRect(), one.getBoundingClientRect()))
        cut.push(`tick ${tick.textContent}`);
    }
  }
  for (const one of document.querySelectorAll(".wide, .panel, figcaption, .scale, .legend, .tools")) {
    if (one.scrollWidth > one.clientWidth + 1) cut.push(one.textContent.trim().slice(0, 60));
  }
  found.cut = cut;
  found.overflow = document.documentElement.scrollWidth - innerWidth;
  found.images = [...document.images].map((i) => (i.complete ? i.naturalWidth : -1));
  found.loaded = performance
    .getEntriesByType("resource")
    .map((e) => e.name)
    .filter((name) => !name.startsWith("data:"));
  parent.postMessage(JSON.stringify(found), "*");
});
