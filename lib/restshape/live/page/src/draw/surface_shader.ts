// How surfaces are drawn: place = rest + scale * displacement, colour of a value by a texture, edges of triangles by their
// barycentric coordinates, light from the eye in space (LIT).

export const SURFACE_VERTEX = /* glsl */ `
in vec3 shift;
in float worth;
uniform float scale;
out float vWorth;
out vec3 vCorner;
#ifdef LIT
out vec3 vPlace, vNormal;
#endif
void main() {
  int corner = gl_VertexID % 3;
  vCorner = vec3(corner == 0, corner == 1, corner == 2);
  vWorth = worth;
  vec4 place = modelViewMatrix * vec4(position + scale * shift, 1.0);
#ifdef LIT
  vPlace = place.xyz;
  vNormal = (modelViewMatrix * vec4(normal, 0.0)).xyz;
#endif
  gl_Position = projectionMatrix * place;
}`;

export const SURFACE_FRAGMENT = /* glsl */ `
uniform sampler2D map;
uniform vec2 ends;
uniform vec3 body, glowing;
uniform float glow, wires, coloured;
in float vWorth;
in vec3 vCorner;
layout(location = 0) out vec4 shown;
const float UNKNOWN = 1e29;

#ifdef LIT
in vec3 vPlace, vNormal;
vec3 shade(vec3 colour) {
  vec3 flatly = normalize(cross(dFdx(vPlace), dFdy(vPlace)));
  vec3 smoothly = dot(vNormal, vNormal) > 0.0 ? normalize(vNormal) : flatly;
  if (!gl_FrontFacing) smoothly = -smoothly;
  if (dot(smoothly, flatly) < 0.75) smoothly = flatly; // an edge between faces stays sharp
  return colour * (0.42 + 0.38 * abs(smoothly.z) + 0.2 * max(0.0, dot(smoothly, vec3(-0.45, 0.6, 0.66))));
}
#endif

void main() {
  vec3 colour = body;
  if (coloured > 0.5 && vWorth < UNKNOWN) {
    float t = clamp((vWorth - ends.x) / (ends.y - ends.x), 0.0, 1.0);
    colour = texelFetch(map, ivec2(min(256.0 * t, 255.0), 0), 0).rgb;
  }
#ifdef LIT
  colour = shade(colour);
#endif
  if (wires > 0.0) {
    vec3 width = fwidth(vCorner);
    vec3 near = vCorner / width;
    float edge = clamp(1.3 - min(near.x, min(near.y, near.z)), 0.0, 1.0);
    float large = clamp(1.33 - 3.3 * max(width.x, max(width.y, width.z)), 0.0, 1.0); // of a few pixels they would be all edge
    colour += (1.0 - colour) * (0.38 * wires * edge * large);
  }
  shown = vec4(mix(colour, glowing, glow), 1.0);
}`;
