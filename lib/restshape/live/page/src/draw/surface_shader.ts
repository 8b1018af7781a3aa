// How surfaces are drawn: place = rest + scale * displacement, colour of a value by a texture, edges of triangles by their
// barycentric coordinates, light from the eye in space.

export const SURFACE_VERTEX = /* glsl */ `
in vec3 shift;
in float worth;
uniform float scale;
out float vWorth;
out vec3 vCorner, vPlace, vNormal;
void main() {
  int corner = gl_VertexID % 3;
  vCorner = vec3(corner == 0, corner == 1, corner == 2);
  vWorth = worth;
  vec4 place = modelViewMatrix * vec4(position + scale * shift, 1.0);
  vPlace = place.xyz;
  vNormal = (modelViewMatrix * vec4(normal, 0.0)).xyz;
  gl_Position = projectionMatrix * place;
}`;

export const SURFACE_FRAGMENT = /* glsl */ `
uniform sampler2D map;
uniform vec2 ends;
uniform vec3 body, glowing;
uniform float glow, wires, lit, coloured, opacity;
in float vWorth;
in vec3 vCorner, vPlace, vNormal;
layout(location = 0) out vec4 shown;
const float UNKNOWN = 1e29;

vec3 shade(vec3 colour) {
  vec3 flatly = normalize(cross(dFdx(vPlace), dFdy(vPlace)));
  vec3 smoothly = dot(vNormal, vNormal) > 0.0 ? normalize(vNormal) : flatly;
  if (!gl_FrontFacing) smoothly = -smoothly;
  if (dot(smoothly, flatly) < 0.75) smoothly = flatly; // an edge between faces stays sharp
  float light = 0.42 + 0.38 * abs(smoothly.z) + 0.2 * max(0.0, dot(smoothly, vec3(-0.45, 0.6, 0.66)));
  return colour * light;
}

void main() {
  float t = (vWorth - ends.x) / (ends.y - ends.x);
  vec3 colour = coloured > 0.5 && vWorth < UNKNOWN ? texture(map, vec2((0.5 + 255.0 * clamp(t, 0.0, 1.0)) / 256.0, 0.5)).rgb : body;
  if (lit > 0.5) colour = shade(colour);
  if (wires > 0.0) {
    vec3 width = fwidth(vCorner);
    vec3 near = smoothstep(vec3(0.0), width * 1.2, vCorner);
    float edge = 1.0 - min(near.x, min(near.y, near.z));
    float small = max(width.x, max(width.y, width.z)); // triangles of a few pixels would be all edge
    colour = mix(colour, vec3(1.0), 0.38 * wires * edge * (1.0 - smoothstep(0.1, 0.4, small)));
  }
  shown = vec4(mix(colour, glowing, glow), opacity);
}`;
