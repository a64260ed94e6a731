// The film of one frame: its quads as polygons with their outlines, coloured quad by quad or from
// node to node.
class Film {
  constructor(material, lines) {
    this.mesh = new THREE.Mesh(new THREE.BufferGeometry(), material);
    this.outlines = new THREE.LineSegments(new THREE.BufferGeometry(), lines);
    for (const part of [this.mesh, this.outlines]) part.frustumCulled = false;
  }

  // points: three numbers a node; quads: `width` nodes each, the last one repeated.
  show(points, quads, width) {
    this.points = points;
    this.quads = quads;
    this.width = width;
    this.split();
    const normals = this.normals();
    const position = filled(this.mesh.geometry, "position", this.corners.length);
    const normal = filled(this.mesh.geometry, "normal", this.corners.length);
    this.corners.forEach((node, i) => {
      for (let axis = 0; axis < 3; axis++) {
        position[3 * i + axis] = points[3 * node + axis];
        normal[3 * i + axis] = normals[3 * node + axis];
      }
    });
    const ends = filled(this.outlines.geometry, "position", this.sides.length);
    this.sides.forEach((node, i) => ends.set(points.subarray(3 * node, 3 * node + 3), 3 * i));
    this.mesh.geometry.setDrawRange(0, this.corners.length);
    this.outlines.geometry.setDrawRange(0, this.sides.length);
    this.mesh.geometry.computeBoundingSphere(); // a pick looks there first
  }

  // Nodes of triangles and of sides; every side once, as a quad and its neighbour share it.
  split() {
    this.corners = [];
    this.sides = [];
    this.quadOf = []; // by triangle
    const seen = new Set();
    const most = this.points.length;
    for (let quad = 0; quad < this.quads.length / this.width; quad++) {
      const polygon = this.polygon(quad);
      for (let k = 2; k < polygon.length; k++) {
        this.corners.push(polygon[0], polygon[k - 1], polygon[k]);
        this.quadOf.push(quad);
      }
      polygon.forEach((a, k) => {
        const b = polygon[(k + 1) % polygon.length];
        const side = Math.min(a, b) * most + Math.max(a, b);
        if (!seen.has(side)) this.sides.push(a, b);
        seen.add(side);
      });
    }
  }

  // The nodes of a quad, without repetition.
  polygon(quad) {
    const row = this.quads.subarray(quad * this.width, (quad + 1) * this.width);
    return Array.from(row).filter((node, k) => k === 0 || node !== row[k - 1]);
  }

  // Of the nodes: the mean of their triangles, so that a warped quad has no crease.
  normals() {
    const nodes = new THREE.BufferGeometry();
    nodes.setAttribute("position", new THREE.BufferAttribute(this.points, 3));
    nodes.setIndex(this.corners);
    nodes.computeVertexNormals();
    return nodes.getAttribute("normal").array;
  }

  // colorOf: from a value to red, green and blue of a screen; values of quads or of nodes. Smooth
  // colours run from node to node, others fill a quad.
  color(values, of, colorOf, smooth) {
    const color = filled(this.mesh.geometry, "color", this.corners.length);
    const shown = smooth === (of === "quad") ? this.means(values, of) : values;
    const colors = Array.from(shown, (value) => colorFrom(colorOf(value)).toArray());
    this.corners.forEach((node, i) => {
      color.set(colors[smooth ? node : this.quadOf[Math.floor(i / 3)]], 3 * i);
    });
  }

  // Of values of quads the means at the nodes; of values of nodes those of the quads.
  means(values, of) {
    const n = of === "quad" ? this.points.length / 3 : this.quads.length / this.width;
    const [sum, count] = [new Float32Array(n), new Float32Array(n)];
    for (let quad = 0; quad < this.quads.length / this.width; quad++) {
      for (const node of this.polygon(quad)) {
        const [from, to] = of === "quad" ? [quad, node] : [node, quad];
        sum[to] += values[from];
        count[to] += 1;
      }
    }
    return sum.map((total, k) => total / (count[k] || 1));
  }

  // The node of a quad that is nearest to a place.
  nearest(quad, place) {
    const away = (node) => place.distanceToSquared(this.at(node));
    return this.polygon(quad).reduce((best, node) => (away(node) < away(best) ? node : best));
  }

  at(node) {
    return new THREE.Vector3().fromArray(this.points, 3 * node);
  }
}

// The array of an attribute with room for so many points; a larger one replaces it if need be.
function filled(geometry, name, count) {
  let attribute = geometry.getAttribute(name);
  if (!attribute || attribute.count < count) {
    geometry.dispose();
    attribute = new THREE.BufferAttribute(new Float32Array(3 * Math.ceil(1.2 * count)), 3);
    geometry.setAttribute(name, attribute);
  }
  attribute.needsUpdate = true;
  return attribute.array;
}
