// SPDX-License-Identifier: Apache-2.0
// The system that the module sees: WASI preview 1 with one folder of files in memory. A file is
// bytes, or a Blob that is read piece by piece, so a log of gigabytes is never in memory as a whole.
//
//   const system = new PageSystem({ words, files, warn });
//   const { exports } = await WebAssembly.instantiate(module, system.imports);
//   const code = system.run(exports);        // also system.text(1), system.files

'use strict';

/** Thrown by proc_exit() to leave the module. */
class PageExit {
  constructor(code) {
    this.code = code;
  }
}

/** Bytes that grow. */
class GrowingBytes {
  constructor(bytes) {
    this.bytes = bytes || new Uint8Array(4096);
    this.size = bytes ? bytes.length : 0;
  }

  write(at, from) {
    const end = at + from.length;
    if (end > this.bytes.length) {
      const larger = new Uint8Array(Math.max(end, 2 * this.bytes.length));
      larger.set(this.bytes.subarray(0, this.size));
      this.bytes = larger;
    }
    this.bytes.set(from, at);
    this.size = Math.max(this.size, end);
  }

  read(at, into) {
    const count = Math.max(0, Math.min(into.length, this.size - at));
    into.set(this.bytes.subarray(at, at + count));
    return count;
  }

  content() {
    return this.bytes.slice(0, this.size);
  }
}

/** A Blob, read in pieces of some MB by FileReaderSync, which only workers have. */
class BlobBytes {
  constructor(blob) {
    this.blob = blob;
    this.size = blob.size;
    this.begin = 0;
    this.piece = new Uint8Array(0);
    this.reader = new FileReaderSync();
  }

  read(at, into) {
    const wanted = Math.max(0, Math.min(into.length, this.size - at));
    let done = 0;
    while (done < wanted) {
      const place = at + done;
      if (place < this.begin || place >= this.begin + this.piece.length) {
        const end = Math.min(this.size, place + BlobBytes.PIECE);
        this.piece = new Uint8Array(this.reader.readAsArrayBuffer(this.blob.slice(place, end)));
        this.begin = place;
      }
      const from = place - this.begin;
      const count = Math.min(wanted - done, this.piece.length - from);
      into.set(this.piece.subarray(from, from + count), done);
      done += count;
    }
    return wanted;
  }
}
BlobBytes.PIECE = 4 << 20;

/** Numbers of errors in WASI. */
const WASI_ERROR = { badf: 8, exist: 20, inval: 28, isdir: 31, noent: 44, nosys: 52, notsup: 58, rofs: 69, spipe: 70 };

class PageSystem {
  /** words: of the command line. files: Map of names to Uint8Array or Blob. warn: is called with
   *  what is written to standard error, as it comes. environment: of names to texts. */
  constructor({ words, files, warn, environment }) {
    this.words = words;
    this.environment = { NO_COLOR: '1', ...environment };
    this.warn = warn || (() => {});
    this.files = new Map();
    for (const [name, content] of files || [])
      this.files.set(name, content instanceof Uint8Array ? new GrowingBytes(content) : new BlobBytes(content));
    this.output = [null, new GrowingBytes(), new GrowingBytes()];
    // 0-2: standard streams; 3: the folder.
    this.open = [{ stream: 0 }, { stream: 1 }, { stream: 2 }, { folder: true }];
    this.decoder = new TextDecoder();
    this.encoder = new TextEncoder();
    this.imports = { wasi_snapshot_preview1: this.functions() };
  }

  /** What was written to standard output (1) or standard error (2). */
  text(stream) {
    return this.decoder.decode(this.output[stream].content());
  }

  /** Content of a file that the module has written; undefined without it. */
  file(name) {
    const found = this.files.get(name);
    return found && found.content ? found.content() : undefined;
  }

  /** Do what the words say. @return the exit code */
  run(exports) {
    this.memory = exports.memory;
    try {
      exports._initialize();
      const list = exports.malloc(4 * (this.words.length + 1));
      const places = this.words.map((word) => {
        const bytes = this.encoder.encode(word + '\0');
        const at = exports.malloc(bytes.length);
        this.bytes(at, bytes.length).set(bytes);
        return at;
      });
      const view = this.view();
      places.concat(0).forEach((place, i) => view.setUint32(list + 4 * i, place, true));
      return exports.run(this.words.length, list);
    } catch (reason) {
      if (reason instanceof PageExit) return reason.code;
      throw reason;
    }
  }

