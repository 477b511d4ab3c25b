// Purposes of random numbers, numbers of connections, and the memory of the renderer's kernels
// besides the scene: parameters, vertices of walks, and data about them. Canonical frame.
#ifndef TDPT_SHADERS_SHARED_PATH_RENDER_LAYOUT_H
#define TDPT_SHADERS_SHARED_PATH_RENDER_LAYOUT_H

#include "shaders/shared/path/point.h"
#include "shaders/shared/records.h"

#include "shaders/shared/language.h"

SHARED_BEGIN

// Purposes of a sample's random numbers: each has its own stream [streams.h of libcommon/math].

const uint PURPOSE_FILM = 0u;  ///< the position within the pixel
const uint PURPOSE_CAMERA_WALK = 1u;
const uint PURPOSE_LIGHT_WALK = 2u;
const uint PURPOSE_NEXT_EVENT = 3u;
const uint PURPOSE_SEGMENT = 4u;  ///< a segment's place on a portal
const uint PURPOSE_CHOICES = 5u;  ///< of vertices to connect

// Maximum numbers of connections per sample.

/// Light vertices considered for one camera vertex; few of them are connected.
const uint kCandidates = 8u;
const float kPerCandidate = 1.25e-1f;
/// For z_{t-1}. Fewer for later vertices, since earlier ones have already shown most of the light.
/// Measured without a depth limit: 1 for all costs 10 to 15 % of the efficiency, 2 for all costs 5
/// to 15 % with guided walks.
SHARED uint connections_of(uint t) {
  return t > 3u ? 1u : 2u;
}
/// Connections of a segment's x_l with light vertices, besides light that begins there.
const uint kLightSides = 2u;
/// Connections of a sample's camera vertices with segments.
const uint kPairs = 3u;

// Techniques, in the order of tdpt::Technique, and their bits.
const uint TECHNIQUE_CAMERA = 0u;
const uint TECHNIQUE_DIRECT = 1u;
const uint TECHNIQUE_LIGHT = 2u;
const uint TECHNIQUE_BI = 3u;
const uint TECHNIQUE_PORTAL = 4u;

/// Shared by all samples of a submission. A group is a cache of samples (light_vertex_cache.h of
/// the renderer) with one sample number; groups are counted cache by cache, then sample by sample.
struct RenderParameters {
  vec3 camera_position;
  float half_width;  ///< of the film, at distance 1
  vec3 camera_right;
  float half_height;
  vec3 camera_up;
  float film_area;
  vec3 camera_forward;
  float beta;  ///< 1: balance heuristic, 2: power heuristic

  word64 seed;
  word64 stream;
  word64 first_sample;  ///< of the first group

  uint width;
  uint height;
  uint first_cache;  ///< of the first group
  uint groups;       ///< of this submission
  uint caches;
  uint per_cache;   ///< samples of a cache; some have one less
  uint walks_full;  ///< light walks of a cache with per_cache samples
  uint walks_less;  ///< light walks of a cache with one sample less

  uint techniques;  ///< bits
  uint max_depth;   ///< longest path [edges]
  float first_direct;
  float later_direct;
  float light_walks;
  float connected;
  float connected_to_segments;
  float segments_connected;
  float segments;
  float through_windows;
  float guide_light;
  float guide_camera;

  uint most_vertices;  ///< number of slots
  // Kernels are specialised for these, for beta and for techniques, and do not read them.
  uint culls;        ///< 1: camera rays pass back faces
  uint transparent;  ///< 1: the sky behind everything is left out
  uint layers;       ///< 1: each technique also has its own layer
  uint halves;       ///< 1: the samples with odd numbers also have their own sums
  // Offsets in the film's words, behind the sums of the picture and its layers.
  uint odd_first;
  uint met_first;
  uint tally_first;
  uint portals_first;
  uint segments_first;  ///< slot of x_l of the first segment; x_c follows
  uint ray_counts_as;   ///< 1, or 2^32 - 1 to subtract what was counted
  uint first_number;    ///< low word of the film's first sample number
  uint pad0;
  uint pad1;
};

// Tally words of each bucket: counts of rays, then sums of four words: energy by technique, by
// length. Behind all buckets: the number of contributions left out, and the places of the first
// few: 2^32 - 1 less the number of the sample among those of this film; 0: none.
const uint RAYS_CLOSEST = 0u;
const uint RAYS_SHADOW = 1u;
const uint RAYS_PORTAL = 2u;
const uint RAYS_CONNECT = 3u;
const uint TALLY_ENERGIES = 4u;
const uint kTallySums = 16u;
const uint kTallyWords = 68u;
const uint kTallyBuckets = 64u;
const uint kLeftOutPlaces = 4u;
const uint kLeftOutWords = 1u + kLeftOutPlaces;
// Of each portal: segments drawn, those that contributed light, and their energy.
const uint kPortalWords = 6u;

/// Push constants: invocation i < count has the slots first + i and next + i.
struct StepParameters {
  uint count;
  uint first;
  uint next;
};

