// The flash chip of an emulated board, as far as the node's firmware talks to it, and the serial interface (SSI) that
// leads there (RP2040 datasheet, section 4.10; W25Q16JV datasheet).
//
// The chip begins as the second boot stage leaves it: it takes addresses, not commands, until mode bits end that. A
// command has no effect before. While the firmware talks to the chip, it cannot run from it: any read of the flash is
// then an error.

/** Offsets of the registers (RP2040 datasheet, section 4.10.13). */
const CTRLR0 = 0x00;
const SSIENR = 0x08;
const TXFLR = 0x20;
const RXFLR = 0x24;
const SR = 0x28;
const DR0 = 0x60;
const SPI_CTRLR0 = 0xf4;
/** Bits of SR: room for bytes, nothing to send, bytes received. */
const TFNF = 1 << 1;
const TFE = 1 << 2;
const RFNE = 1 << 3;
/** Depth of each queue. */
const DEPTH = 16;
/** Values of registers that the boot stage for the W25Q080 leaves (rp2040-boot2, boot2_w25q080.S). */
const XIP_CTRLR0 = (2 << 21) | (31 << 16) | (3 << 8);
const XIP_SPI_CTRLR0 = (0xa0 << 24) | (4 << 11) | (8 << 2) | 2;
/** Control of the select pin in IO_QSPI, and its output override (RP2040 datasheet, section 2.19.6.2). */
const SELECT_CTRL = 0x0c;
const FORCED_LOW = 2;
const FORCED_HIGH = 3;
/** Bases of the peripherals, as the emulator numbers them. */
const SSI = 0x18000;
const IO_QSPI = 0x40018;
/** Commands of the chip. */
const READ_STATUS = 0x05;
const READ_STATUS_2 = 0x35;
const READ_UNIQUE_ID = 0x4b;
const FAST_READ_QUAD = 0xeb;
/** Bit of the second status register that allows four data lines. */
const QUAD = 0x02;
/** Bytes between the command and the unique number. */
const DUMMY_BYTES = 4;

/** Flash chip with a number of its own. */
export class Flash {
  /**
   * @param {object} chip RP2040 of the emulator
   * @param {string} number 16 hexadecimal digits; all ones or zeros as a chip that has none
   * @param {FlashCache} cache cache before it
   */
  constructor(chip, number, cache) {
    this.cache = cache;
    this.id = number.match(/../g).map((digits) => parseInt(digits, 16));
    this.registers = { [CTRLR0]: XIP_CTRLR0, [SSIENR]: 1, [SPI_CTRLR0]: XIP_SPI_CTRLR0 };
    this.forced = 0;
    this.select = 0;
    this.received = [];
    /** Bytes of the command under way. */
    this.command = [];
    /** True while the chip takes addresses without a command before them. */
    this.continuous = true;
    const ssi = chip.peripherals[SSI];
    ssi.readUint32 = (offset) => this.read(offset);
    ssi.writeUint32 = (offset, value) => this.write(offset, value);
    const pins = chip.peripherals[IO_QSPI];
    pins.readUint32 = (offset) => (offset === SELECT_CTRL ? this.select : 0);
    pins.writeUint32 = (offset, value) => {
      if (offset !== SELECT_CTRL) return;
      this.select = value;
      this.forced = (value >>> 8) & 3;
      this.command = [];
      this.guard();
    };
  }

  /** True while code runs from the flash. */
  get isReadable() {
    const { registers, forced, continuous } = this;
    const same = registers[CTRLR0] >>> 0 === XIP_CTRLR0 && registers[SPI_CTRLR0] >>> 0 === XIP_SPI_CTRLR0 >>> 0;
    return same && registers[SSIENR] === 1 && forced === 0 && continuous;
  }

  /** Makes reads of the flash an error while the chip cannot be read. */
  guard() {
    this.cache.isReadable = this.isReadable;
  }

  read(offset) {
    switch (offset) {
      case SR:
        // The queue is empty by now, so a select pin that nobody forces is released.
        if (this.forced === 0) this.command = [];
        return TFNF | TFE | (this.received.length ? RFNE : 0);
      case TXFLR:
        return 0;
      case RXFLR:
        return this.received.length;
      case DR0:
        return this.received.shift() ?? 0;
      default:
        return this.registers[offset] ?? 0;
    }
  }

  write(offset, value) {
    if (offset === DR0) {
      if (this.registers[SSIENR] !== 1) return;
      const answer = this.forced === FORCED_HIGH ? 0xff : this.exchange(value >>> 0);
      if (this.received.length < DEPTH) this.received.push(answer);
      return;
    }
    this.registers[offset] = value >>> 0;
    if (offset === SSIENR && value === 0) this.received = [];
    this.guard();
  }

  /** Takes a byte, or an address of the quad mode, and returns what the chip says meanwhile. */
  exchange(value) {
    const { command } = this;
    command.push(value);
    const at = command.length - 1;
    if (this.continuous) {
      // The seventh clock has mode bit 4 on the first line; the modes that go on have bits 5 and 4 at 1 and 0.
      if (at === 0 && value & 2) this.continuous = false;
      return 0xff;
    }
    switch (command[0]) {
      case FAST_READ_QUAD:
        if (at === 1) this.continuous = ((value >>> 4) & 3) === 2;
        return 0xff;
      case READ_STATUS:
        return 0;
      case READ_STATUS_2:
        return at ? QUAD : 0xff;
      case READ_UNIQUE_ID:
        return this.id[at - 1 - DUMMY_BYTES] ?? 0xff;
      default:
        return 0xff;
    }
  }
}
