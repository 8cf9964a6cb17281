/** Skin of one face among others. */

const FACE = 0.65; // radius of a face, in sides of its box
const NECK = 1.2; // distance from the middle of a face to the end of the neck, in the same

/** Set a mask of a box to 0 where another face is nearer, measured in sides of each face. */
export function keepOwnSkin(mask, width, height, box, face, others) {
  if (!others.length) return;
  for (let at = 0; at < mask.length; at++) {
    const x = box.left + (((at % width) + 0.5) * (box.right - box.left)) / width;
    const y = box.top + ((Math.floor(at / width) + 0.5) * (box.bottom - box.top)) / height;
    const own = measureDistance(face, x, y);
    if (others.some((other) => measureDistance(other, x, y) < own)) mask[at] = 0;
  }
}

/** Distance from the line between the middle of a face and its neck; less within the face. */
function measureDistance({ box, tilt }, x, y) {
  const angle = (tilt * Math.PI) / 180;
  const side = box.right - box.left;
  const right = (x - (box.left + box.right) / 2) / side;
  const below = (y - (box.top + box.bottom) / 2) / side;
  const across = right * Math.cos(angle) + below * Math.sin(angle);
  const along = below * Math.cos(angle) - right * Math.sin(angle);
  const within = Math.hypot(across, along);
  if (within < FACE) return within - 1;
  return Math.hypot(across, along - Math.min(Math.max(along, 0), NECK));
}
