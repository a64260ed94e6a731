// What is seen: film, crack flanks, cables, tool and its edges, a camera that a person turns.
const STRAIGHT = 0;
const LIGHT = Math.PI; // three.js divides by it what a matt surface scatters
const SEEN = 0.8; // share of the picture that the film may fill: the tool stands out of it
const LONG = 1.3; // heights of the window: a longer page scrolls until the scene is clicked

class SceneView {
  constructor(canvas, content) {
    this.canvas = canvas;
    // The picture is kept, so that it can be printed and saved.
    const look = { antialias: true, alpha: true, preserveDrawingBuffer: true };
    this.renderer = new THREE.WebGLRenderer({ canvas, ...look });
    this.scene = new THREE.Scene();
    this.camera = new THREE.PerspectiveCamera(28, 1, 0.1, 10);
    this.camera.up.set(0, 0, 1);
    this.renderer.shadowMap.enabled = true;
    this.lamp = new THREE.DirectionalLight(0xffffff, 0.75 * LIGHT);
    this.lamp.castShadow = true;
    this.lamp.shadow.mapSize.set(2048, 2048);
    this.camera.add(this.lamp, this.lamp.target);
    this.scene.add(this.camera, new THREE.AmbientLight(0xffffff, 0.5 * LIGHT));
    this.parts = {};
    this.addFilm();
    const colors = Object.fromEntries(content.legend.map((entry) => [entry.switch, entry.color]));
    for (const [name, width] of [["flanks", 2.6], ["straight", 2.2], ["jointed", 2.2]]) {
      this.parts[name] = this.thick(colors[name] || [0, 0, 0], width);
      this.scene.add(this.parts[name]);
    }
    this.addTool(content.tool, colors);
    this.addMark();
    this.controls = new THREE.OrbitControls(this.camera, canvas);
    this.controls.zoomToCursor = true;
    this.controls.addEventListener("change", () => this.light());
    const long = document.documentElement.scrollHeight > LONG * window.innerHeight;
    this.controls.enableZoom = !long;
    canvas.addEventListener("pointerdown", () => canvas.focus());
    canvas.addEventListener("focus", () => (this.controls.enableZoom = true));
    canvas.addEventListener("blur", () => (this.controls.enableZoom = !long));
    this.caster = new THREE.Raycaster();
  }

  addFilm() {
    const side = THREE.DoubleSide;
    const behind = { polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1 };
    const film = new THREE.MeshLambertMaterial({ vertexColors: true, side, ...behind });
    film.onBeforeCompile = (shader) => (shader.fragmentShader = keepingHue(shader.fragmentShader));
    const lines = new THREE.LineBasicMaterial({ color: 0x1a1a26, transparent: true, opacity: 0.3 });
    this.film = new Film(film, lines);
    this.film.mesh.castShadow = this.film.mesh.receiveShadow = true;
    this.parts.film = this.film.mesh;
    this.parts.mesh = this.film.outlines;
    this.scene.add(this.film.mesh, this.film.outlines);
  }

  addTool(tool, colors) {
    this.body = new THREE.Group();
    this.body.matrixAutoUpdate = false;
    this.scene.add(this.body);
    if (!tool.points) return;
    const surface = new THREE.BufferGeometry();
    const points = new THREE.BufferAttribute(new Float32Array(tool.points), 3);
    surface.setAttribute("position", points);
    surface.setIndex(tool.triangles);
    const flat = surface.toNonIndexed();
    flat.computeVertexNormals();
    const look = { transparent: true, opacity: 0.4, depthWrite: false, side: THREE.DoubleSide };
    const material = new THREE.MeshLambertMaterial({ color: colorFrom(colors.tool), ...look });
    const creases = new THREE.BufferGeometry();
    creases.setAttribute("position", points);
    creases.setIndex(tool.creases);
    const lines = new THREE.LineBasicMaterial({ color: 0x4d4d54, transparent: true, opacity: 0.7 });
    this.parts.tool = new THREE.Group();
    const faces = new THREE.Mesh(flat, material);
    faces.castShadow = true;
    this.parts.tool.add(faces, new THREE.LineSegments(creases, lines));
    this.parts.edges = this.thick(colors.edges || [0, 0, 0], 3);
    place(this.parts.edges, tool.edges);
    this.body.add(this.parts.tool, this.parts.edges);
  }

