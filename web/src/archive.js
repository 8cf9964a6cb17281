/** NumPy files of planes, and ZIP archives that hold files without compression. */

/** A .npy file of float32 [height, width]. */
export function writeNpy(plane, width, height) {
  const text = `{'descr': '<f4', 'fortran_order': False, 'shape': (${height}, ${width}), }`;
  const length = Math.ceil((10 + text.length + 1) / 64) * 64 - 10;
  const header = new Uint8Array(10 + length).fill(32);
  header.set([0x93, 78, 85, 77, 80, 89, 1, 0, length & 255, length >> 8]);
  header.set(new TextEncoder().encode(text), 10);
  header[header.length - 1] = 10;
  const values = new Uint8Array(plane.buffer, plane.byteOffset, plane.byteLength);
  const file = new Uint8Array(header.length + values.length);
  file.set(header);
  file.set(values, header.length);
  return file;
}

/** A ZIP archive of files {name: bytes}. */
export function writeZip(files) {
  const parts = [];
  const directory = [];
  let place = 0;
  for (const [name, bytes] of Object.entries(files)) {
    const path = new TextEncoder().encode(name);
    const common = describe(bytes, path.length);
    const local = pack([[4, 0x04034b50], ...common]);
    parts.push(local, path, bytes);
    const entry = [[4, 0x02014b50], [2, 20], ...common, [2, 0], [2, 0], [2, 0], [4, 0], [4, place]];
    directory.push(pack(entry), path);
    place += local.length + path.length + bytes.length;
  }
  const count = Object.keys(files).length;
  const length = directory.reduce((sum, part) => sum + part.length, 0);
  const end = [[4, 0x06054b50], [2, 0], [2, 0], [2, count], [2, count], [4, length], [4, place]];
  return new Blob([...parts, ...directory, pack([...end, [2, 0]])], { type: "application/zip" });
}

/** Version, flags, method, time, date, checksum, sizes and name length of a file's entry. */
function describe(bytes, nameLength) {
  const [time, day] = [0, (46 << 9) | (1 << 5) | 1];
  return [
    [2, 20], [2, 0], [2, 0], [2, time], [2, day], [4, computeChecksum(bytes)],
    [4, bytes.length], [4, bytes.length], [2, nameLength], [2, 0],
  ];
}

/** Numbers [[bytes, value], ...] one after the other, the lowest byte first. */
function pack(numbers) {
  return Uint8Array.from(
    numbers.flatMap(([size, value]) =>
      Array.from({ length: size }, (_, at) => (value / 2 ** (8 * at)) & 255),
    ),
  );
}

const TABLE = Uint32Array.from({ length: 256 }, (_, byte) => {
  let value = byte;
  for (let bit = 0; bit < 8; bit++) value = value & 1 ? (value >>> 1) ^ 0xedb88320 : value >>> 1;
  return value;
});

/** CRC-32. */
function computeChecksum(bytes) {
  let checksum = 0xffffffff;
  for (const byte of bytes) checksum = TABLE[(checksum ^ byte) & 255] ^ (checksum >>> 8);
  return (checksum ^ 0xffffffff) >>> 0;
}