  view() {
    return new DataView(this.memory.buffer);
  }

  bytes(at, size) {
    return new Uint8Array(this.memory.buffer, at, size);
  }

  string(at, size) {
    return this.decoder.decode(this.bytes(at, size).slice());
  }

  name(at, size) {
    return this.string(at, size).replace(/^(\.?\/)+/, '');
  }

  /** Call `act` with each piece of a scattered buffer. */
  pieces(list, count, act) {
    const view = this.view();
    let total = 0;
    for (let i = 0; i < count; i++) {
      const size = view.getUint32(list + 8 * i + 4, true);
      const done = act(this.bytes(view.getUint32(list + 8 * i, true), size));
      total += done;
      if (done < size) break;
    }
    return total;
  }

  put32(at, value) {
    this.view().setUint32(at, value, true);
    return 0;
  }

  put64(at, value) {
    this.view().setBigUint64(at, BigInt(value), true);
    return 0;
  }

  stat(at, type, size, inode) {
    this.bytes(at, 64).fill(0);
    const view = this.view();
    view.setBigUint64(at, 1n, true);
    view.setBigUint64(at + 8, BigInt(inode), true);
    view.setUint8(at + 16, type);
    view.setBigUint64(at + 24, 1n, true);
    view.setBigUint64(at + 32, BigInt(size), true);
    return 0;
  }

  texts(list, table, storage) {
    const view = this.view();
    for (const text of list) {
      const bytes = this.encoder.encode(text + '\0');
      view.setUint32(table, storage, true);
      this.bytes(storage, bytes.length).set(bytes);
      table += 4;
      storage += bytes.length;
    }
    return 0;
  }

  sizes(list, count, size) {
    this.put32(count, list.length);
    return this.put32(size, list.reduce((sum, text) => sum + this.encoder.encode(text).length + 1, 0));
  }

  inode(name) {
    return 100 + [...this.files.keys()].indexOf(name);
  }