  // The outline of the picked quad, and its picked node.
  addMark() {
    this.mark = this.thick([1, 0.3, 0.85], 3.5);
    this.mark.material.depthTest = false;
    this.mark.renderOrder = 3;
    const dot = new THREE.BufferGeometry();
    dot.setAttribute("position", new THREE.BufferAttribute(new Float32Array(3), 3));
    const look = { color: 0xff4dd9, size: 9, sizeAttenuation: false, depthTest: false };
    this.dot = new THREE.Points(dot, new THREE.PointsMaterial(look));
    this.dot.renderOrder = 3;
    this.dot.frustumCulled = false;
    this.scene.add(this.mark, this.dot);
    this.unmark();
  }

  thick(color, linewidth) {
    const offset = { polygonOffset: true, polygonOffsetFactor: -1, polygonOffsetUnits: -2 };
    const material = new THREE.LineMaterial({ color: colorFrom(color), linewidth, ...offset });
    const lines = new THREE.LineSegments2(new THREE.LineSegmentsGeometry(), material);
    lines.frustumCulled = false;
    lines.visible = false;
    return lines;
  }

  // ---------------------------------------------------------------- one frame

  // Numbers and ids of the frame by the names of their tables, and the width of its quads.
  show({ points, quads, width, flanks, cables, states, pose }) {
    this.film.show(points, quads, width);
    const node = (id) => points.subarray(3 * id, 3 * id + 3);
    place(this.parts.flanks, Array.from(flanks).flatMap((id) => Array.from(node(id))));
    const chosen = (straight) =>
      Array.from(cables).filter((_, i) => (states[Math.floor(i / 6)] === STRAIGHT) === straight);
    place(this.parts.straight, chosen(true));
    place(this.parts.jointed, chosen(false));
    const [a, b, c, d, e, f, g, h, i, x, y, z] = pose;
    this.body.matrix.set(a, b, c, x, d, e, f, y, g, h, i, z, 0, 0, 0, 1);
    this.body.matrixWorldNeedsUpdate = true;
  }

  switch(part, shown) {
    const lines = this.parts[part];
    if (!lines) return;
    lines.userData.off = !shown;
    lines.visible = shown && lines.userData.empty !== true;
    this.draw();
  }

  // ---------------------------------------------------------------- the camera

  // The camera stands as near as it can see all places, three numbers each.
  look(places, elevation, azimuth, zoom) {
    const [up, round] = [elevation, azimuth].map((angle) => (angle * Math.PI) / 180);
    const toward = new THREE.Vector3(
      Math.cos(up) * Math.cos(round), Math.cos(up) * Math.sin(round), Math.sin(up),
    );
    const right = new THREE.Vector3(-Math.sin(round), Math.cos(round), 0);
    const above = toward.clone().cross(right);
    const across = [right, above, toward].map((axis) => extent(places, axis));
    const centre = new THREE.Vector3();
    [right, above, toward].forEach((axis, k) => {
      centre.addScaledVector(axis, 0.5 * (across[k][0] + across[k][1]));
    });
    const slope = Math.tan((this.camera.fov * Math.PI) / 360) * SEEN;
    const [wide, high, deep] = across.map(([from, to]) => 0.5 * (to - from));
    const away = Math.max(wide / this.camera.aspect, high) / slope + 0.5 * deep;
    this.camera.near = 0.002 * away;
    this.camera.far = 30 * away;
    this.camera.updateProjectionMatrix();
    this.camera.position.copy(centre).addScaledVector(toward, away / zoom);
    this.reach = Math.hypot(wide, high, deep);
    const { shadow } = this.lamp;
    const [least, most] = [-this.reach, this.reach];
    const ends = { left: least, right: most, bottom: least, top: most, near: 0, far: 4 * most };
    Object.assign(shadow.camera, ends).updateProjectionMatrix();
    shadow.bias = -0.004;
    this.controls.target.copy(centre);
    this.controls.update();
    this.light();
  }

