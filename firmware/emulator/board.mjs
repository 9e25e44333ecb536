// An emulated Raspberry Pi Pico with the node's firmware: bytes and input levels in, bytes and edges out. Its flash
// chip has a number of its own, and its USB cable leads to a host.

import { readFileSync } from 'node:fs';
import { GPIOPinState, Simulator } from 'rp2040js';
import { Flash } from './flash.mjs';
import { FlashCache } from './flash_cache.mjs';
import { UsbHost } from './usb_host.mjs';

/** Fastest clock of the processor at the core's voltage after a reset, and at 1.15 V (pico-sdk 2.1.1), in Hz. */
const FASTEST_HZ = 133e6;
const FASTEST_HZ_1V15 = 200e6;
/** Base of the core's regulator, as the emulator numbers it, its register, and the code of 1.15 V (RP2040 datasheet,
 * section 2.10.6). After a reset the code is that of 1.10 V. */
const REGULATOR = 0x40064;
const VREG = 0x00;
const VREG_AFTER_RESET = 0xb1;
const CODE_1V15 = 12;
/** Start of the flash (RP2040 datasheet, section 2.2). */
const FLASH = 0x10000000;
/** Start of the vector table: the 256 bytes before it are the second boot stage. */
const VECTORS = FLASH + 0x100;
/** Exception number of the first interrupt (ARMv6-M, table B1-1): alarm 0 of the timer, which makes the steps. */
const STEP_INTERRUPT = 16;
/** Type of a loadable segment in an ELF file. */
const PT_LOAD = 1;
/** Type of the section of symbols in an ELF file, and the bytes of a symbol. */
const SHT_SYMTAB = 2;
const SYMBOL_BYTES = 16;
/** Level of a pin that the board does not drive. */
const UNDRIVEN = 2;
/** Bits of a byte on the line: start, eight data, stop. */
const BITS_PER_BYTE = 10;

/** Says if the thread keeps the interrupts off. The emulator lets an interrupt that ends a sleep come at once. */
function keepsOff(core) {
  return core.PM && core.IPSR === 0;
}

/** Board whose time passes only in `advance`. */
export class Board {
  /**
   * @param {string} firmware path of the ELF file
   * @param {number} baud rate of the bytes that are fed, in bit/s
   * @param {string} number number of the board, 16 hexadecimal digits
   * @param {boolean} overUsb true if bytes come and go over the USB port
   */
  constructor(firmware, baud, number, overUsb) {
    this.number = number;
    this.overUsb = overUsb;
    /** Longest time with interrupts off, longest one in which the USB controller is used, in ns, and deepest stack. */
    this.extremes = { offNs: 0, usbOffNs: 0, stack: 0xffffffff };
    /** Time from which interrupts are off, and true if the USB controller was used since. */
    this.offFrom = undefined;
    this.usesUsb = false;
    this.image = readFileSync(firmware);
    this.byteNs = (BITS_PER_BYTE * 1e9) / baud;
    this.sent = [];
    this.edges = [];
    this.counts = { all: 0, alarms: 0, alarm: 0, worst: 0, before: 0, within: false, kept: 0, mostKept: 0 };
    this.lived = 0;
    this.power();
  }

  /** Time since the board was made, in ns. A reset does not turn it back, although the board's timer begins anew. */
  get now() {
    return this.lived + this.chip.clock.nanos;
  }

  /** Puts a new chip in the old one's place and starts the firmware at its reset vector. The boot ROM is not needed. */
  power() {
    if (this.chip) {
      this.lived = this.now;
      this.chip.gpio.forEach((_, pin) => this.edges.push({ ns: this.lived, pin, level: UNDRIVEN }));
    }
    const { image } = this;
    const chip = new Simulator().rp2040;
    this.chip = chip;
    this.fed = [];
    this.nextByteNs = 0;
    chip.logger = { debug() {}, info() {}, warn() {}, error() {} };
    chip.uart[0].onByte = (byte) => this.overUsb || this.sent.push(byte);
    this.usb = new UsbHost(chip.usbCtrl, (byte) => this.overUsb && this.sent.push(byte));
    for (const name of ['readUint32', 'writeUint32', 'DPRAMUpdated']) {
      const plain = chip.usbCtrl[name].bind(chip.usbCtrl);
      chip.usbCtrl[name] = (...values) => {
        this.usesUsb = true;
        return plain(...values);
      };
    }
    this.cache = new FlashCache(chip);
    this.flash = new Flash(chip, this.number, this.cache);
    this.clock(chip);
    chip.gpio.forEach((pin, number) => {
      pin.addListener((state) => this.edges.push({ ns: this.now, pin: number, level: level(state) }));
    });
    const elf = new DataView(image.buffer, image.byteOffset, image.byteLength);
    const [first, size, number] = [elf.getUint32(28, true), elf.getUint16(42, true), elf.getUint16(44, true)];
    for (let header = first; header < first + number * size; header += size) {
      if (elf.getUint32(header, true) !== PT_LOAD) continue;
      const [at, address, length] = [4, 12, 16].map((field) => elf.getUint32(header + field, true));
      if (length) chip.flash.set(image.subarray(at, at + length), address - FLASH);
    }
    chip.core.VTOR = VECTORS;
    chip.core.reset();
  }

