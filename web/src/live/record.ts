/**
 * Records by their description: one 8-byte little-endian word a column, in the order
 * of the columns.
 */

export type ColumnKind = "f64" | "u64" | "i64" | "bool" | "enum" | "flags";

export interface Column {
  name: string;
  unit?: string | null;
  kind: ColumnKind;
  names?: string[] | null;
}

/** Of a time that never was: the smallest i64. */
const NEVER = -(2n ** 63n);

export class Layout {
  readonly #index = new Map<string, number>();

  constructor(readonly columns: readonly Column[]) {
    columns.forEach((column, index) => this.#index.set(column.name, index));
  }

  get bytes(): number {
    return this.columns.length * 8;
  }

  indexOf(name: string): number {
    return this.#index.get(name) ?? -1;
  }

  at(index: number): Column | undefined {
    return this.columns[index];
  }
}

/** One record; its words are read when they are asked for. */
export class LiveRecord {
  readonly #view: DataView;

  constructor(readonly layout: Layout, buffer: ArrayBuffer) {
    if (buffer.byteLength !== layout.bytes) throw new RangeError(`a record of ${buffer.byteLength} bytes, where the columns give ${layout.bytes}`);
    this.#view = new DataView(buffer);
  }

  /** NaN without such a column, and of a time that never was. */
  number(name: string): number {
    const index = this.layout.indexOf(name);
    const column = this.layout.at(index);
    if (!column) return NaN;
    switch (column.kind) {
      case "f64":
        return this.#view.getFloat64(index * 8, true);
      case "i64": {
        const value = this.#view.getBigInt64(index * 8, true);
        return value === NEVER ? NaN : Number(value);
      }
      default:
        return Number(this.#view.getBigUint64(index * 8, true));
    }
  }

  bits(name: string): bigint {
    const index = this.layout.indexOf(name);
    return index < 0 ? 0n : this.#view.getBigUint64(index * 8, true);
  }

  /** The name of an enum's value. */
  named(name: string): string {
    const index = this.layout.indexOf(name);
    const column = this.layout.at(index);
    if (!column) return "";
    const value = this.number(name);
    return column.names?.[value] ?? String(value);
  }

  /** The names of the bits that are set. */
  flags(name: string): string[] {
    const names = this.layout.at(this.layout.indexOf(name))?.names ?? [];
    const bits = this.bits(name);
    const set: string[] = [];
    for (let bit = 0; bit < 64; bit += 1)
      if ((bits >> BigInt(bit)) & 1n) set.push(names[bit] ?? `condition ${bit}`);
    return set;
  }
}
