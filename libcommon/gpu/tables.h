// Tables of records one behind the other in one buffer, as kernels read them by texels
// [shaders/shared/records.h]; of those that kernels write each is a storage buffer, too.
#pragma once
#include <optional>

#include "libcommon/gpu/memory.h"

namespace tdpt::gpu {

class Tables {
 public:
  /// Adds one that holds `values`, which stay where they are until upload().
  template <class T>
  void add(std::span<const T> values) {
    static_assert(std::is_trivially_copyable_v<T>);
    add(std::as_bytes(values), values.size_bytes());
  }
  template <class T>
  void add(const std::vector<T>& values) {
    add(std::span<const T>(values));
  }
  /// Adds room for a table of so many bytes, undefined.
  void add_room(uint64_t bytes) { add({}, bytes); }

  /// Of all of them.
  uint64_t bytes() const { return end_; }
  /// The texel that each begins at.
  std::vector<uint32_t> first_texels() const;

  /// Makes the buffer, and fills it. Throws when it is above the limits.
  void upload(const Device& device);
  Texels texels() const { return Texels(*buffer_); }
  /// Table i, with a texel at least.
  Part part(size_t i) const { return {*buffer_, tables_[i].begin, tables_[i].bytes}; }
  /// Its first bytes.
  void write(size_t i, std::span<const std::byte> from) { buffer_->write(from, tables_[i].begin); }

 private:
  struct Table {
    std::span<const std::byte> values;
    uint64_t begin, bytes;
  };
  void add(std::span<const std::byte> values, uint64_t bytes);

  std::vector<Table> tables_;
  uint64_t end_ = 0;
  std::optional<Buffer> buffer_;  // none yet
};

}  // namespace tdpt::gpu
