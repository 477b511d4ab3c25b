#include "tools/tdpt-import/pbrt/inflate.h"

#include <limits>
#include <memory>

#include <zlib.h>

#include "libcommon/base/error.h"

namespace tdpt::foreign::pbrt {
namespace {

constexpr size_t kMost = size_t{1} << 30;
constexpr size_t kStep = size_t{1} << 16;
constexpr int kGzip = 16 + MAX_WBITS;

}  // namespace

bool is_gzip(std::string_view bytes) {
  return bytes.substr(0, 2) == "\x1f\x8b";
}

std::string inflated(std::string_view bytes, const std::string& name) {
  if (bytes.size() > std::numeric_limits<uInt>::max())
    throw InputError(name, "", "more than 4 GiB of compressed bytes");
  z_stream stream{};
  if (inflateInit2(&stream, kGzip) != Z_OK) throw std::bad_alloc();
  const std::unique_ptr<z_stream, int (*)(z_stream*)> end(&stream, inflateEnd);
  // zlib does not write to its input; its interface only lacks the const.
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
  stream.avail_in = static_cast<uInt>(bytes.size());
  std::string out;
  int status = Z_OK;
  while (status == Z_OK) {
    if (out.size() >= kMost) throw InputError(name, "", "more than 1 GiB when inflated");
    const size_t before = out.size();
    out.resize(before + kStep);
    stream.next_out = reinterpret_cast<Bytef*>(out.data() + before);
    stream.avail_out = static_cast<uInt>(kStep);
    status = inflate(&stream, Z_NO_FLUSH);
    out.resize(out.size() - stream.avail_out);
  }
  if (status == Z_MEM_ERROR) throw std::bad_alloc();
  if (status != Z_STREAM_END) throw InputError(name, "", "the compressed bytes are broken");
  return out;
}

}  // namespace tdpt::foreign::pbrt