/// A vertex of a walk: its point, and what arrives there.
#define TEXELS_OF_PathVertex(VEC, WORDS, PART)                                                  \
  /* position: at infinity the unit direction in which the light travels */                     \
  VEC(position, uint, triangle)                                                                 \
  /* back: unit, towards the vertex before; 0: the walk begins here */                          \
  VEC(back, uint, source)                                                                       \
  /* throughput: up to here, without emission or scattering here */                             \
  /* per_prev: |cos| / d^2 at the vertex before: converts [1/sr] along the edge to area */      \
  VEC(throughput, float, per_prev)                                                              \
  /* facing: normal on the side of the surface that the path's edges are on; 0: both sides */   \
  /* walk: its number within the submission */                                                  \
  VEC(facing, uint, walk)                                                                       \
  WORDS(float, guide_total_light, float, guide_total_camera, float, guide_total_emitted, float, \
        seen)                                                                                   \
  /* from_light: CrossingDensity of the edge from the vertex before, without D */               \
  /* ordinal: number of connectible vertices between y_0 and this one */                        \
  WORDS(float, sent, float, from_light, float, from_camera, uint, ordinal)                      \
  /* Its point [keep_point()]. */                                                               \
  VEC(normal, uint, material)                                                                   \
  /* made_of: POINT_* */                                                                        \
  VEC(color, uint, made_of)                                                                     \
  /* emission: in the sky, its radiance */                                                      \
  VEC(emission, float, plain_w)
RECORD(PathVertex)
const uint POINT_SIMPLE = 1u;
const uint POINT_CONNECTIBLE = 2u;

/// Additional data of vertices that are not simple.
#define TEXELS_OF_PathBsdf(VEC, WORDS, PART) \
  VEC(shading, float, pad)                   \
  PART(Bsdf, bsdf)
RECORD(PathBsdf)

/// The ray by which a walk leaves its last vertex, and what it hits.
#define TEXELS_OF_WalkRay(VEC, WORDS, PART)                    \
  /* here: slot of that vertex; kNoVertex: it is the camera */ \
  VEC(origin, uint, here)                                      \
  /* flags: RAY_* */                                           \
  VEC(w, uint, flags)                                          \
  /* throughput: for an unguided walk */                       \
  /* polygon: the portal polygon aimed at */                   \
  VEC(throughput, int, polygon)                                \
  /* triangle: hit; kNoTriangle: none */                       \
  WORDS(uint, triangle, float, b1, float, b2, uint, walk)
RECORD(WalkRay)
const uint RAY_THERE = 1u;
const uint RAY_DIRAC = 2u;
const uint RAY_BY_FILM = 4u;

/// Scattering at a path's end between its own direction and another one, w.
#define TEXELS_OF_Scattering(VEC, WORDS, PART)                               \
  /* f: radiance BSDF */                                                     \
  /* onward_w: density of w in this walk */                                  \
  VEC(f, float, onward_w)                                                    \
  /* behind_w: density of the way back in a walk that arrives along -w */    \
  /* survival_behind: of that walk */                                        \
  /* dirac: Odds of this walk */                                             \
  WORDS(float, behind_w, float, survival_behind, float, dirac, float, broad) \
  /* dirac_behind: Odds of the other */                                      \
  WORDS(float, dirac_behind, float, broad_behind, float, pad0, float, pad1)
RECORD(Scattering)

/// Two ends that may be connected: one on the light's side, one on the camera's.
#define TEXELS_OF_Connection(VEC, WORDS, PART)                    \
  /* kind: CONNECTION_* */                                        \
  /* light: slot; for a segment its number */                     \
  /* camera: slot */                                              \
  /* times: number of samples that it stands for */               \
  WORDS(uint, kind, uint, light, uint, camera, float, times)      \
  /* w: unit, from the light's end to the camera's */             \
  VEC(w, float, d2)                                               \
  /* For a next event: the point on a light. */                   \
  VEC(position, uint, source)                                     \
  VEC(normal, uint, triangle)                                     \
  /* radiance: emitted along w */                                 \
  VEC(radiance, float, nee_A)                                     \
  /* pixel: where it is added; for CONNECTION_SIDE the segment */ \
  WORDS(float, light_A, uint, pixel, uint, pad0, uint, pad1)
RECORD(Connection)
const uint CONNECTION_NEXT_EVENT = 0u;
const uint CONNECTION_BI = 1u;
const uint CONNECTION_SPLAT = 2u;
const uint CONNECTION_SIDE = 3u;     ///< of a segment: y with x_l
const uint CONNECTION_SEEN = 4u;     ///< x_c with the camera
const uint CONNECTION_SEGMENT = 5u;  ///< x_c with z