  // The lamp stands above the viewer's left shoulder and shines on what the camera turns around.
  light() {
    const away = this.camera.position.distanceTo(this.controls.target);
    this.lamp.target.position.set(0, 0, -away);
    this.lamp.position.set(-0.45, 0.6, 0.66).multiplyScalar(2 * this.reach);
    this.lamp.position.z -= away;
    this.draw();
  }

  resize() {
    const { clientWidth: width, clientHeight: height } = this.canvas;
    if (!width || !height) return;
    this.renderer.setPixelRatio(window.devicePixelRatio);
    this.renderer.setSize(width, height, false);
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
    this.draw();
  }

  // Pixels of a millimetre at the place around which the camera turns.
  pixels() {
    const away = this.camera.position.distanceTo(this.controls.target);
    return this.canvas.clientHeight / (2 * away * Math.tan((this.camera.fov * Math.PI) / 360));
  }

  draw() {
    if (this.waiting) return;
    this.waiting = true;
    requestAnimationFrame(() => {
      this.waiting = false;
      this.drawn?.();
      this.renderer.render(this.scene, this.camera);
    });
  }

  // ---------------------------------------------------------------- picking

  // The quad under a place in the window [pixel] and its nearest node; null beside the film.
  pick(x, y) {
    const box = this.canvas.getBoundingClientRect();
    const inside = [(x - box.left) / box.width, (y - box.top) / box.height];
    this.caster.setFromCamera(new THREE.Vector2(2 * inside[0] - 1, 1 - 2 * inside[1]), this.camera);
    const [hit] = this.caster.intersectObject(this.film.mesh);
    if (!hit) return null;
    const quad = this.film.quadOf[hit.faceIndex];
    return { quad, node: this.film.nearest(quad, hit.point) };
  }

  markQuad(quad, node) {
    const polygon = this.film.polygon(quad);
    const ends = polygon.flatMap((a, k) => [a, polygon[(k + 1) % polygon.length]]);
    place(this.mark, ends.flatMap((id) => this.film.at(id).toArray()));
    const dot = this.dot.geometry.getAttribute("position");
    dot.copyArray(this.film.at(node).toArray());
    dot.needsUpdate = true;
    this.dot.visible = true;
  }

  unmark() {
    this.mark.visible = this.dot.visible = false;
  }
}

// The shader of a surface whose light ends where red, green or blue is full: its hue is read.
function keepingHue(shader) {
  const out = "#include <opaque_fragment>";
  const most = "max(max(outgoingLight.r, outgoingLight.g), outgoingLight.b)";
  return shader.replace(out, `outgoingLight /= max(1.0, ${most});\n${out}`);
}

// The least and the greatest coordinate of places along an axis.
function extent(places, axis) {
  let [from, to] = [Infinity, -Infinity];
  for (let i = 0; i < places.length; i += 3) {
    const at = places[i] * axis.x + places[i + 1] * axis.y + places[i + 2] * axis.z;
    from = Math.min(from, at);
    to = Math.max(to, at);
  }
  return [from, to];
}

// Put thick lines at their ends, six numbers a line.
function place(lines, ends) {
  lines.userData.empty = !ends.length;
  lines.visible = !lines.userData.off && ends.length > 0;
  if (!ends.length) return;
  lines.geometry.dispose();
  lines.geometry = new THREE.LineSegmentsGeometry();
  lines.geometry.setPositions(ends);
}

// Red, green and blue of a screen, in 0 to 1.
function colorFrom([red, green, blue]) {
  return new THREE.Color().setRGB(red, green, blue, THREE.SRGBColorSpace);
}
