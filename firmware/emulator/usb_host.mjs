// A USB host that finds a CDC-ACM device in an emulated RP2040, as a computer does: it gives it an address, reads its
// descriptors and strings, configures it and opens its port.

import { createSetupPacket, DataDirection, DescriptorType, SetupRecipient, SetupType } from 'rp2040js';

/** Requests (USB 2.0, table 9-4; CDC 1.2, PSTN subclass, table 13). */
const SET_ADDRESS = 5;
const GET_DESCRIPTOR = 6;
const SET_CONFIGURATION = 9;
const SET_CONTROL_LINE_STATE = 0x22;
/** Types of descriptors (USB 2.0, table 9-5), and the class of the interface that carries data. */
const DEVICE = 1;
const STRING = 3;
const INTERFACE = 4;
const ENDPOINT = 5;
const DATA_CLASS = 10;
/** Data terminal ready and request to send: a program has opened the port. */
const OPEN = 3;
/** Bytes of a packet, and the time that it takes at 12 Mbit/s with its token and handshake, in us. */
const PACKET = 64;
const PACKET_US = 53;

/** Host at the other end of the board's USB cable. */
export class UsbHost {
  /**
   * @param {object} usb USB controller of the emulator
   * @param {function} onByte takes each byte that the board sends
   */
  constructor(usb, onByte) {
    this.usb = usb;
    this.onByte = onByte;
    this.strings = [];
    this.isOpen = false;
    /** Bytes for the board, and the number of bytes that each of its endpoints takes now. */
    this.fed = [];
    this.room = {};
    this.inward = -1;
    this.outward = -1;
    usb.onUSBEnabled = () => usb.resetDevice();
    usb.onResetReceived = () => this.meet();
    usb.onEndpointWrite = (endpoint, packet) => this.take(endpoint, packet);
    usb.onEndpointRead = (endpoint, size) => {
      this.room[endpoint] = size;
      this.deliver();
    };
  }

  /** Begins anew, as a host does whose cable was plugged in. */
  plug() {
    [this.strings, this.fed, this.room, this.isOpen] = [[], [], {}, false];
    this.usb.resetDevice();
  }

  /** Sends bytes to the board, as fast as it takes them. */
  feed(bytes) {
    for (const byte of bytes) this.fed.push(byte);
    this.deliver();
  }

  deliver() {
    const room = this.room[this.outward];
    if (!this.isOpen || !room || !this.fed.length) return;
    const packet = Uint8Array.from(this.fed.splice(0, Math.min(room, PACKET)));
    this.room[this.outward] = 0;
    this.usb.endpointReadDone(this.outward, packet, PACKET_US);
  }

  /** Begins the requests that make the device a serial port. */
  meet() {
    this.steps = this.requests();
    this.next();
  }

  *requests() {
    yield { bRequest: SET_ADDRESS, wValue: 1 };
    const device = yield this.descriptor(DEVICE, 0, 0, 18);
    this.ids = { vendor: device[8] | (device[9] << 8), product: device[10] | (device[11] << 8) };
    this.endpoints(yield this.descriptor(DescriptorType.Configration, 0, 0, 255));
    // String 0 lists the languages. The device names the others: manufacturer, product, serial number.
    const languages = yield this.descriptor(STRING, 0, 0, 255);
    const language = languages[2] | (languages[3] << 8);
    for (const index of device.slice(14, 17)) {
      const text = index ? yield this.descriptor(STRING, index, language, 255) : [];
      this.strings.push(Buffer.from(text.slice(2)).toString('utf16le'));
    }
    yield { bRequest: SET_CONFIGURATION, wValue: 1 };
    const [type, recipient] = [SetupType.Class, SetupRecipient.Interface];
    yield { type, recipient, bRequest: SET_CONTROL_LINE_STATE, wValue: OPEN };
    this.isOpen = true;
    this.deliver();
  }

  descriptor(type, index, wIndex, wLength) {
    const dataDirection = DataDirection.DeviceToHost;
    return { dataDirection, bRequest: GET_DESCRIPTOR, wValue: (type << 8) | index, wIndex, wLength };
  }

  /** Sends the next request, with the answer to the last one at hand. */
  next(answer) {
    const { value, done } = this.steps.next(answer);
    if (done) {
      this.asked = undefined;
      return;
    }
    const { HostToDevice: dataDirection } = DataDirection;
    const usual = { dataDirection, type: SetupType.Standard, recipient: SetupRecipient.Device, wIndex: 0, wLength: 0 };
    this.asked = { ...usual, ...value };
    this.answer = [];
    this.usb.sendSetupPacket(createSetupPacket(this.asked));
  }

  /** Takes a packet of the device. */
  take(endpoint, packet) {
    if (endpoint === this.inward) packet.forEach(this.onByte);
    if (endpoint !== 0 || !this.asked) return;
    this.answer.push(...packet);
    // A short packet ends the answer.
    const { wLength } = this.asked;
    if (packet.length < PACKET || this.answer.length >= wLength) this.next(this.answer);
  }

  /** Finds the endpoints of the data in a configuration. */
  endpoints(configuration) {
    let isData = false;
    for (let at = 0; at < configuration.length; at += configuration[at]) {
      const [length, type, address] = configuration.slice(at, at + 3);
      if (length < 2) return;
      if (type === INTERFACE) isData = configuration[at + 5] === DATA_CLASS;
      if (type !== ENDPOINT || !isData) continue;
      if (address & 0x80) this.inward = address & 0xf;
      else this.outward = address;
    }
  }
}