/// What MIS weights need of a vertex [weight.h].
#define TEXELS_OF_PathDensity(VEC, WORDS, PART)                                                  \
  /* own_A: density of the vertex in this walk */                                                \
  /* other_A: in a walk from the other end, without survival; known two vertices later */        \
  /* pair_A: p_AA of the edge from the vertex before: G D [eq. 4] */                             \
  /* nee_A: density of the light point at one end of this edge as a next event from the other */ \
  WORDS(float, own_A, float, other_A, float, pair_A, float, nee_A)                               \
  /* own_survival: survival probability of this walk */                                          \
  /* other_survival: of a walk from the other end, known one vertex later */                     \
  /* prev: slot of the vertex before */                                                          \
  /* flags: its number in the walk, and VERTEX_* */                                              \
  WORDS(float, own_survival, float, other_survival, uint, prev, uint, flags)
RECORD(PathDensity)

/// A light end prepared for connections, in the order of caches and walks, with what estimates need
/// [connection_estimates.h].
#define TEXELS_OF_ConnectionEnd(VEC, WORDS, PART)                                       \
  VEC(position, uint, slot)                                                             \
  /* facing: normal on the side that light leaves from; 0: either side */               \
  /* alpha2: squared GGX alpha if glossy; 0: diffuse; -1: infinitely far */             \
  VEC(facing, float, alpha2)                                                            \
  /* carried: throughput times the diffuse BSDF */                                      \
  /* cosine: of `back` to `normal` */                                                   \
  VEC(carried, float, cosine)                                                           \
  /* f0: throughput times reflectance at normal incidence */                            \
  /* number: in its walk; for x_c the prefixes of its segment's sides, ten bits each */ \
  VEC(f0, uint, number)                                                                 \
  /* more: increase of f0 at grazing incidence */                                       \
  /* light0: for x_c the luminance of its segment's sides */                            \
  VEC(more, float, light0)                                                              \
  VEC(back, float, light1)                                                              \
  VEC(normal, float, light2)
RECORD(ConnectionEnd)

/// A portal segment that a sample has drawn. Its ends are vertices in slots of their own.
#define TEXELS_OF_PortalSegment(VEC, WORDS, PART)                                     \
  /* through: throughput of both ends together, G / p_AA over the share of samples */ \
  /* density: D; 0: there is no segment */                                            \
  VEC(through, float, density)                                                        \
  /* there: bits: which sides bring light */                                          \
  /* lit: how often it has contributed light */                                       \
  WORDS(float, pair_A, uint, portal, uint, there, uint, lit)
RECORD(PortalSegment)
/// Light that arrives at x_l, with all that MIS weights need of that side: densities as in
/// SegmentDensities and Half.
#define TEXELS_OF_SegmentSide(VEC, WORDS, PART)                                      \
  /* slot: of the last vertex of the light prefix; kNoVertex: light begins at x_l */ \
  VEC(value, uint, slot)                                                             \
  WORDS(float, light_A0, float, light_A1, float, first_A, float, second_A)           \
  WORDS(float, pair_before, float, nee_A, float, pad0, float, pad1)
RECORD(SegmentSide)
const uint kSegmentSides = 1u + kLightSides;

// For the weight of a path [weight.h].

/// One chain of a path, from the joint outwards.
GENERIC_STRUCT Half {
  uint slot;      ///< of the vertex next to the joint; kNoVertex: none
  REAL first_A;   ///< its density in a walk from the other end
  REAL second_A;  ///< the same of the vertex behind it
};

/// Densities of a portal segment x_a -> x_{a+1} within a path.
GENERIC_STRUCT SegmentDensities {
  REAL pair_A;    ///< p_AA, positive
  REAL light_A0;  ///< of x_a and of x_{a+1} in a walk from the light
  REAL light_A1;
  REAL camera_A0;  ///< the same in a walk from the camera
  REAL camera_A1;
  REAL pair_before;  ///< p_AA of the edges x_{a-1} -> x_a, x_{a+1} -> x_{a+2}; 0: none
  REAL pair_after;
  REAL nee_A;  ///< for a of 0 or 1: of x_0 as a next event at x_1
};

const uint VERTEX_NUMBER = 0xFFFFu;
const uint VERTEX_THERE = 0x10000u;
const uint VERTEX_DIRAC = 0x20000u;  ///< the walk continued by a Dirac lobe
const uint VERTEX_CONNECTIBLE = 0x40000u;
const uint VERTEX_MET = 0x80000u;  ///< a ray can hit it
const uint VERTEX_INFINITE = 0x100000u;
const uint kNoVertex = 0xFFFFFFFFu;

#ifdef __cplusplus
static_assert(sizeof(PathVertex) == 144 && sizeof(PathBsdf) == 128 && sizeof(PathDensity) == 32);
static_assert(sizeof(ConnectionEnd) == 112 && sizeof(WalkRay) == 64 && sizeof(Scattering) == 48);
static_assert(sizeof(Connection) == 96 && sizeof(PortalSegment) == 32 && sizeof(SegmentSide) == 48);
static_assert(sizeof(RenderParameters) == 224);
#endif

SHARED_END

#include "shaders/shared/language_end.h"

#endif