  functions() {
    const E = WASI_ERROR;
    const variables = Object.entries(this.environment).map(([key, value]) => `${key}=${value}`);
    const file = (fd) => this.open[fd] && this.open[fd].content;
    const known = {
      args_sizes_get: (count, size) => this.sizes(this.words, count, size),
      args_get: (table, storage) => this.texts(this.words, table, storage),
      environ_sizes_get: (count, size) => this.sizes(variables, count, size),
      environ_get: (table, storage) => this.texts(variables, table, storage),
      clock_time_get: (id, precision, at) =>
        this.put64(at, Math.round((id === 0 ? Date.now() : performance.now()) * 1e6)),
      clock_res_get: (id, at) => this.put64(at, 1000),
      random_get: (at, size) => (crypto.getRandomValues(this.bytes(at, size)), 0),
      sched_yield: () => 0,
      proc_exit: (code) => {
        throw new PageExit(code);
      },
      fd_prestat_get: (fd, at) => {
        if (!this.open[fd] || !this.open[fd].folder) return E.badf;
        this.put32(at, 0);
        return this.put32(at + 4, 1);
      },
      fd_prestat_dir_name: (fd, at) => (this.bytes(at, 1).set([0x2f]), 0),
      fd_fdstat_get: (fd, at) => {
        const open = this.open[fd];
        if (!open) return E.badf;
        this.bytes(at, 24).fill(0);
        const view = this.view();
        // Standard error is a terminal: so the verbs tell how far they are.
        view.setUint8(at, open.folder ? 3 : open.stream === 2 ? 2 : 4);
        const rights = open.stream === undefined ? ~0n : ~0x24n; // streams do not seek or tell
        view.setBigUint64(at + 8, BigInt.asUintN(64, rights), true);
        view.setBigUint64(at + 16, BigInt.asUintN(64, rights), true);
        return 0;
      },
      fd_fdstat_set_flags: () => 0,
      fd_filestat_get: (fd, at) => {
        const open = this.open[fd];
        if (!open) return E.badf;
        if (open.folder) return this.stat(at, 3, 0, 1);
        return open.content
          ? this.stat(at, 4, open.content.size, open.inode)
          : this.stat(at, open.stream === 2 ? 2 : 6, 0, 2 + open.stream);
      },
      fd_filestat_set_size: (fd, size) => {
        if (!file(fd)) return E.badf;
        file(fd).size = Number(size);
        return 0;
      },
      path_filestat_get: (fd, flags, at, size, into) => {
        const name = this.name(at, size);
        if (name === '' || name === '.') return this.stat(into, 3, 0, 1);
        const found = this.files.get(name);
        return found ? this.stat(into, 4, found.size, this.inode(name)) : E.noent;
      },
      path_open: (fd, lookup, at, size, how, rights, inheriting, flags, into) => {
        const name = this.name(at, size);
        let content = this.files.get(name);
        if (name === '' || name === '.') {
          this.open.push({ folder: true });
          return this.put32(into, this.open.length - 1);
        }
        if (content && how & 4) return E.exist; // O_EXCL
        if (!content && !(how & 1)) return E.noent; // O_CREAT
        if (how & 2) return E.noent; // O_DIRECTORY
        if (!content || how & 8) {
          content = new GrowingBytes(); // O_TRUNC
          this.files.set(name, content);
        }
        this.open.push({ content, at: 0, inode: this.inode(name), append: (flags & 1) !== 0 });
        return this.put32(into, this.open.length - 1);
      },
      fd_close: (fd) => {
        if (!this.open[fd]) return E.badf;
        this.open[fd] = undefined;
        return 0;
      },
      fd_read: (fd, list, count, into) => {
        const open = this.open[fd];
        if (!open || open.folder) return E.badf;
        if (!open.content) return this.put32(into, 0);
        return this.put32(into, this.pieces(list, count, (piece) => {
          const done = open.content.read(open.at, piece);
          open.at += done;
          return done;
        }));
      },
      fd_pread: (fd, list, count, offset, into) => {
        if (!file(fd)) return E.spipe;
        let at = Number(offset);
        return this.put32(into, this.pieces(list, count, (piece) => {
          const done = file(fd).read(at, piece);
          at += done;
          return done;
        }));
      },
      fd_write: (fd, list, count, into) => {
        const open = this.open[fd];
        if (!open || open.folder || open.stream === 0) return E.badf;
        if (open.content && !open.content.write) return E.rofs;
        return this.put32(into, this.pieces(list, count, (piece) => {
          if (open.content) {
            if (open.append) open.at = open.content.size;
            open.content.write(open.at, piece);
            open.at += piece.length;
          } else {
            this.output[open.stream].write(this.output[open.stream].size, piece);
            if (open.stream === 2) this.warn(this.decoder.decode(piece.slice()));
          }
          return piece.length;
        }));
      },
      fd_pwrite: (fd, list, count, offset, into) => {
        if (!file(fd) || !file(fd).write) return E.spipe;
        let at = Number(offset);
        return this.put32(into, this.pieces(list, count, (piece) => {
          file(fd).write(at, piece);
          at += piece.length;
          return piece.length;
        }));
      },
      fd_seek: (fd, offset, whence, into) => {
        const open = this.open[fd];
        if (!open || !open.content) return E.spipe;
        const from = [0, open.at, open.content.size][whence];
        const at = from + Number(offset);
        if (!(at >= 0)) return E.inval;
        open.at = at;
        return this.put64(into, at);
      },
      fd_tell: (fd, into) => (file(fd) ? this.put64(into, this.open[fd].at) : E.spipe),
      fd_sync: () => 0,
      fd_datasync: () => 0,
      fd_readdir: (fd, at, size, cookie, into) => this.put32(into, 0),
      path_unlink_file: (fd, at, size) => (this.files.delete(this.name(at, size)) ? 0 : E.noent),
      path_rename: (fd, from, fromSize, to, toAt, toSize) => {
        const name = this.name(from, fromSize);
        const content = this.files.get(name);
        if (!content) return E.noent;
        this.files.delete(name);
        this.files.set(this.name(toAt, toSize), content);
        return 0;
      },
      path_readlink: () => E.inval,
    };
    // What is not known is not there.
    return new Proxy(known, { get: (all, name) => all[name] || (() => E.nosys), has: () => true });
  }
}

if (typeof module !== 'undefined') module.exports = { PageSystem, PageExit };
