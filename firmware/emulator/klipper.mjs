// Asks real Klipper firmware in the emulated RP2040 for its dictionary, byte by byte over its UART.
//
// KLIPPER_ELF=out/klipper.elf node klipper.mjs
//
// The ELF file is Klipper's own build for an RP2040 with "Communication Interface" UART0 on GPIO0/GPIO1 at 250000 baud.
// Without KLIPPER_ELF this says that nothing was run. Formats: Klipper3d/klipper, docs/Protocol.md.

import { fileURLToPath } from 'node:url';
import { inflateSync } from 'node:zlib';

const BAUD = 250000;
/** End of a block, its bytes beside the content, and the bits that each sequence byte has. */
const SYNC = 0x7e;
const FRAME = 5;
const SEQUENCE = 0x10;
/** Numbers of `identify offset=%u count=%c` and of its response, which every host knows. */
const IDENTIFY = 1;
const IDENTIFY_RESPONSE = 0;
/** Bytes of the dictionary that a question asks for, longest wait for an answer, and time between two looks, in ms. */
const COUNT = 40;
const ANSWER_MS = 3000;
const LOOK_MS = 10;
/** Commands that the drive `klipper` needs of all. */
const NEEDED = ['queue_step', 'config_stepper', 'trsync_start', 'stepper_stop_on_trigger', 'reset_step_clock'];

/** Checksum of the bytes: CRC-16 CCITT, the lowest bit first. */
function checksum(bytes) {
  let crc = 0xffff;
  for (const byte of bytes) {
    crc ^= byte;
    for (let bit = 0; bit < 8; bit += 1) crc = crc & 1 ? (crc >>> 1) ^ 0x8408 : crc >>> 1;
  }
  return [crc >>> 8, crc & 0xff];
}

/** Bytes of a number from 0 on. */
function number(value) {
  const bytes = [value & 0x7f];
  // A first byte of 60h to 7Fh would be that of a negative number.
  while (value >= 0x60 << (7 * (bytes.length - 1))) {
    bytes.unshift(0x80 | ((value >>> (7 * bytes.length)) & 0x7f));
  }
  return bytes;
}

/** Number from 0 on at the start of `bytes`, and its length. */
function read(bytes) {
  let [value, length] = [bytes[0] & 0x7f, 1];
  while (bytes[length - 1] & 0x80) {
    value = (value << 7) | (bytes[length] & 0x7f);
    length += 1;
  }
  return [value, length];
}

function block(sequence, content) {
  const inner = [content.length + FRAME, SEQUENCE | (sequence & 0xf), ...content];
  return [...inner, ...checksum(inner), SYNC];
}

/** Contents of the whole blocks in `heard`, which loses all up to their end. */
function contents(heard) {
  const found = [];
  for (let at = 0; at + FRAME <= heard.length; ) {
    const length = heard[at];
    const inner = heard.slice(at, at + length - 3);
    const is = length >= FRAME && length <= 64 && at + length <= heard.length && heard[at + length - 1] === SYNC;
    const [high, low] = checksum(inner);
    if (!is || heard[at + length - 3] !== high || heard[at + length - 2] !== low) {
      at += 1;
      continue;
    }
    found.push(inner.slice(2));
    heard.splice(0, at + length);
    at = 0;
  }
  return found;
}

/** The dictionary of the board that `exchange` reaches: it takes bytes, and returns those of the next milliseconds. */
export function dictionary(exchange) {
  const [all, heard] = [[], []];
  for (let sequence = 0; ; sequence += 1) {
    let part;
    for (let waited = 0; part === undefined; waited += LOOK_MS) {
      if (waited > ANSWER_MS) throw new Error(`no answer to identify at byte ${all.length} within ${ANSWER_MS} ms`);
      // A question that is lost is asked again; the board takes a block once.
      const asks = waited % 500 === 0;
      heard.push(...exchange(asks ? block(sequence, [IDENTIFY, ...number(all.length), COUNT]) : [], LOOK_MS));
      for (const content of contents(heard)) {
        if (content[0] !== IDENTIFY_RESPONSE) continue;
        const [offset, length] = read(content.slice(1));
        if (offset === all.length) part = content.slice(2 + length, 2 + length + content[1 + length]);
      }
    }
    if (part.length === 0) return JSON.parse(inflateSync(Buffer.from(all)).toString());
    all.push(...part);
  }
}

async function main() {
  const elf = process.env.KLIPPER_ELF;
  if (!elf) {
    console.log('KLIPPER_ELF names no ELF file: real Klipper firmware was not run');
    return;
  }
  const { Board } = await import('./board.mjs');
  const board = new Board(elf, BAUD, 'e66058388372b0a2', false);
  const told = dictionary((bytes, ms) => {
    board.feed(bytes);
    board.advance(board.now + 1e6 * ms, false);
    return board.take().bytes;
  });
  const names = Object.keys(told.commands).map((format) => format.split(' ')[0]);
  const lacks = NEEDED.filter((name) => !names.includes(name));
  if (told.config.MCU !== 'rp2040' || lacks.length) {
    throw new Error(`${told.config.MCU} with ${told.version} lacks ${lacks.join(', ') || 'nothing'}`);
  }
  console.log(`Klipper ${told.version} on ${told.config.MCU}: ${names.length} commands, also those that are needed`);
}

if (process.argv[1] === fileURLToPath(import.meta.url)) await main();
