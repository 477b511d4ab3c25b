// Tables of records concatenated in one buffer, which kernels read as texels
// [shaders/shared/records.h]; a table that kernels write is also bound as a storage buffer.
#pragma once
#include <optional>

#include "libcommon/gpu/memory.h"

namespace tdpt::gpu {

class Tables {
 public:
  /// Adds a table with `values`, which must stay valid until upload().
  template <class T>
  void add(std::span<const T> values) {
    static_assert(std::is_trivially_copyable_v<T>);
    add(std::as_bytes(values), values.size_bytes());
  }
  template <class T>
  void add(const std::vector<T>& values) {
    add(std::span<const T>(values));
  }
  /// Adds an uninitialised table of this size.
  void add_room(uint64_t bytes) { add({}, bytes); }

  /// Total size.
  uint64_t bytes() const { return end_; }
  /// First texel of each table.
  std::vector<uint32_t> first_texels() const;

  /// Allocates and fills the buffer. Throws if it exceeds the limits.
  void upload(const Device& device);
  Texels texels() const { return Texels(*buffer_); }
  /// Table i, at least one texel.
  Part part(size_t i) const { return {*buffer_, tables_[i].begin, tables_[i].bytes}; }
  /// Writes to the beginning of table i.
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
