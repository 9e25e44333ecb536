// Serves an emulated board on standard input and output, in its own time: it runs only as far as it is told.
//
// node serve.mjs FIRMWARE.elf [--number HEX] [--usb] [--baud RATE]
//
// The board has this number, and is reached over its USB port or its UART.
//
// A request is one byte and its fields, little-endian:
//   A  until_ns: f64, until_frame: u8, length: u32, bytes   feed the bytes, run
//   I  pin: u8, high: u8                                    set an input
//   R                                                       reset the board
//   H                                                       have the firmware stop for good
//   C                                                       counts of instructions
//   X                                                       extremes
//   U                                                       plug the USB cable in anew
//   S                                                       names of the USB device
// Answers: to A, now_ns: f64, length: u32, bytes, edges: u32, of each ns: f64, pin: u8, level: u8; to C six f64 (all
// instructions, alarms served, instructions in them, the most in one, the most with interrupts off since the last C,
// now_ns); to X three f64 (longest time with interrupts off, longest one in which the USB controller is used, both in
// ns since the last X, deepest place of the stack); to S, length: u32, lines of text (ids, manufacturer, product,
// serial number); to I, R, H and U, now_ns: f64.

import { parseArgs } from 'node:util';
import { Board } from './board.mjs';

const options = {
  number: { type: 'string', default: 'e66058388372b0a2' },
  usb: { type: 'boolean', default: false },
  baud: { type: 'string', default: '460800' },
};
const { values, positionals } = parseArgs({ options, allowPositionals: true });
const board = new Board(positionals[0], Number(values.baud), values.number, values.usb);
let input = Buffer.alloc(0);

process.stdin.on('data', (chunk) => {
  input = Buffer.concat([input, chunk]);
  for (let used = serve(input); used > 0; used = serve(input)) input = input.subarray(used);
});
process.stdin.on('end', () => process.exit(0));

/** Answers the first request of the input. Returns the number of bytes that it took, or 0 if it is not whole. */
function serve(input) {
  if (input.length === 0) return 0;
  const kind = String.fromCharCode(input[0]);
  if (kind === 'A') {
    if (input.length < 14) return 0;
    const end = 14 + input.readUInt32LE(10);
    if (input.length < end) return 0;
    board.feed(input.subarray(14, end));
    board.advance(input.readDoubleLE(1), input[9] !== 0);
    process.stdout.write(told(board.take()));
    return end;
  }
  if (kind === 'I') {
    if (input.length < 3) return 0;
    board.input(input[1], input[2] !== 0);
    process.stdout.write(numbers(board.now));
    return 3;
  }
  if (kind === 'R') {
    board.power();
    process.stdout.write(numbers(board.now));
    return 1;
  }
  if (kind === 'H') {
    board.halt();
    process.stdout.write(numbers(board.now));
    return 1;
  }
  if (kind === 'U') {
    board.plug();
    process.stdout.write(numbers(board.now));
    return 1;
  }
  if (kind === 'C') {
    const { all, alarms, alarm, worst, mostKept } = board.counts;
    process.stdout.write(numbers(all, alarms, alarm, worst, mostKept, board.now));
    board.counts.mostKept = 0;
    return 1;
  }
  if (kind === 'X') {
    process.stdout.write(numbers(board.extremes.offNs, board.extremes.usbOffNs, board.extremes.stack));
    [board.extremes.offNs, board.extremes.usbOffNs] = [0, 0];
    return 1;
  }
  if (kind === 'S') {
    const { ids, strings } = board.usb;
    const named = ids ? `${hex(ids.vendor)}:${hex(ids.product)}` : '';
    const text = Buffer.from([named, ...strings].join('\n'));
    const length = Buffer.alloc(4);
    length.writeUInt32LE(text.length);
    process.stdout.write(Buffer.concat([length, text]));
    return 1;
  }
  process.stderr.write(`unknown request ${JSON.stringify(kind)}; A, I, R, H, U, C, X and S are known\n`);
  process.exit(2);
}

/** Bytes of the board and edges of its pins as an answer. */
function told({ bytes, edges }) {
  const answer = Buffer.alloc(16 + bytes.length + 10 * edges.length);
  let at = answer.writeDoubleLE(board.now, 0);
  at = answer.writeUInt32LE(bytes.length, at);
  answer.set(bytes, at);
  at = answer.writeUInt32LE(edges.length, at + bytes.length);
  for (const { ns, pin, level } of edges) {
    at = answer.writeDoubleLE(ns, at);
    at = answer.writeUInt8(pin, at);
    at = answer.writeUInt8(level, at);
  }
  return answer;
}

/** Four hexadecimal digits. */
function hex(number) {
  return number.toString(16).padStart(4, '0');
}

/** Numbers as an answer. */
function numbers(...values) {
  const answer = Buffer.alloc(8 * values.length);
  values.forEach((value, index) => answer.writeDoubleLE(value, 8 * index));
  return answer;
}
