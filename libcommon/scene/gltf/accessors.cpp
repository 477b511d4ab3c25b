#include "libcommon/scene/gltf/accessors.h"

#include <fmt/format.h>
#include <cmath>
#include <cstring>

namespace tdpt::gltf {
namespace {

// In the order of ElementType.
constexpr const char* kTypes[] = {"SCALAR", "VEC2", "VEC3", "VEC4", "MAT2", "MAT3", "MAT4"};
constexpr size_t kComponents[] = {1, 2, 3, 4, 4, 9, 16};

/// A scalar, a vector or a matrix of 4 x 4.
ElementType type_of(size_t components) {
  return components == 16 ? ElementType::mat4 : static_cast<ElementType>(components - 1);
}

/// `count` elements, `stride` bytes apart, all inside a buffer.
struct Elements {
  const char* data;
  size_t stride, count;
};

template <class T>
T load(const char* at) {
  T value;
  std::memcpy(&value, at, sizeof value);  // accessors of foreign files may be unaligned
  return value;
}

bool is_unsigned(int component_type) {
  return component_type == kU8 || component_type == kU16;
}

uint32_t load_index(const char* at, int type) {
  if (type == kU8) return load<uint8_t>(at);
  if (type == kU16) return load<uint16_t>(at);
  return load<uint32_t>(at);
}

double load_component(const char* at, int type, bool normalized) {
  switch (type) {
    case kI8:
      return normalized ? std::max(load<int8_t>(at) / 127.0, -1.0) : load<int8_t>(at);
    case kU8:
      return normalized ? load<uint8_t>(at) / 255.0 : load<uint8_t>(at);
    case kI16:
      return normalized ? std::max(load<int16_t>(at) / 32767.0, -1.0) : load<int16_t>(at);
    case kU16:
      return normalized ? load<uint16_t>(at) / 65535.0 : load<uint16_t>(at);
    default:
      return load<float>(at);
  }
}

/// Locates `count` elements of `size` bytes; avoids multiplication, so nothing can overflow.
Elements elements(const Document& d, const std::string& where, size_t view, size_t offset,
                  size_t count, size_t size, bool may_stride) {
  const std::string_view bytes = view_bytes(d, view);
  const size_t declared = d.views[view].stride;
  const size_t stride = declared > 0 && may_stride ? declared : size;
  if (stride < size)
    d.fail(where,
           fmt::format("elements of {} bytes do not fit the byteStride {} of bufferViews[{}]", size,
                       stride, view));
  const size_t left = offset <= bytes.size() ? bytes.size() - offset : 0;
  if (left < size || count - 1 > (left - size) / stride)
    d.fail(where, fmt::format("{} elements, {} bytes apart, from byte {} reach beyond "
                              "bufferViews[{}] of {} bytes",
                              count, stride, offset, view, bytes.size()));
  return {bytes.data() + offset, stride, count};
}

/// Iterates over a sparse accessor: calls `set(element, bytes of its value)` for each replaced
/// element.
template <class Set>
void apply_sparse(const Document& d, const std::string& accessor, const Accessor& a, size_t size,
                  const Set& set) {
  if (!a.sparse) return;
  const Sparse& sparse = *a.sparse;
  const std::string where = accessor + ".sparse";
  const int type = sparse.index_type;
  const size_t count = sparse.count;
  const Elements index = elements(d, where + ".indices", sparse.index_view, sparse.index_offset,
                                  count, bytes_of_component(type), false);
  const Elements value =
      elements(d, where + ".values", sparse.value_view, sparse.value_offset, count, size, false);
  for (size_t i = 0; i < count; ++i) {
    const uint32_t k = load_index(index.data + i * index.stride, type);
    if (k >= a.count)
      d.fail(where + ".indices",
             fmt::format("index {} is out of range, the accessor has {} elements", k, a.count));
    set(k, value.data + i * value.stride);
  }
}

/// Calls `set(element, its first component, distance of components)` for each element, `most` at
/// most, that is stored in the accessor's bufferView, from `first` on, or among its sparse values.
/// Without a bufferView the other elements are zero.
template <class Set>
void for_elements(const Document& d, const std::string& where, const Accessor& a, size_t components,
                  const Set& set, size_t first = 0, size_t most = SIZE_MAX) {
  const size_t size = components * bytes_of_component(a.component_type);
  if (a.view >= 0) {
    const Elements e =
        elements(d, where, static_cast<size_t>(a.view), a.offset, a.count, size, true);
    for (size_t i = first; i < e.count && i - first < most; ++i) set(i, e.data + i * e.stride);
  } else if (a.count > d.bytes.size()) {
    // Elements without a bufferView are zero except for sparse values: a tiny file could declare
    // any count, so it is bounded by the file's size.
    d.fail(where, fmt::format("{} elements without a bufferView, expected at most {}, the bytes "
                              "of the file",
                              a.count, d.bytes.size()));
  }
  apply_sparse(d, where, a, size, [&](uint32_t k, const char* at) { set(k, at); });
}

Sparse read_sparse(const Value& v) {
  Sparse out;
  out.count = v["count"].needed().integer(0, 1);
  const Value indices = v["indices"].needed(), values = v["values"].needed();
  const auto view = [](const Value& owner) {
    return static_cast<size_t>(owner["bufferView"].needed().index("bufferViews"));
  };
  out.index_view = view(indices);
  out.index_offset = indices["byteOffset"].integer(0);
  const size_t type = indices["componentType"].needed().integer(0);
  if (type != kU8 && type != kU16 && type != kU32)
    indices["componentType"].fail("5121, 5123 or 5125");
  out.index_type = static_cast<int>(type);
  out.value_view = view(values);
  out.value_offset = values["byteOffset"].integer(0);
  return out;
}

}  // namespace

size_t bytes_of_component(int type) {
  return type == kI8 || type == kU8 ? 1 : type == kI16 || type == kU16 ? 2 : 4;
}

size_t components_of(ElementType type) {
  return kComponents[static_cast<size_t>(type)];
}

Accessor read_accessor(const Value& v) {
  Accessor out;
  out.view = v["bufferView"].index("bufferViews");
  out.offset = v["byteOffset"].integer(0);
  out.normalized = v["normalized"].boolean(false);
  const size_t type = v["componentType"].needed().integer(0);
  if (type < kI8 || type > kFloat || type == 5124)
    v["componentType"].fail("5120, 5121, 5122, 5123, 5125 or 5126 (float)");
  out.component_type = static_cast<int>(type);
  out.count = v["count"].needed().integer(0, 1);
  out.type = static_cast<ElementType>(v["type"].needed().one_of(
      {kTypes[0], kTypes[1], kTypes[2], kTypes[3], kTypes[4], kTypes[5], kTypes[6]}, 0));
  if (const Value sparse = v["sparse"]) out.sparse = read_sparse(sparse);
  return out;
}

std::vector<Vec3d> read_positions(const Document& d, size_t accessor) {
  const Accessor& a = d.accessors[accessor];
  const std::string where = place("accessors", accessor);
  if (a.type != ElementType::vec3) d.fail(where + ".type", "positions are not VEC3");
  if (a.component_type != kFloat && !(d.quantized && a.component_type != kU32))
    d.fail(where + ".componentType",
           fmt::format("positions are of type {}, expected 5126 (float)", a.component_type));
  const size_t step = bytes_of_component(a.component_type);
  std::vector<Vec3d> out;
  const auto set = [&](size_t k, const char* at) {
    if (out.empty()) out.resize(a.count);  // only now is the count known to be right
    for (int c = 0; c < 3; ++c)
      out[k][c] =
          load_component(at + static_cast<size_t>(c) * step, a.component_type, a.normalized);
  };
  for_elements(d, where, a, 3, set);
  out.resize(a.count);
  for (size_t i = 0; i < out.size(); ++i)
    if (!is_finite(out[i]))
      d.fail(where, fmt::format("position {} is not finite, expected three finite numbers", i));
  return out;
}

std::vector<float> read_attribute(const Document& d, size_t accessor, const Attribute& attribute) {
  const Accessor& a = d.accessors[accessor];
  const std::string where = place("accessors", accessor);
  const bool rgb = attribute.may_be_vec3 && a.type == ElementType::vec3;
  if (a.type != type_of(attribute.components) && !rgb)
    d.fail(where + ".type",
           fmt::format("{} are not {}VEC{}", attribute.noun,
                       attribute.may_be_vec3 ? "VEC3 or " : "", attribute.components));
  const bool quantized = attribute.quantizable && a.component_type != kU32 && d.quantized;
  const bool is_share = attribute.may_be_unsigned && a.normalized && a.component_type != kU32 &&
                        (attribute.is_delta || is_unsigned(a.component_type));
  if (a.component_type != kFloat && !quantized && !is_share)
    d.fail(where + ".componentType",
           fmt::format("{} are of type {}{}, expected 5126 (float){}", attribute.noun,
                       a.component_type, a.normalized ? ", normalized" : "",
                       attribute.is_delta && attribute.may_be_unsigned
                           ? ", or 5120 to 5123, normalized"
                       : attribute.may_be_unsigned ? ", or 5121 or 5123, normalized"
                                                   : ""));
  const size_t n = attribute.components, stored = rgb ? 3 : n,
               step = bytes_of_component(a.component_type);
  std::vector<float> out;
  const auto set = [&](size_t k, const char* at) {
    if (out.empty()) out.resize(n * a.count);
    for (size_t c = 0; c < stored; ++c)
      out[n * k + c] =
          static_cast<float>(load_component(at + c * step, a.component_type, a.normalized));
  };
  for_elements(d, where, a, stored, set);
  out.resize(n * a.count);
  if (rgb && !attribute.is_delta)
    for (size_t k = 0; k < a.count; ++k) out[4 * k + 3] = 1;
  return out;
}

namespace {

void check_numbers(const Document& d, const std::string& where, const Accessor& a,
                   const Numbers& n) {
  const ElementType expected = type_of(n.components);
  if (a.type != expected)
    d.fail(where + ".type",
           fmt::format("{} are not {}", n.noun, kTypes[static_cast<size_t>(expected)]));
  const bool small = a.component_type != kFloat && a.component_type != kU32;
  const bool fits = a.component_type == kFloat ? n.floats
                    : !small                   ? false
                    : a.normalized ? (is_unsigned(a.component_type) ? n.shares : n.signed_shares)
                                   : n.integers && is_unsigned(a.component_type);
  if (fits) return;
  std::string kinds;
  const auto add = [&](bool allowed, const char* kind) {
    if (allowed) kinds += (kinds.empty() ? "" : ", or ") + std::string(kind);
  };
  add(n.floats, "5126 (float)");
  add(n.shares, "5121 or 5123, normalized");
  add(n.signed_shares, "5120 or 5122, normalized");
  add(n.integers, "5121 or 5123");
  d.fail(where + ".componentType",
         fmt::format("{} are of type {}{}, expected {}", n.noun, a.component_type,
                     a.normalized ? ", normalized" : "", kinds));
}

}  // namespace

std::vector<double> read_numbers(const Document& d, size_t accessor, const Numbers& n, size_t first,
                                 size_t count) {
  const Accessor& a = d.accessors[accessor];
  const std::string where = place("accessors", accessor);
  check_numbers(d, where, a, n);
  if (count == SIZE_MAX) count = a.count;
  if (first > a.count || count > a.count - first)
    d.fail(where,
           fmt::format("count is {}, expected at least {} {}", a.count, first + count, n.noun));
  const size_t step = bytes_of_component(a.component_type);
  std::vector<double> out;
  const auto set = [&](size_t k, const char* at) {
    if (k < first || k - first >= count) return;
    if (out.empty()) out.resize(n.components * count);  // only now is the count known to be right
    for (size_t c = 0; c < n.components; ++c)
      out[n.components * (k - first) + c] =
          load_component(at + c * step, a.component_type, a.normalized);
  };
  for_elements(d, where, a, n.components, set, first, count);
  out.resize(n.components * count);
  for (size_t i = 0; i < out.size(); ++i)
    if (!std::isfinite(out[i]))
      d.fail(where,
             fmt::format("element {} of {} is not finite", first + i / n.components, n.noun));
  return out;
}

std::vector<uint32_t> read_indices(const Document& d, size_t accessor, size_t vertices) {
  const Accessor& a = d.accessors[accessor];
  const std::string where = place("accessors", accessor);
  if (a.type != ElementType::scalar) d.fail(where + ".type", "indices are not SCALAR");
  if (a.component_type != kU8 && a.component_type != kU16 && a.component_type != kU32)
    d.fail(where + ".componentType",
           fmt::format("indices are of type {}, expected 5121, 5123 or 5125", a.component_type));
  const size_t size = bytes_of_component(a.component_type);
  const Elements e = elements(d, where, static_cast<size_t>(a.view), a.offset, a.count, size, true);
  std::vector<uint32_t> out;
  out.reserve(e.count);
  for (size_t i = 0; i < e.count; ++i)
    out.push_back(load_index(e.data + i * e.stride, a.component_type));
  apply_sparse(d, where, a, size,
               [&](uint32_t k, const char* at) { out[k] = load_index(at, a.component_type); });
  for (size_t i = 0; i < out.size(); ++i)
    if (out[i] >= vertices)
      d.fail(where, fmt::format("index {} at {} is out of range, the primitive has {} vertices",
                                out[i], i, vertices));
  return out;
}

}  // namespace tdpt::gltf
