// The cache before the flash chip of a Raspberry Pi Pico: 16 kB, two ways, lines of 8 bytes (RP2040 datasheet, section
// 2.6.3). What it holds is read in no time more, and the rest by four lines at the clock of the flash chip.

/** Start of the flash's cached window, and its end (RP2040 datasheet, section 2.6.3.1). */
const FIRST = 0x10000000;
const END = 0x11000000;
const LINE_BITS = 3;
const SETS = 1024;
const WAYS = 2;
/** Cycles of the flash chip's clock to fetch a line: 24 bits of address and 8 of mode by four lines, 4 cycles of pause
 * (W25Q16JV datasheet, fast read quad I/O), 64 bits of data by four lines, and 2 in which the chip is selected. */
const FETCH_CYCLES = 8 + 4 + 16 + 2;
/** Cycles of the processor for each of the flash chip: the divider that the second boot stage sets. */
const DIVIDER = 2;

/** Cache of a chip, whose reads of the flash it sees. */
export class FlashCache {
  constructor(chip) {
    /** Cycles of the processor that fetches have taken since they were last asked for. */
    this.cycles = 0;
    /** Fetches in all. */
    this.fetches = 0;
    /** False while the firmware talks to the flash chip, when it must not read from it. */
    this.isReadable = true;
    this.tags = new Int32Array(SETS * WAYS).fill(-1);
    this.oldest = new Uint8Array(SETS);
    for (const name of ['readUint32', 'readUint16', 'readUint8']) {
      const plain = chip[name].bind(chip);
      chip[name] = (address) => {
        this.read(address >>> 0);
        return plain(address);
      };
    }
  }

  read(address) {
    if (address < FIRST || address >= END) return;
    if (!this.isReadable) {
      throw new Error(`the firmware reads the flash at ${address.toString(16)} while it talks to the chip`);
    }
    const line = (address - FIRST) >>> LINE_BITS;
    const set = line % SETS;
    const tag = (line - set) / SETS;
    const first = WAYS * set;
    if (this.tags[first] === tag) {
      this.oldest[set] = 1;
    } else if (this.tags[first + 1] === tag) {
      this.oldest[set] = 0;
    } else {
      const way = this.oldest[set];
      this.tags[first + way] = tag;
      this.oldest[set] = way ^ 1;
      this.fetches += 1;
      this.cycles += FETCH_CYCLES * DIVIDER;
    }
  }

  /** Takes the cycles since the last call. */
  take() {
    const { cycles } = this;
    this.cycles = 0;
    return cycles;
  }
}
