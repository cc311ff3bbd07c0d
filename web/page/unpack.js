// SPDX-License-Identifier: Apache-2.0
// In the worker: the module is packed with LZMA, which browsers do not unpack themselves; it is a
// sixth smaller than with what they do unpack.

'use strict';

/** Content of an .lzma file whose size its header states [LZMA-SDK, lzma-specification.txt].
 *  The first byte holds the numbers of bits of context: of the byte before (lc), of the place of a
 *  byte (lp) and of a match (pb). */
function unpackLzma(packed) {
  const header = new DataView(packed.buffer, packed.byteOffset, 18);
  const [lc, lp, pb] = [packed[0] % 9, Math.floor(packed[0] / 9) % 5, Math.floor(packed[0] / 45)];
  const size = header.getUint32(5, true);
  const out = new Uint8Array(size);

  // Probabilities of all the binary decisions, in 1/2048, side by side in one array.
  const MATCH = 0, REP = 192, REP_G0 = 204, REP_G1 = 216, REP_G2 = 228, REP0_LONG = 240, SLOT = 432, FAR = 688,
    ALIGN = 816, LENGTH = 832, REP_LENGTH = LENGTH + 514, LITERAL = REP_LENGTH + 514;
  const odds = new Uint16Array(LITERAL + (0x300 << (lc + lp))).fill(1024);

  // The coder begins behind the header, with a byte that is zero.
  let at = 18, code = header.getUint32(14), range = 0xffffffff;

  function bit(index) {
    const bound = (range >>> 11) * odds[index];
    let one;
    if (code < bound) {
      range = bound;
      odds[index] += (2048 - odds[index]) >> 5;
      one = 0;
    } else {
      range -= bound;
      code -= bound;
      odds[index] -= odds[index] >> 5;
      one = 1;
    }
    if (range < 0x1000000) {
      range = (range << 8) >>> 0;
      code = ((code << 8) | packed[at++]) >>> 0;
    }
    return one;
  }

  /** `count` bits of even odds. */
  function plain(count) {
    let value = 0;
    while (count--) {
      range >>>= 1;
      const one = code >= range ? 1 : 0;
      if (one) code -= range;
      value = value * 2 + one;
      if (range < 0x1000000) {
        range = (range << 8) >>> 0;
        code = ((code << 8) | packed[at++]) >>> 0;
      }
    }
    return value;
  }

  /** `count` bits, each with odds that depend on those before. */
  function tree(index, count) {
    let value = 1;
    for (let i = 0; i < count; i++) value = 2 * value + bit(index + value);
    return value - (1 << count);
  }

  /** The same, with the lowest bit first. */
  function reverse(index, count) {
    let node = 1, value = 0;
    for (let i = 0; i < count; i++) {
      const one = bit(index + node);
      node = 2 * node + one;
      value |= one << i;
    }
    return value;
  }

  function length(index, place) {
    if (!bit(index)) return 2 + tree(index + 2 + 8 * place, 3);
    if (!bit(index + 1)) return 10 + tree(index + 130 + 8 * place, 3);
    return 18 + tree(index + 258, 8);
  }

  function distance(long) {
    const slot = tree(SLOT + 64 * Math.min(long - 2, 3), 6);
    if (slot < 4) return slot;
    const count = (slot >> 1) - 1, first = (2 | (slot & 1)) << count;
    if (slot < 14) return first + reverse(FAR + first - slot, count);
    return first + 16 * plain(count - 4) + reverse(ALIGN, 4);
  }

  let done = 0, state = 0, back = 0, back1 = 0, back2 = 0, back3 = 0;

  function literal() {
    const before = done ? out[done - 1] : 0;
    const index = LITERAL + 0x300 * (((done & ((1 << lp) - 1)) << lc) + (before >> (8 - lc)));
    let value = 1;
    if (state >= 7) {
      // What the last distance would give is known to be wrong.
      let match = out[done - back - 1];
      do {
        const expected = (match >> 7) & 1;
        match <<= 1;
        const one = bit(index + ((1 + expected) << 8) + value);
        value = 2 * value + one;
        if (one !== expected) break;
      } while (value < 256);
    }
    while (value < 256) value = 2 * value + bit(index + value);
    out[done++] = value;
    state = state < 4 ? 0 : state < 10 ? state - 3 : state - 6;
  }

  function takeOlder() {
    let taken;
    if (!bit(REP_G1 + state)) taken = back1;
    else {
      if (!bit(REP_G2 + state)) taken = back2;
      else {
        taken = back3;
        back3 = back2;
      }
      back2 = back1;
    }
    back1 = back;
    back = taken;
  }

  while (done < size) {
    const place = done & ((1 << pb) - 1);
    if (!bit(MATCH + 16 * state + place)) {
      literal();
      continue;
    }
    let long;
    if (bit(REP + state)) {
      if (bit(REP_G0 + state)) takeOlder();
      else if (!bit(REP0_LONG + 16 * state + place)) {
        state = state < 7 ? 9 : 11;
        out[done] = out[done - back - 1];
        done++;
        continue;
      }
      long = length(REP_LENGTH, place);
      state = state < 7 ? 8 : 11;
    } else {
      [back3, back2, back1] = [back2, back1, back];
      long = length(LENGTH, place);
      back = distance(long);
      state = state < 7 ? 7 : 10;
    }
    if (back >= done) throw new Error('the page is damaged: load it again');
    for (const end = Math.min(size, done + long); done < end; done++) out[done] = out[done - back - 1];
  }
  return out;
}

/** Bytes of a text in base 64. */
function bytesOf(text) {
  const letters = atob(text.trim());
  const bytes = new Uint8Array(letters.length);
  for (let i = 0; i < bytes.length; i++) bytes[i] = letters.charCodeAt(i);
  return bytes;
}

if (typeof module !== 'undefined') module.exports = { unpackLzma };
