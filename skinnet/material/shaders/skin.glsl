// Skin from the volume fractions of melanin and hemoglobin: albedo in linear sRGB.
// Written by skinnet $version for light $light and camera $camera. GLSL 3.30 and ES 3.00 and later.
//
// table: $table.exr or $table.png as it is, without conversion of colours. Filter LINEAR, wrap
// CLAMP_TO_EDGE. The last row of the file is at v = 0; most engines turn pictures so.

struct SkinEdit {
  float melanin_factor;     // 1 changes nothing
  float melanin_add;        // volume fraction
  float hemoglobin_factor;  // 1 changes nothing
  float hemoglobin_add;     // volume fraction
  float flush;              // share of blood that is added; 1 doubles it, -1 takes all
  float flush_mask;         // where the flush is: 0 to 1
  float pulse;              // share of blood that each heartbeat adds
  float pulse_rate;         // beats per minute
  float time;               // s
};

const SkinEdit SKIN_UNCHANGED = SkinEdit(1.0, 0.0, 1.0, 0.0, 0.0, 1.0, 0.0, 70.0, 0.0);

float skin_wave(float beats) { return 0.5 - 0.5 * cos(6.28318531 * fract(beats)); }

vec2 skin_pigments(float melanin, float hemoglobin, SkinEdit edit) {
  float wave = skin_wave(edit.pulse_rate * edit.time / 60.0);
  float blood = 1.0 + edit.flush * edit.flush_mask + edit.pulse * wave;
  return clamp(vec2(melanin * edit.melanin_factor + edit.melanin_add,
                    (hemoglobin * edit.hemoglobin_factor + edit.hemoglobin_add) * blood),
               0.0, 1.0);
}

vec3 skin_colour(sampler2D table, vec2 pigments) {
  const vec2 spacing = vec2($melanin_spacing, $hemoglobin_spacing);
  const vec2 nodes = vec2($columns.0, $rows.0);
  vec2 position = log(1.0 + clamp(pigments, 0.0, 1.0) / spacing) / log(1.0 + 1.0 / spacing);
  return textureLod(table, (position * (nodes - 1.0) + 0.5) / nodes, 0.0).rgb;
}

// What is not skin in the texture that the maps were made from: its linear sRGB less that of skin.
vec3 skin_offset(sampler2D table, float melanin, float hemoglobin, vec3 original) {
  return original - skin_colour(table, vec2(melanin, hemoglobin));
}

// offset: as of skin_offset, or 0. It darkens with the skin, and never grows.
// weight: how far edits apply: the map of skin, or 1.
vec3 skin_albedo(sampler2D table, float melanin, float hemoglobin, vec3 offset, float weight,
                 SkinEdit edit) {
  vec2 pigments = vec2(melanin, hemoglobin);
  vec2 edited = mix(pigments, skin_pigments(melanin, hemoglobin, edit), weight);
  vec3 before = skin_colour(table, pigments), after = skin_colour(table, edited);
  vec3 ratio = clamp(max(after, 1e-6) / max(before, 1e-6), 0.0, 1.0);
  return max(after + offset * ratio, 0.0);
}
