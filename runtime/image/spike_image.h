// The spike image: the one value that crosses from the compiler to the runtime.
//
// A flat, little-endian file of 64-byte-aligned arrays. It is a build product, not a durable
// format: recompile from the circuit file when the version changes.
//
//   1. FileHeader (64 bytes): magic, version, section count, file size, checksum, tick, seed.
//   2. SectionEntry[section_count]: kind, element size, offset, element count.
//   3. The sections, each starting on a 64-byte boundary, zero padding between.
//
// Neurons are numbered 0..N-1. Populations and update groups are contiguous half-open ranges
// of neurons. Groups are listed in the order in which a tick updates them; a same-tick
// (delay 0) synapse always leads from a group to a later one.
//
// Every receptor of every neuron owns one *slot*, the index of its input accumulator:
//   slot(group, receptor r, neuron i of the group) = group.first_slot + r * group.size + i.
//
// Synapses are CSR rows by presynaptic neuron. A row is a run of segments, one for each
// distinct delay, sorted by delay; a segment is a run of target slots in ascending order.
// Weights are integer quanta: the physical weight is quanta * 2^quantum_log2 of the target's
// receptor. The compiler picks the quantum so that the sum over all synapses onto a slot
// stays below 2^30: a tick's input can never overflow, and integer sums do not depend on order.
//
// Weights that learn (runtime/image/plasticity.h): the image has three sections more, 20 to 22, and only then. The rows
// of such synapses never share a weight with anything else, so that each can be written by itself.
//
// Version history
//   1  first version
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>

