// How surfaces are drawn: place = rest + scale * displacement, colour of a value by a texture, edges of elements by the
// barycentric coordinates of their triangles (WIRED), light from the eye in space (LIT).

/** How white edges are: elements of a few pixels would be all edge. */
const EDGE = { most: 0.38, begins: 1.33, fades: 5.5 };

/** How white the edges of elements are that are so many pixels high: see `vWire`. */
export function wireShare(pixels: number): number {
  return EDGE.most * Math.min(Math.max(EDGE.begins - EDGE.fades / pixels, 0), 1);
}

export const SURFACE_VERTEX = /* glsl */ `
in vec3 shift;
in float worth;
uniform float scale;
uniform vec2 ends;
out float vShare; // of the way along the colours
const float UNKNOWN = 1e29;
#ifdef WIRED
uniform float tall;
uniform vec2 size;
uniform int whole;
out vec3 vCorner;
out float vWire;

/** 1 for each side of a triangle that is inside its element, which is drawn in ELEMENT parts, one after the other. */
vec3 innerSides() {
#if ELEMENT == 4
  int part = gl_VertexID / whole;
  return part == 3 ? vec3(1.0) : vec3(part == 0, part == 1, part == 2);
#elif ELEMENT == 2
  return gl_VertexID < whole ? vec3(0.0, 1.0, 0.0) : vec3(0.0, 0.0, 1.0);
#else
  return vec3(0.0);
#endif
}
#endif
#ifdef LIT
out vec3 vPlace, vNormal;
#endif
void main() {
  vShare = worth < UNKNOWN ? (worth - ends.x) / (ends.y - ends.x) : 1e20;
  vec4 place = modelViewMatrix * vec4(position + scale * shift, 1.0);
#ifdef LIT
  vPlace = place.xyz;
  vNormal = (modelViewMatrix * vec4(normal, 0.0)).xyz;
#endif
  gl_Position = projectionMatrix * place;
#ifdef WIRED
  int corner = gl_VertexID % 3;
  vCorner = vec3(corner == 0, corner == 1, corner == 2) + innerSides();
  float pixels = 0.5 * tall * projectionMatrix[1][1] * size.y / gl_Position.w;
  vWire = ${EDGE.most} * clamp(${EDGE.begins} - ${EDGE.fades} / pixels, 0.0, 1.0);
#endif
}`;

export const SURFACE_FRAGMENT = /* glsl */ `
uniform sampler2D map;
uniform vec3 body, glowing;
uniform float glow, coloured;
in float vShare;
#ifdef WIRED
in vec3 vCorner;
in float vWire;
#endif
layout(location = 0) out vec4 shown;

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
  if (coloured > 0.5 && vShare < 1e10) colour = texelFetch(map, ivec2(clamp(256.0 * vShare, 0.0, 255.0), 0), 0).rgb;
#ifdef LIT
  colour = shade(colour);
#endif
#ifdef WIRED
  vec3 near = vCorner / fwidth(vCorner);
  colour += (1.0 - colour) * (vWire * clamp(1.3 - min(near.x, min(near.y, near.z)), 0.0, 1.0));
#endif
  shown = vec4(mix(colour, glowing, glow), 1.0);
}`;
