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

vec3 skin_albedo(sampler2D table, float melanin, float hemoglobin, vec3 offset, SkinEdit edit) {
  const vec2 spacing = vec2($melanin_spacing, $hemoglobin_spacing);
  const vec2 nodes = vec2($columns.0, $rows.0);
  vec2 fraction = skin_pigments(melanin, hemoglobin, edit);
  vec2 position = log(1.0 + fraction / spacing) / log(1.0 + 1.0 / spacing);
  vec2 uv = (position * (nodes - 1.0) + 0.5) / nodes;
  return max(textureLod(table, uv, 0.0).rgb + offset, 0.0);
}