namespace tectum {

inline constexpr std::array<char, 8> kImageMagic = {'T', 'E', 'C', 'T', 'U', 'M', '\r', '\n'};
inline constexpr std::uint32_t kImageVersion = 1;
inline constexpr std::size_t kSectionAlignBytes = 64;
inline constexpr std::uint32_t kNoString = std::numeric_limits<std::uint32_t>::max();

enum class NeuronId : std::uint32_t {};
enum class SlotId : std::uint32_t {};
/// Byte offset of a NUL-terminated UTF-8 name in the strings section.
enum class StringId : std::uint32_t {};

enum class SectionKind : std::uint32_t {
  Strings = 1,        // char
  Populations = 2,    // PopulationRecord
  Groups = 3,         // GroupRecord, in update order
  Receptors = 4,      // ReceptorRecord, group by group
  Parameters = 5,     // f64, GroupRecord::parameter_begin
  Columns = 6,        // f64, one value a neuron, GroupRecord::column_begin
  Tables = 7,         // f32 propagator tables, GroupRecord::table_begin
  RowBegin = 8,       // u32[N + 1], first segment of each presynaptic neuron
  Segments = 9,       // SegmentRecord[segments + 1], the last one is a sentinel
  Targets = 10,       // u32 slot
  Weights = 11,       // i32 quanta
  Projections = 12,   // ProjectionRecord, for people and for explanations
  Retinas = 13,       // RetinaRecord
  Fields = 14,        // FieldRecord
  Outputs = 15,       // OutputRecord
  OutputTerms = 16,   // OutputTermRecord
  Joints = 17,        // JointRecord
  Programs = 18,      // u32 words of equation programs (language version 1: optional)
  SourceSpikes = 19,  // u32 pairs (tick, neuron of the group) for spike_list groups, ascending
  // Only in an image that learns:
  Plasticity = 20,       // PlasticityRecord
  PlasticSynapses = 21,  // PlasticSynapseRecord, PlasticityRecord::first_synapse
  Decays = 22,           // f64, PlasticityRecord::first_decay
};

struct FileHeader {
  std::array<char, 8> magic;
  std::uint32_t version;
  std::uint32_t section_count;
  std::uint64_t file_bytes;
  std::uint64_t checksum;  // of every byte of the file, this field read as zero
  std::uint64_t tick_ns;
  std::uint64_t seed;
  std::uint32_t circuit_name;  // StringId
  std::uint32_t neuron_count;
  std::uint32_t slot_count;
  std::uint32_t max_delay_ticks;
};
static_assert(sizeof(FileHeader) == 64);

struct SectionEntry {
  SectionKind kind;
  std::uint32_t element_bytes;
  std::uint64_t offset_bytes;
  std::uint64_t count;
};
static_assert(sizeof(SectionEntry) == 24);

/// What a group computes each tick. Equations, parameters and sources: runtime/image/models.h.
enum class ModelKind : std::uint32_t {
  FieldSource = 1,  // an input neuron: fires every period_ticks while its receptive field is active
  Threshold = 2,
  LifDelta = 3,
  LifExp = 4,
  Alif = 5,
  Izhikevich = 6,
  Poisson = 7,
  SpikeList = 8,
  Program = 9,
};

enum class ReceptorKind : std::uint32_t { Instantaneous = 1, Exponential = 2, Boxcar = 3 };

struct PopulationRecord {
  std::uint32_t name;     // StringId, e.g. "EBN.left"
  std::uint32_t nucleus;  // StringId or kNoString
  std::uint32_t first_neuron;
  std::uint32_t size;
};

enum GroupFlags : std::uint32_t {
  kGroupMaySleep = 1U << 0U,  // part of the semantics, see runtime/README.md
  // bits 8 to 31: which parameters have a column, see kGroupColumnShift in models.h
};

struct GroupRecord {
  ModelKind model;
  std::uint32_t population;  // index into Populations
  std::uint32_t first_neuron;
  std::uint32_t size;
  std::uint32_t first_receptor;
  std::uint32_t receptor_count;
  std::uint32_t first_slot;
  std::uint32_t flags;
  std::uint32_t parameter_begin;
  std::uint32_t parameter_count;
  std::uint32_t column_begin;  // column c of neuron i: Columns[column_begin + c * size + i]
  std::uint32_t column_count;
  std::uint32_t table_begin;
  std::uint32_t table_count;
  std::uint32_t data_begin;  // first u32 word in Programs or SourceSpikes
  std::uint32_t data_count;  // words
};
static_assert(sizeof(GroupRecord) == 64);

struct ReceptorRecord {
  std::uint32_t name;  // StringId: "ex", "in", ...
  ReceptorKind kind;
  std::int32_t quantum_log2;   // physical weight = quanta * 2^quantum_log2, in the model's input unit
  std::uint32_t window_ticks;  // Boxcar only, else 0
};

struct SegmentRecord {
  std::uint32_t delay_ticks;
  std::uint32_t target_begin;  // ends where the next segment's begins
  std::uint32_t weight_begin;  // into Weights: one weight a target, or one for all
  std::uint32_t flags;
};
enum SegmentFlags : std::uint32_t { kSegmentOneWeight = 1U << 0U };

struct ProjectionRecord {
  std::uint32_t name;  // StringId
  std::uint32_t pre_population;
  std::uint32_t post_population;
  std::uint32_t receptor;  // of the postsynaptic group
  std::uint32_t synapse_count;
  std::uint32_t cite;  // StringId: reference keys, comma separated, or kNoString
};

enum class Eye : std::uint32_t { Left = 0, Right = 1 };
inline constexpr std::uint32_t kEyeCount = 2;

/// The scalar that is compared with the threshold to call a pixel lit.
enum class LitChannel : std::uint32_t {
  Red = 1,
  Green = 2,
  Blue = 3,
  Luma = 4,              // (77 R + 150 G + 29 B) / 256
  RedOverGreenBlue = 5,  // R - max(G, B)
  GreenOverRedBlue = 6,  // G - max(R, B)
  BlueOverRedGreen = 7,  // B - max(R, G)
  Brightest = 8,         // max(R, G, B)
};

/// A foveated sheet of receptive fields over one camera's image.
/// The camera frame is cropped to its largest centred square-aspect window of
/// frame_width : frame_height, which is then scaled to frame_width x frame_height reference
/// pixels, so one circuit serves cameras of any resolution.
struct RetinaRecord {
  std::uint32_t name;  // StringId
  Eye eye;
  std::uint32_t frame_width;  // reference pixels
  std::uint32_t frame_height;
  double field_of_view_deg;  // horizontal angle that frame_width spans (pinhole)
  LitChannel lit_channel;
  std::uint32_t lit_above;  // a pixel is lit when channel > lit_above, 0..255
  double lit_share;         // a field is active when lit pixels >= max(1 pixel, share * its pixels)
  std::uint32_t first_field;
  std::uint32_t field_count;
  std::uint32_t first_neuron;  // of the FieldSource group: field k drives neuron first_neuron + k
  std::uint32_t reserved;
};
static_assert(sizeof(RetinaRecord) == 56);

/// Half-open rectangle in reference pixels, y down as in the image.
struct FieldRecord {
  float x0, y0, x1, y1;
};

enum class OutputKind : std::uint32_t {
  Position = 1,  // angle   = offset + sum of gain * rate, gain in deg/Hz
  Velocity = 2,  // d angle/dt       = sum of gain * rate, gain in deg/s/Hz; the joint integrates
};

/// The six joints of the head. Pan is positive to the head's right, tilt positive up.
enum class Joint : std::uint32_t { LeftEyePan, LeftEyeTilt, RightEyePan, RightEyeTilt, NeckPan, NeckTilt };
inline constexpr std::uint32_t kJointCount = 6;
inline constexpr std::array<const char*, kJointCount> kJointNames = {"left_eye_pan",   "left_eye_tilt", "right_eye_pan",
                                                                     "right_eye_tilt", "neck_pan",      "neck_tilt"};

struct OutputRecord {
  std::uint32_t name;  // StringId
  OutputKind kind;
  std::uint32_t first_term;
  std::uint32_t term_count;
  std::uint32_t joint_mask;    // bit j = Joint j receives this output's angle (added to other outputs')
  std::uint32_t window_ticks;  // boxcar over which spikes are counted
  double offset_deg;
};
static_assert(sizeof(OutputRecord) == 32);

/// rate = spikes of neurons [first_neuron, first_neuron + size) in the window / size / window, in Hz.
struct OutputTermRecord {
  std::uint32_t first_neuron;
  std::uint32_t size;
  double gain;  // deg/Hz or deg/s/Hz, signed
};

struct JointRecord {
  Joint joint;
  std::uint32_t reserved;
  double min_deg;
  double max_deg;
  double max_speed_deg_s;  // slew limit of the guard; 0 = none
};

}  // namespace tectum