  /**
   * Has time follow the clock that the firmware sets, and refuses one that the core's voltage does not allow. Until
   * then a cycle is that of the emulator's own rate.
   */
  clock(chip) {
    let vreg = VREG_AFTER_RESET;
    const regulator = chip.peripherals[REGULATOR];
    regulator.readUint32 = (offset) => (offset === VREG ? vreg : 0);
    regulator.writeUint32 = (offset, value) => {
      if (offset === VREG) vreg = value;
    };
    this.cycleNs = 1e9 / chip.clkSys;
    this.isClockSet = false;
    chip.addClockListener((hz) => {
      const allowed = ((vreg >>> 4) & 0xf) >= CODE_1V15 ? FASTEST_HZ_1V15 : FASTEST_HZ;
      if (hz > allowed) {
        throw new Error(`the firmware sets a clock of ${hz / 1e6} MHz; the core's voltage allows ${allowed / 1e6} MHz`);
      }
      this.cycleNs = 1e9 / hz;
      this.isClockSet = true;
    });
  }

  /** Feeds bytes from now on, each in the time that the line takes for it. */
  feed(bytes) {
    if (this.overUsb) {
      this.usb.feed(bytes);
      return;
    }
    this.nextByteNs = Math.max(this.nextByteNs, this.chip.clock.nanos + this.byteNs);
    for (const byte of bytes) this.fed.push(byte);
  }

  /** Runs until a time, in ns, or until the board has sent a frame's last byte (zero) if `untilFrame` is true. */
  advance(untilNs, untilFrame) {
    const { chip, fed, lived } = this;
    const { core, clock } = chip;
    const endNs = untilNs - lived;
    while (clock.nanos < endNs) {
      if (fed.length && clock.nanos >= this.nextByteNs) {
        chip.uart[0].feedByte(fed.shift());
        this.nextByteNs += this.byteNs;
      }
      if (core.waiting) {
        const byteNs = fed.length ? this.nextByteNs : endNs;
        const alarmNs = clock.nextAlarm ? clock.nextAlarm.nanos : endNs;
        this.offFrom = undefined;
        clock.tick(Math.max(this.cycleNs, Math.min(byteNs, alarmNs, endNs) - clock.nanos));
      } else {
        clock.tick((core.executeInstruction() + this.cache.take()) * this.cycleNs);
        this.count(core.IPSR, keepsOff(core));
        this.watch(core);
      }
      if (untilFrame && this.sent.length && this.sent[this.sent.length - 1] === 0) return;
    }
  }

  /**
   * Counts the instruction just executed: in all, within the interrupts that make steps, and while the thread
   * keeps the interrupts off.
   */
  count(exception, keptOff) {
    const { counts } = this;
    counts.kept = keptOff ? counts.kept + 1 : 0;
    counts.mostKept = Math.max(counts.mostKept, counts.kept);
    counts.all += 1;
    const within = exception === STEP_INTERRUPT;
    if (within) {
      counts.alarm += 1;
    } else if (counts.within) {
      counts.alarms += 1;
      counts.worst = Math.max(counts.worst, counts.alarm - counts.before);
    }
    if (within && !counts.within) counts.before = counts.alarm - 1;
    counts.within = within;
  }

  /** Notes how long interrupts are off, and how deep the stack is. */
  watch(core) {
    const { extremes } = this;
    if (core.SP < extremes.stack && core.SP >>> 28 === 2) extremes.stack = core.SP;
    if (!keepsOff(core)) {
      if (this.offFrom === undefined) return;
      const offNs = this.chip.clock.nanos - this.offFrom;
      // The start of the firmware, which asks the flash chip before it sets the clock, has no step to make.
      if (this.isClockSet) extremes.offNs = Math.max(extremes.offNs, offNs);
      if (this.usesUsb) extremes.usbOffNs = Math.max(extremes.usbOffNs, offNs);
      this.offFrom = undefined;
    } else if (this.offFrom === undefined) {
      this.offFrom = this.chip.clock.nanos;
      this.usesUsb = false;
    }
  }

  /** Sets the level of an input pin. */
  input(pin, high) {
    this.chip.gpio[pin].setInputValue(high);
  }

  /** Plugs the USB cable in anew: the host resets the bus and meets the device. Bytes on their way are lost. */
  plug() {
    this.sent = [];
    this.usb.plug();
  }

  /** Has the firmware go on where it stops for good, as after a panic: at its function `halt`. */
  halt() {
    this.chip.core.PC = address(this.image, /4halt17h[0-9a-f]{16}E$|::halt$/) & ~1;
    this.chip.core.waiting = false;
  }

  /** Takes what the board has sent and the edges of its pins since the last call. */
  take() {
    const taken = { bytes: this.sent, edges: this.edges };
    [this.sent, this.edges] = [[], []];
    return taken;
  }
}

/** Address of the only symbol of an ELF file whose name is like this. */
function address(image, name) {
  const elf = new DataView(image.buffer, image.byteOffset, image.byteLength);
  const [first, size, number] = [elf.getUint32(32, true), elf.getUint16(46, true), elf.getUint16(48, true)];
  const section = (n) => {
    const fields = [4, 16, 20, 24].map((field) => elf.getUint32(first + n * size + field, true));
    return { type: fields[0], offset: fields[1], length: fields[2], link: fields[3] };
  };
  const sections = Array.from({ length: number }, (_, n) => section(n));
  const symbols = sections.find(({ type }) => type === SHT_SYMTAB);
  const names = sections[symbols.link];
  const found = [];
  for (let at = symbols.offset; at < symbols.offset + symbols.length; at += SYMBOL_BYTES) {
    const from = names.offset + elf.getUint32(at, true);
    if (name.test(image.toString('latin1', from, image.indexOf(0, from)))) found.push(elf.getUint32(at + 4, true));
  }
  if (found.length !== 1) throw new Error(`${found.length} symbols are like ${name}; there must be one`);
  return found[0];
}

/** Level of a pin: 0 low, 1 high, or `UNDRIVEN`. */
function level(state) {
  if (state === GPIOPinState.Low) return 0;
  return state === GPIOPinState.High ? 1 : UNDRIVEN;
}
