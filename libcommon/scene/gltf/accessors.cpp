#include "libcommon/scene/gltf/accessors.h"

#include <fmt/format.h>
#include <cmath>
#include <cstring>
#include <type_traits>

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
    case kU32:
      return load<uint32_t>(at);
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

/// Calls `set(element, its first component)` for each element, `most` at most, that is stored in
/// the accessor's bufferView, from `first` on, or among its sparse values; the others are zero.
/// Calls `begin()` before, when all counts are known to be right.
template <class Begin, class Set>
void for_elements(const Document& d, const std::string& where, const Accessor& a, size_t size,
                  size_t first, size_t most, const Begin& begin, const Set& set) {
  Elements stored{nullptr, 0, 0}, index = stored, value = stored;
  if (a.view != kNone)
    stored = elements(d, where, a.view, a.offset, a.count, size, true);
  else if (a.count > d.bytes.size())  // a tiny file could declare any count of zeros
    d.fail(where, fmt::format("{} elements without a bufferView, expected at most {}, the bytes "
                              "of the file",
                              a.count, d.bytes.size()));
  if (a.sparse) {
    const Sparse& s = *a.sparse;
    index = elements(d, where + ".sparse.indices", s.index_view, s.index_offset, s.count,
                     bytes_of_component(s.index_type), false);
    value =
        elements(d, where + ".sparse.values", s.value_view, s.value_offset, s.count, size, false);
  }
  begin();
  for (size_t i = first; i < stored.count && i - first < most; ++i)
    set(i, stored.data + i * stored.stride);
  for (size_t i = 0; i < index.count; ++i) {
    const auto k = static_cast<size_t>(
        load_component(index.data + i * index.stride, a.sparse->index_type, false));
    if (k >= a.count)
      d.fail(where + ".sparse.indices",
             fmt::format("index {} is out of range, the accessor has {} elements", k, a.count));
    if (k >= first && k - first < most) set(k, value.data + i * value.stride);
  }
}

void check_type(const Document& d, const std::string& where, const Accessor& a, const Numbers& n) {
  const ElementType expected = type_of(n.components);
  if (a.type != expected && !(n.fourth && a.type == ElementType::vec3))
    d.fail(where + ".type", fmt::format("{} are not {}{}", n.noun, n.fourth ? "VEC3 or " : "",
                                        kTypes[static_cast<size_t>(expected)]));
  const int type = a.component_type;
  const bool is_index = type == kU8 || type == kU16 || type == kU32;
  if (n.kind == Numbers::Kind::indices
          ? !is_index
          : n.kind == Numbers::Kind::shares && type != kFloat && !(a.normalized && type != kU32))
    d.fail(where + ".componentType",
           fmt::format("{} are of type {}, expected {}", n.noun, type,
                       n.kind == Numbers::Kind::indices
                           ? "5121, 5123 or 5125"
                           : "5126 (float), or 5120 to 5123, normalized"));
}

void put(std::vector<Vec3d>& out, size_t i, double value) {
  out[i / 3][static_cast<int>(i % 3)] = value;
}
template <class T>
void put(std::vector<T>& out, size_t i, double value) {
  out[i] = static_cast<T>(value);
}

/// Components of `count` elements from `first` on; `finite`: all must be.
template <class T>
std::vector<T> read_all(const Document& d, size_t accessor, const Numbers& n, bool finite,
                        size_t first = 0, size_t count = SIZE_MAX) {
  const Accessor& a = d.accessors[accessor];
  const std::string where = place("accessors", accessor);
  check_type(d, where, a, n);
  if (count == SIZE_MAX) count = a.count;
  if (first > a.count || count > a.count - first)
    d.fail(where,
           fmt::format("count is {}, expected at least {} {}", a.count, first + count, n.noun));
  const size_t components = components_of(a.type), step = bytes_of_component(a.component_type);
  std::vector<T> out;
  for_elements(
      d, where, a, components * step, first, count,
      [&] { out.resize(std::is_same_v<T, Vec3d> ? count : count * n.components); },
      [&](size_t k, const char* at) {
        for (size_t c = 0; c < components; ++c) {
          const double value = load_component(at + c * step, a.component_type,
                                              a.normalized && n.kind != Numbers::Kind::indices);
          if (finite && !std::isfinite(value))
            d.fail(where, fmt::format("element {} of {} is not finite", k, n.noun));
          put(out, n.components * (k - first) + c, value);
        }
      });
  return out;
}

Sparse read_sparse(const Value& v) {
  Sparse out;
  out.count = v["count"].needed().integer(0, 1);
  const Value indices = v["indices"].needed(), values = v["values"].needed();
  const auto view = [](const Value& owner) {
    return owner["bufferView"].needed().index("bufferViews");
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

std::vector<double> read_numbers(const Document& d, size_t accessor, const Numbers& n, size_t first,
                                 size_t count) {
  return read_all<double>(d, accessor, n, true, first, count);
}

std::vector<float> read_floats(const Document& d, size_t accessor, const Numbers& n, size_t count) {
  std::vector<float> out = read_all<float>(d, accessor, n, false, 0, count);
  if (n.fourth && d.accessors[accessor].type == ElementType::vec3)
    for (size_t i = 3; i < out.size(); i += 4) out[i] = static_cast<float>(*n.fourth);
  return out;
}

std::vector<Vec3d> read_positions(const Document& d, size_t accessor, size_t count) {
  return read_all<Vec3d>(d, accessor, {"positions", 3}, true, 0, count);
}

std::vector<uint32_t> read_indices(const Document& d, size_t accessor, size_t vertices) {
  const std::vector<uint32_t> out =
      read_all<uint32_t>(d, accessor, {"indices", 1, Numbers::Kind::indices}, true);
  for (size_t i = 0; i < out.size(); ++i)
    if (out[i] >= vertices)
      d.fail(place("accessors", accessor),
             fmt::format("index {} at {} is out of range, the primitive has {} vertices", out[i], i,
                         vertices));
  return out;
}

}  // namespace tdpt::gltf
