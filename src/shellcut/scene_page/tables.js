// The tables of a page, unpacked when they are asked for; packed_run.py says how they are packed.
class Tables {
  constructor(figure, described) {
    this.figure = figure;
    this.described = described;
    this.unpacked = new Map();
  }

  get(name) {
    if (!this.unpacked.has(name)) {
      const holder = this.figure.querySelector(`script[data-table="${name}"]`);
      const table = inflated(holder.textContent).then((bytes) => {
        holder.remove(); // the text is no longer needed: let the browser have its memory
        return new Table(this.described[name], bytes);
      });
      this.unpacked.set(name, table);
    }
    return this.unpacked.get(name);
  }
}

class Table {
  constructor(described, bytes) {
    Object.assign(this, described);
    this.first = [0];
    let total = 0;
    for (const rows of this.rows) this.first.push((total += rows * this.columns));
    const Kind = described.bytes === 2 ? Uint16Array : Uint32Array;
    this.integers = new Kind(total);
    for (let k = 0; k < this.rows.length; k++) this.unpackFrame(k, bytes);
  }

  unpackFrame(k, bytes) {
    const { columns, integers } = this;
    const rows = this.rows[k];
    const count = rows * columns;
    const common = k ? Math.min(rows, this.rows[k - 1]) : 0;
    const start = this.first[k] * this.bytes;
    const before = k ? this.first[k - 1] : 0;
    for (let column = 0, from = start; column < columns; column++) {
      for (let row = 0; row < rows; row++, from++) {
        let folded = 0;
        for (let plane = 0; plane < this.bytes; plane++) {
          folded |= bytes[from + plane * count] << (8 * plane);
        }
        const change = (folded >>> 1) ^ -(folded & 1);
        const at = row * columns + column;
        // The typed array takes the sum modulo its range, as the difference was taken.
        integers[this.first[k] + at] = change + (row < common ? integers[before + at] : 0);
      }
    }
  }

  // The integers of a frame, row after row.
  ids(k) {
    return this.integers.subarray(this.first[k], this.first[k + 1]);
  }

  // The numbers of a frame, row after row.
  numbers(k) {
    const { columns, low, step } = this;
    return Float32Array.from(this.ids(k), (n, i) => low[i % columns] + step[i % columns] * n);
  }

  number(k, row) {
    return this.low[0] + this.step[0] * this.integers[this.first[k] + row * this.columns];
  }
}

async function inflated(text) {
  const packed = Uint8Array.from(atob(text.trim()), (letter) => letter.charCodeAt(0));
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}
