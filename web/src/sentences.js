/** Sentences of Python, in which names in braces are filled in. */

import { roundHalfEven } from "./rounding.js";

/** A photograph or a frame that cannot be read. */
export class Refusal extends Error {}

export function fill(sentence, values) {
  return sentence.replace(/\{(\w+)\}/g, (_, name) => values[name]);
}

export function toPercent(share) {
  return `${roundHalfEven(100 * share)}%`;
}

export function capitalise(text) {
  return text[0].toUpperCase() + text.slice(1);
}
